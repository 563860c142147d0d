// TbbThreads: the functions of oneTBB that octopair uses. The only interface to oneTBB.
//
// It has its own source file so that this file can be compiled without the thread sanitizer: Debian's libtbb is not
// instrumented, and the sanitizer cannot see how oneTBB orders tasks. In a build with the sanitizer, the source tells it the
// order that oneTBB guarantees: everything before a call happens before its tasks, and the tasks happen before the call
// returns.
#pragma once

#include <functional>
#include <memory>

namespace octopair {

class TbbThreads {
public:
    /// Makes an arena of `threads` threads, the calling thread included.
    explicit TbbThreads(unsigned threads);
    ~TbbThreads();

    /// Calls body(i) once for each i below `count`, on several threads. Returns when all bodies have returned.
    /// Throws: the first exception of a body; Error{resource_limit} if no threads can be started.
    void run(unsigned count, const std::function<void(unsigned)>& body);
    /// Calls `lead` on the calling thread, and `help` up to `helpers` times on other threads, if they are available. Returns
    /// when all calls have returned. Requires: `lead` and `help` do not throw.
    /// Throws: Error{resource_limit} if no threads can be started.
    void run_with_helpers(unsigned helpers, const std::function<void()>& lead, const std::function<void()>& help);

private:
    struct Arena;
    std::unique_ptr<Arena> arena_;
};

}  // namespace octopair
