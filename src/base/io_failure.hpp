// Turns a failed system call for input or output into an Error.
#pragma once

#include <string_view>

#include "base/private_export.hpp"

namespace octopair {

/// Throws: Error{io_failed} "FILE: ACTION: REASON", where REASON is the system's text for `error_number`;
/// Error{resource_limit} if `error_number` means that memory or descriptors ran out.
OCTOPAIR_PRIVATE_EXPORT [[noreturn]] void fail_io(std::string_view file, std::string_view action, int error_number);

}  // namespace octopair
