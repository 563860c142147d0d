// The process engine: pairs are found by worker processes of the library's own, which share memory with the application.
//
// Result    the same bytes as from every engine.
// Faults    a worker that dies or is stopped, at any moment, is noticed within a second and replaced, and its share of the
//           work is done again. Work that ends three workers fails its call alone, with Error{engine_failed}. Memory that
//           is exhausted is Error{resource_limit}, never a signal. Workers end with the engine, and within two seconds with
//           the application, however that ends.
// Copies    boxes are copied to shared memory, unless the engine allocated them (Engine::allocate_boxes). Pairs, if they are
//           many, are not: a PairList keeps the memory that workers wrote to.
// Memory    about 60 bytes an object beside input and output, and the copy of the boxes; kept until the engine goes.
// Fork      an engine belongs to the process that made it; in one forked from that, its calls throw Error{usage}.
// System    Linux 5.4 or later. CMake: link octopair::processes.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>

#include "octopair/arrangement.hpp"
#include "octopair/engine.hpp"

/// Where the package that a program is built with has octopair-worker: what links octopair::processes of an installed
/// octopair is compiled with it.
#ifndef OCTOPAIR_WORKER_PROGRAM
#define OCTOPAIR_WORKER_PROGRAM ""
#endif

namespace octopair {

struct ProcessOptions {
    unsigned workers = 0;                           ///< 0: one per core; at most 256
    Arrangement arrangement = Arrangement::shared;  ///< paper: the application merges and scans
    /// The program of the workers, octopair-worker of the same version. Empty: what the environment variable
    /// OCTOPAIR_WORKER names; or else octopair-worker beside the application's program, in ../libexec/octopair from
    /// there, in the package, as configured, or as built.
    std::string worker_program = {};
};

namespace detail {  // not for users
/// The worker program of the package that the calling program is built with.
struct PackagedWorker {
    const char* path;
};
}  // namespace detail

/// Starts the workers. Leave `package` to its default.
/// Throws: Error{engine_failed} if they cannot be started; Error{resource_limit} if the system has no processes, descriptors
/// or memory to give.
std::unique_ptr<Engine> make_process_engine(const ProcessOptions& options,
                                            detail::PackagedWorker package = {OCTOPAIR_WORKER_PROGRAM});
std::unique_ptr<Engine> make_process_engine(unsigned workers = 0,
                                            detail::PackagedWorker package = {OCTOPAIR_WORKER_PROGRAM});

/// What has happened to the workers of an engine since it was made.
struct WorkerFaults {
    std::uint64_t ended = 0;    ///< workers that died
    std::uint64_t stopped = 0;  ///< workers that were stopped, and killed for it
    /// Of these: how many had a share under way, by step: prepare, encode, merge, sort, scan, order.
    std::array<std::uint64_t, 6> in_share = {};
};

/// Thread-safe. Throws Error{usage} unless make_process_engine made the engine.
WorkerFaults worker_faults(const Engine& engine);

}  // namespace octopair
