// Recognises content that is no model at all, such as a program, a letter, or the answer of a web server.
#pragma once

#include <string>
#include <string_view>

#include "io/formats/content_marks.hpp"

namespace octopair::io {

/// Returns what a file without the mark of a format is, and what to do, for example "is a program, not a model; ...". Empty: nothing is
/// recognised. `ending`: that of the file's name, in lower case.
std::string foreign_content(const FileHead& head, std::string_view ending);

/// Returns the name of the first element of an XML text, or an empty text. The text may be cut.
std::string_view first_element(std::string_view text);

}  // namespace octopair::io
