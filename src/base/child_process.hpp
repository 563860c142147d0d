// start_child(): starts a program that dies with the thread that started it.
//
// posix_spawn() cannot arm the parent-death signal. A program could arm it itself, but only once it is loaded: until then a child that is
// stopped would outlive its parent.
#pragma once

#include <sys/types.h>

#include <span>
#include <string>

#include "base/private_export.hpp"

namespace octopair {

struct ChildProgram {
    static constexpr int max_descriptors = 4;

    std::string path;
    std::span<char* const> arguments;  ///< begin with the name of the program, and end with a null pointer
    /// Descriptors that the program gets as 3, 4, ...; at most max_descriptors. Besides these, the program gets only 0, 1 and 2.
    std::span<const int> descriptors;
    bool keeps_stderr = false;     ///< false: descriptor 2 is /dev/null, as descriptors 0 and 1 are
    int output = -1, errors = -1;  ///< descriptors that the program gets as 1 and 2; -1: as above
};

/// Starts a program in a process group of its own, with no signal blocked or ignored. The system kills it when the calling thread ends.
/// Returns its process id, or -1 with `errno`. Does not copy the memory of this process. Thread safety: any thread may call it.
OCTOPAIR_PRIVATE_EXPORT pid_t start_child(const ChildProgram& program);

}  // namespace octopair
