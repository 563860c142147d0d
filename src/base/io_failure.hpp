// How the system's refusal to read or write becomes an Error: one line that begins with the file.
#pragma once

#include <string_view>

namespace octopair {

/// Throws Error{io_failed} "FILE: ACTION: the system's words for `error_number`"; an errno for want of memory becomes
/// Error{resource_limit}.
[[noreturn]] void fail_io(std::string_view file, std::string_view action, int error_number);

}  // namespace octopair
