// Finds the program of the workers, octopair-worker.
#pragma once

#include <string>

namespace octopair {

/// Returns the first of: `requested` if not empty; the path in OCTOPAIR_WORKER; the first executable of the candidates.
/// Candidates: octopair-worker in the folder of this program, in the libexec folder beside that, at `packaged` (may be empty),
/// in the configured installation, in the build.
/// Throws: Error{engine_failed} with the candidates if none is executable.
std::string find_worker_program(const std::string& requested, const std::string& packaged);

}  // namespace octopair
