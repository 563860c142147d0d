#include "io/meshes/three_mf/attributes.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "io/json/json_fields.hpp"
#include "io/meshes/text_words.hpp"

namespace octopair::io::three_mf {

namespace {

constexpr std::string_view xml_space = " \t\r\n";

/// Beginnings of the namespaces of 3MF, up to the version: the present one, and that of drafts before version 1.0.
constexpr std::array<std::string_view, 2> core_spaces = {"http://schemas.microsoft.com/3dmanufacturing/core/",
                                                         "http://schemas.microsoft.com/3dmanufacturing/"};
constexpr std::array<std::string_view, 2> core_versions = {"2015/02", "2013/01"};

/// Namespaces that change no shape. Slices only describe a mesh a second time. Objects with a coarse mesh are marked (is_coarse).
constexpr std::array<std::string_view, 6> harmless_spaces = {
    production_space,
    alternatives_space,
    slice_space,
    "http://schemas.microsoft.com/3dmanufacturing/material/2015/02",
    "http://schemas.microsoft.com/3dmanufacturing/trianglesets/2021/07",
    "http://www.w3.org/XML/1998/namespace"};

}  // namespace

std::string_view trimmed(std::string_view text) {
    text.remove_prefix(std::min(text.find_first_not_of(xml_space), text.size()));
    return text.substr(0, text.find_last_not_of(xml_space) + 1);
}

std::optional<double> parse_number(std::string_view text) {
    const auto number = number_of_word(trimmed(text));
    return number && std::isfinite(*number) ? number : std::nullopt;  // "inf" and "nan" are no numbers of 3MF
}

std::optional<std::uint32_t> parse_whole_number(std::string_view text) {
    constexpr std::uint32_t most = 0x7FFFFFFF;
    text = trimmed(text);
    if (text.starts_with('+') && text.size() > 1) text.remove_prefix(1);
    std::uint32_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool whole = !text.empty() && end == text.data() + text.size() && error == std::errc();
    return whole && value <= most ? std::optional(value) : std::nullopt;
}

std::optional<Pose> parse_matrix(std::string_view text) {
    Pose pose;
    std::size_t count = 0;
    for (text = trimmed(text); !text.empty(); text = trimmed(text)) {
        const std::string_view word = text.substr(0, text.find_first_of(xml_space));
        text.remove_prefix(word.size());
        const auto number = parse_number(word);
        if (!number || count == 12) return std::nullopt;
        pose.rows[count % 3][count / 3] = *number;
        ++count;
    }
    return count == 12 ? std::optional(pose) : std::nullopt;
}

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
