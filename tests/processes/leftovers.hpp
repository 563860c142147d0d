// Finds resources that an engine must not leave behind: child processes, open descriptors, named shared memory.
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

/// Returns all visible processes of the machine.
std::vector<ProcessStatus> all_processes();
/// Returns the children of a process, including ended children.
std::vector<pid_t> children_of(pid_t parent);
bool process_lives(pid_t id);  ///< Returns whether the process exists and is not a zombie.

/// Polls every few milliseconds, for `most` at most, until `condition` holds. Returns whether it held.
bool comes_true(const std::function<bool()>& condition, std::chrono::milliseconds most);

/// The current child processes, descriptors and named shared memory.
struct Belongings {
    std::vector<pid_t> children;
    std::size_t descriptors = 0;
    std::set<std::string> named_memory;

    static Belongings now();
};

/// Fixture for tests that must leave nothing behind. Engines and pair lists must be destroyed before the end of a test.
class Processes : public ::testing::Test {
protected:
    void SetUp() override;
    void TearDown() override;

private:
    Belongings before_;
};

/// Makes an engine with faulty workers.
std::unique_ptr<Engine> make_faulty_engine(unsigned workers);

/// Returns `usual`, or OCTOPAIR_TEST_SEED if set, to replay a failure.
std::uint64_t test_seed(std::uint64_t usual);

}  // namespace octopair::test
