// AtAllocation: runs an action at one memory allocation of a call, for example to let it fail.
//
// Counts the allocations of all threads, or of one: operator new, and the calls of mmap and aligned_alloc by which buffers get memory. Only
// allocations of octopair and of the standard library count, not those of other libraries, such as TBB. The action does not run inside gRPC.
//
// A test program gets it with target_link_libraries(... octopair_at_allocation). With the thread sanitizer only mmap and aligned_alloc
// count, so tests of each allocation are left out there.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <new>

#include "octopair/error.hpp"

namespace octopair::test {

/// Thread safety: at most one object exists at a time. `action` runs once, on the thread that allocates.
class AtAllocation {
public:
    enum class Threads : std::uint8_t { all, this_one };

    /// Runs `action` at the allocation `number` of `threads`, counted from 0. If `action` throws std::bad_alloc, the allocation fails.
    AtAllocation(std::uint64_t number, std::function<void()> action, Threads threads = Threads::all);
    AtAllocation(const AtAllocation&) = delete;
    AtAllocation& operator=(const AtAllocation&) = delete;
    ~AtAllocation();

    /// Returns whether the action has run.
    bool reached() const;

    /// While it exists, allocations do not count: for what a test allocates itself.
    class Paused {
    public:
        Paused();
        Paused(const Paused&) = delete;
        Paused& operator=(const Paused&) = delete;
        ~Paused();

    private:
        bool armed_;
    };
};

[[noreturn]] inline void fail_allocation() { throw std::bad_alloc(); }

/// Runs `attempt` again and again: its first allocation fails, then its second, until it makes no further allocation.
/// `attempt` makes a call that may fail by std::bad_alloc or Error{resource_limit}.
/// Calls check(failed) after each attempt. `failed`: the attempt has thrown.
/// Returns the number of attempts that have thrown.
template <typename Prepare, typename Attempt, typename Check>
std::uint64_t fail_every_allocation(Prepare&& prepare, Attempt&& attempt, Check&& check) {
    std::uint64_t failures = 0;
    for (std::uint64_t number = 0;; ++number) {
        SCOPED_TRACE("allocation " + std::to_string(number) + " fails");
        auto state = prepare();
        bool failed = false, reached = false;
        {
            const AtAllocation failure(number, fail_allocation);
            try {
                attempt(state);
            } catch (const std::bad_alloc&) {
                failed = true;
            } catch (const Error& error) {
                EXPECT_EQ(error.code(), ErrorCode::resource_limit) << error.what();
                failed = true;
            }
            reached = failure.reached();
        }
        failures += failed ? 1 : 0;
        EXPECT_TRUE(reached || !failed);
        check(state, failed);
        if (!reached || ::testing::Test::HasFailure()) return failures;
    }
}

}  // namespace octopair::test
