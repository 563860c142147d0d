// The process engine: worker processes, which share memory with the application, find the pairs.
//
// Result    The same bytes as from every engine.
// Faults    If a worker dies or is stopped (SIGSTOP), at any moment, the engine notices within a second, replaces the worker
//           and repeats its share of the work. A share that ends three workers fails only its call, with
//           Error{engine_failed}. Exhausted memory is Error{resource_limit}, never a signal.
// Lifetime  Workers end with the engine, and within two seconds after the application ends for any reason.
// Copies    Boxes are copied to shared memory, unless Engine::allocate_boxes allocated them. Large results are not copied: a
//           PairList keeps the memory that workers wrote.
// Memory    The octree and the copy of the boxes (bytes per object: docs/memory.md). Kept until the engine is destroyed.
// Fork      An engine belongs to the process that made it. In a forked process its calls throw Error{usage}.
// System    Linux 5.4 or later. CMake: link octopair::processes.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>

#include "octopair/engine.hpp"
#include "octopair/limits.hpp"

/// Path of octopair-worker in the installed octopair package. CMake defines it for targets that link octopair::processes of an
/// installed octopair.
#ifndef OCTOPAIR_WORKER_PROGRAM
#define OCTOPAIR_WORKER_PROGRAM ""
#endif

namespace [[gnu::visibility("default")]] octopair {

struct ProcessOptions {
    unsigned workers = 0;  ///< number of workers, at most max_workers; 0: one per core
    /// Path of octopair-worker, of the same version. If empty, the path in the environment variable OCTOPAIR_WORKER. If that is
    /// not set either, the first octopair-worker found in: the folder of the application's program; ../libexec/octopair from
    /// there; the installation of this library; the package; the configured installation; the build tree.
    std::string worker_program = {};
};

namespace detail {  // not for users
/// The worker program of the package that the calling program was built with.
struct PackagedWorker {
    const char* path;  ///< empty: none
};
}  // namespace detail

/// Starts the workers and returns their engine. Callers leave `package` at its default.
/// Throws: Error{usage} for more than max_workers; Error{engine_failed} if the workers cannot be started; Error{resource_limit} if
/// the system runs out of processes, descriptors or memory.
std::unique_ptr<Engine> make_process_engine(const ProcessOptions& options,
                                            detail::PackagedWorker package = {OCTOPAIR_WORKER_PROGRAM});
std::unique_ptr<Engine> make_process_engine(unsigned workers = 0,
                                            detail::PackagedWorker package = {OCTOPAIR_WORKER_PROGRAM});

/// Counts of worker faults since the engine was made.
struct WorkerFaults {
    std::uint64_t ended = 0;    ///< number of workers that died
    std::uint64_t stopped = 0;  ///< number of workers that were stopped (SIGSTOP) and therefore killed
    /// Number of dead or stopped workers that were running a share, by its step: prepare, encode (with scatter), count, scan, order.
    std::array<std::uint64_t, 5> in_share = {};
};

/// Returns the faults of the engine's workers so far.
/// Throws: Error{usage} if `engine` is not a process engine. Thread safety: any thread, at any time.
WorkerFaults worker_faults(const Engine& engine);

}  // namespace octopair
