// Team: the thread pool of an engine.
//
// - A team of one thread runs everything on the calling thread and uses no scheduler.
// - It is not defined which thread runs which index. No result may depend on it.
// - Not reentrant: a body must not call its team.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>

#include "base/private_export.hpp"

namespace octopair {

class TbbThreads;

/// Returns the number of threads for a request: `requested`, or one per core for 0.
/// Throws: Error{usage} for more than max_threads (octopair/limits.hpp).
OCTOPAIR_PRIVATE_EXPORT unsigned thread_count(unsigned requested);

class OCTOPAIR_PRIVATE_EXPORT Team {
public:
    /// Makes a team of thread_count(threads) threads, the calling thread included. Throws: as thread_count().
    explicit Team(unsigned threads);
    ~Team();

    unsigned threads() const { return threads_; }

    /// Calls body(i, worker) once for each i below `count`, started in ascending order. At any time, bodies that run have
    /// different values of worker < threads().
    /// Throws: the first exception of a body. No further body starts after an exception.
    void for_each(std::size_t count, const std::function<void(std::size_t, unsigned)>& body);

    /// Runs `lead` on the calling thread, and `help` on up to threads() - 1 other threads. Fewer helpers may run, and they may
    /// start after `lead` has returned. Returns when `lead` and all helpers have returned.
    /// Requires: `lead` does not wait for a helper to start; `help` returns soon after `lead` and does not throw.
    /// Throws: the exception of `lead`.
    void with_helpers(const std::function<void()>& lead, const std::function<void()>& help);

private:
    unsigned threads_;
    std::unique_ptr<TbbThreads> tbb_;  // null for a team of one thread
};

}  // namespace octopair
