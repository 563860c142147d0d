// How this layer says that something is wrong: one line that begins with the file.
#pragma once

#include <string>
#include <string_view>

#include "base/io_failure.hpp"

namespace octopair::io {

/// Throws Error{bad_input} "FILE: WHAT".
[[noreturn]] void refuse(std::string_view file, std::string_view what);
/// As short as it can be written; nan without a sign.
std::string number_text(float number);
std::string number_text(double number);
/// Throws Error{cancelled}.
[[noreturn]] void cancel();

}  // namespace octopair::io
