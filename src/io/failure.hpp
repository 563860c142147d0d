// How this layer says that something is wrong: one line that begins with the file.
#pragma once

#include <string>
#include <string_view>

namespace octopair::io {

/// Throws Error{bad_input} "FILE: WHAT".
[[noreturn]] void refuse(std::string_view file, std::string_view what);
/// Throws Error{io_failed} "FILE: ACTION: the system's words for `error_number`"; an errno for want of memory becomes
/// Error{resource_limit}.
[[noreturn]] void fail_io(std::string_view file, std::string_view action, int error_number);
/// As short as it can be written; nan without a sign.
std::string number_text(float number);
std::string number_text(double number);
/// Throws Error{cancelled}.
[[noreturn]] void cancel();

}  // namespace octopair::io
