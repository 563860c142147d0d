// Team: the threads of an engine.
//
// A team of one runs everything on the calling thread and touches no scheduler. Which thread runs which index is free;
// nothing above this file may let its result depend on it. Not reentrant: a body must not call its team.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>

namespace octopair {

class TbbThreads;

class Team {
public:
    /// 0: one thread per core.
    explicit Team(unsigned threads);
    ~Team();

    unsigned threads() const { return threads_; }

    /// Calls body(i, worker) once for each i below `count`, started in order; worker < threads() is not shared by two
    /// running bodies. Rethrows the first exception of a body, after which no further bodies start.
    void for_each(std::size_t count, const std::function<void(std::size_t, unsigned)>& body);

    /// Runs `lead` on the calling thread while up to threads() - 1 others run `help` (maybe fewer, maybe after `lead`,
    /// so `lead` must not wait for a helper to begin). Returns when all have; `help` must return soon after `lead`
    /// does.
    void with_helpers(const std::function<void()>& lead, const std::function<void()>& help);

private:
    unsigned threads_;
    std::unique_ptr<TbbThreads> tbb_;  // none for a team of one
};

}  // namespace octopair
