// Where the program of the workers is.
#pragma once

#include <string>

namespace octopair {

/// `asked` if it is not empty; or what OCTOPAIR_WORKER names; or octopair-worker beside this program, in libexec/octopair
/// beside its folder, where the package says (`packaged`, may be empty), as installed, or as built. Throws
/// Error{engine_failed} that says where it looked.
std::string find_worker_program(const std::string& asked, const std::string& packaged);

}  // namespace octopair
