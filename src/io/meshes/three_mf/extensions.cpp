#include "io/meshes/three_mf/extensions.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "io/json/json_fields.hpp"
#include "io/meshes/three_mf/attribute_values.hpp"

namespace octopair::io::three_mf {

namespace {

/// Beginnings of the namespaces of 3MF, up to the version: the present one, and that of drafts before version 1.0.
constexpr std::array<std::string_view, 2> core_spaces = {"http://schemas.microsoft.com/3dmanufacturing/core/",
                                                         "http://schemas.microsoft.com/3dmanufacturing/"};
constexpr std::array<std::string_view, 2> core_versions = {"2015/02", "2013/01"};

/// Slices are a second description of a mesh. Objects whose mesh is only coarse are marked (ModelObject::is_coarse).
constexpr std::array<std::string_view, 6> harmless_spaces = {
    production_space,
    alternatives_space,
    slice_space,
    "http://schemas.microsoft.com/3dmanufacturing/material/2015/02",
    "http://schemas.microsoft.com/3dmanufacturing/trianglesets/2021/07",
    "http://www.w3.org/XML/1998/namespace"};

}  // namespace

std::string_view version_in(std::string_view space) {
    for (std::size_t i = 0; i < core_spaces.size(); ++i) {
        if (!space.starts_with(core_spaces[i])) continue;
        const std::string_view version = space.substr(core_spaces[i].size());
        if (version == core_versions[i]) return version;
    }
    return {};
}

bool is_core_space(std::string_view space) { return space.empty() || !version_in(space).empty(); }

bool is_harmless_space(std::string_view space) {
    return std::find(harmless_spaces.begin(), harmless_spaces.end(), space) != harmless_spaces.end();
}

std::string shown_space(std::string_view space) {
    std::string text(space.substr(0, 200));
    std::replace_if(
        text.begin(), text.end(), [](char c) { return c <= ' ' || c > '~'; }, '?');
    return text;
}

std::set<std::string> check_required_extensions(std::string_view value, const Prefixes& prefixes,
                                                const std::string& place) {
    std::set<std::string> spaces;
    for (std::string_view rest = trimmed(value); !rest.empty(); rest = trimmed(rest)) {
        const std::string_view prefix = rest.substr(0, rest.find_first_of(" \t\r\n"));
        rest.remove_prefix(prefix.size());
        const auto found = prefixes.find(prefix);
        if (found == prefixes.end()) {
            refuse(place,
                   fmt::format("needs the extension '{}', but no namespace has this prefix; add xmlns:{} to <model>",
                               shown_text(prefix), shown_text(prefix)));
        }
        const std::string& space = found->second;
        spaces.insert(space);
        if (is_core_space(space) || is_harmless_space(space)) continue;
        refuse(place, fmt::format("needs the extension '{}' ({}), which octopair does not read; it may change shapes: "
                                  "write the file without it, or as glTF, OBJ or STL",
                                  shown_text(prefix), shown_space(space)));
    }
    return spaces;
}

}  // namespace octopair::io::three_mf
