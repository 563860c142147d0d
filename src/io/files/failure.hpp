// Errors of the readers and writers of files: each message is one line that begins with the file.
#pragma once

#include <string>
#include <string_view>

#include "base/descriptor.hpp"

namespace octopair::io {

/// Throws: Error{bad_input} "FILE: WHAT".
[[noreturn]] void refuse(std::string_view file, std::string_view what);
/// Returns the shortest text that reads back as exactly `number`; "nan" without a sign.
std::string number_text(float number);
std::string number_text(double number);
/// Returns the first 40 characters of a part of a file in printable ASCII, for messages.
std::string shown(std::string_view part);
/// Throws: Error{cancelled}.
[[noreturn]] void cancel();

}  // namespace octopair::io
