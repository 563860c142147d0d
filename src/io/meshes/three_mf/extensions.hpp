// Extensions of 3MF: which ones a file may need, and which ones say nothing about shapes.
//
// - An extension is known by the URI of its namespace. Its prefix can be any.
// - A file that needs an extension which octopair does not read is refused, because the extension may change shapes.
#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>

namespace octopair::io::three_mf {

inline constexpr std::string_view production_space = "http://schemas.microsoft.com/3dmanufacturing/production/2015/06",
                                  alternatives_space =
                                      "http://schemas.microsoft.com/3dmanufacturing/production/alternatives/2021/04",
                                  slice_space = "http://schemas.microsoft.com/3dmanufacturing/slice/2015/07";

/// Namespaces by their prefixes.
using Prefixes = std::map<std::string, std::string, std::less<>>;

/// Returns whether a namespace is that of 3MF itself, in a version that octopair reads. Also true for none, which some programs write.
bool is_core_space(std::string_view space);

/// Returns the version that the namespace of 3MF has, for example "2015/02"; empty for other namespaces.
std::string_view version_in(std::string_view space);

/// Returns whether octopair reads an extension, or the extension says nothing about shapes.
bool is_harmless_space(std::string_view space);

/// Returns a namespace for messages: its first 200 characters in printable ASCII, because the end of a URI has the version.
std::string shown_space(std::string_view space);

/// Checks the value of the attribute requiredextensions. Returns the namespaces that it names. `place`: the file, part and line, for
/// messages.
/// Throws: Error{bad_input} that names an extension which octopair does not read, or a prefix without a namespace.
std::set<std::string> check_required_extensions(std::string_view value, const Prefixes& prefixes,
                                                const std::string& place);

}  // namespace octopair::io::three_mf
