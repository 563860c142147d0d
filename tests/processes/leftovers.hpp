// What an engine must not leave behind: child processes, open descriptors, shared memory with a name.
#pragma once

#include <gtest/gtest.h>
#include <sys/types.h>

#include <chrono>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "octopair/processes.hpp"

namespace octopair::test {

struct ProcessStatus {
    pid_t id = 0, parent = 0;
    char state = 0;  ///< as in /proc: R, S, T (stopped), Z (ended, not waited for) and so on
    std::string name;
};

/// All processes of the machine that may be seen.
std::vector<ProcessStatus> all_processes();
/// Those that a process started, ended ones included.
std::vector<pid_t> children_of(pid_t parent);
bool process_lives(pid_t id);  ///< and is no zombie

/// Looks every few milliseconds until `condition` holds, `most` at most; whether it came to hold.
bool comes_true(const std::function<bool()>& condition, std::chrono::milliseconds most);

/// What there is of all that now.
struct Belongings {
    std::vector<pid_t> children;
    std::size_t descriptors = 0;
    std::set<std::string> named_memory;

    static Belongings now();
};

/// Tests that leave nothing behind; engines and pair lists must be gone by their end.
class Processes : public ::testing::Test {
protected:
    void SetUp() override;
    void TearDown() override;

private:
    Belongings before_;
};

/// An engine whose workers are the faulty ones.
std::unique_ptr<Engine> make_faulty_engine(unsigned workers, Arrangement arrangement = Arrangement::shared);

/// A seed that OCTOPAIR_TEST_SEED overrides, to replay a failure.
std::uint64_t test_seed(std::uint64_t usual);

}  // namespace octopair::test
