// Limits: the largest numbers of threads and of workers. They are the same for all engines and interfaces.
#pragma once

namespace [[gnu::visibility("default")]] octopair {

/// Largest number of threads of an engine, a scene or a pipeline. More threads are Error{usage}.
inline constexpr unsigned max_threads = 4096;

/// Largest number of workers of a process engine. More workers are Error{usage}.
inline constexpr unsigned max_workers = 256;

}  // namespace octopair
