// Attributes of 3MF.
//
// - Values are numbers, identifiers and matrices, as the XML schema writes them. White space around a value is allowed.
// - Namespaces: the URI of its namespace identifies an extension. The prefix can be any text.
// - A file that needs an extension which octopair does not read is refused, because the extension may change shapes.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "octopair/pose.hpp"

namespace octopair::io::three_mf {

/// Returns the text without white space of XML around it.
std::string_view trimmed(std::string_view text);

/// Returns the nearest float64. Returns nothing if the text is no number, or if it is beyond the range of float64.
std::optional<double> parse_number(std::string_view text);

/// Returns a whole number from 0 to 2^31 - 1: an identifier or an index. Returns nothing for another text.
std::optional<std::uint32_t> parse_whole_number(std::string_view text);

/// Returns the pose of a matrix: twelve numbers, column by column of the pose, because 3MF multiplies a row by a matrix.
/// Returns nothing if the text has other than twelve numbers.
std::optional<Pose> parse_matrix(std::string_view text);

inline constexpr std::string_view production_space = "http://schemas.microsoft.com/3dmanufacturing/production/2015/06",
                                  alternatives_space =
                                      "http://schemas.microsoft.com/3dmanufacturing/production/alternatives/2021/04",
                                  slice_space = "http://schemas.microsoft.com/3dmanufacturing/slice/2015/07";

/// Namespaces by their prefixes.
using Prefixes = std::map<std::string, std::string, std::less<>>;

/// Returns whether a namespace is that of 3MF itself, in a version that octopair reads. Also true for an empty one, which occurs in files.
bool is_core_space(std::string_view space);

/// Returns the version that the namespace of 3MF has, for example "2015/02"; empty for other namespaces.
std::string_view version_in(std::string_view space);

/// Returns whether octopair reads an extension, or the extension has no effect on shapes.
bool is_harmless_space(std::string_view space);

/// Returns a namespace for messages: its first 200 characters in printable ASCII. The end of a URI is needed: it has the version.
std::string shown_space(std::string_view space);

/// Checks the value of the attribute requiredextensions. Returns the namespaces that it names. `place`: the file, part and line, for
/// messages.
/// Throws: Error{bad_input} that names an extension which octopair does not read, or a prefix without a namespace.
std::set<std::string> check_required_extensions(std::string_view value, const Prefixes& prefixes,
                                                const std::string& place);

}  // namespace octopair::io::three_mf
