// Values of the attributes of 3MF: numbers, identifiers and matrices, as the XML schema writes them. White space around a value is allowed.
#pragma once

#include <cstdint>
#include <optional>
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

}  // namespace octopair::io::three_mf
