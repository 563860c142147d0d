#include "io/meshes/three_mf/attribute_values.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <string>

namespace octopair::io::three_mf {

namespace {

constexpr std::string_view xml_space = " \t\r\n";

/// Returns the number of a text that std::from_chars finds out of range: 0, the least numbers, or infinity.
double extreme_number(std::string_view text) { return std::strtod(std::string(text).c_str(), nullptr); }

}  // namespace

std::string_view trimmed(std::string_view text) {
    text.remove_prefix(std::min(text.find_first_not_of(xml_space), text.size()));
    return text.substr(0, text.find_last_not_of(xml_space) + 1);
}

std::optional<double> parse_number(std::string_view text) {
    text = trimmed(text);
    if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || end != text.data() + text.size()) return std::nullopt;
    if (error == std::errc::result_out_of_range) value = extreme_number(text);
    return std::isfinite(value) ? std::optional(value) : std::nullopt;  // "inf" and "nan" are no numbers of 3MF
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

}  // namespace octopair::io::three_mf
