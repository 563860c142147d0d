// TbbThreads: what octopair takes from oneTBB, behind plain functions.
//
// Alone in its file so that it can be compiled without the thread sanitizer: Debian's libtbb is not instrumented, and the
// sanitizer cannot see how it orders tasks. In such a build the order that oneTBB promises, what comes before a call
// before its tasks and these before its return, is told to the sanitizer.
#pragma once

#include <functional>
#include <memory>

namespace octopair {

class TbbThreads {
public:
    explicit TbbThreads(unsigned threads);
    ~TbbThreads();

    /// Calls body(i) once for each i below `count`; returns when all have returned. Rethrows one of their exceptions.
    void run(unsigned count, const std::function<void(unsigned)>& body);
    /// Calls `lead` on this thread and `help` `helpers` times on others, as far as there are any; returns when all have
    /// returned. Neither may throw.
    void run_beside(unsigned helpers, const std::function<void()>& lead, const std::function<void()>& help);

private:
    struct Arena;
    std::unique_ptr<Arena> arena_;
};

}  // namespace octopair
