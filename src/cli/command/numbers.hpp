// Numbers on the command line: decimal, whole, of no locale.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

namespace octopair::cli {

inline constexpr unsigned most_threads = 1024;  ///< that an option may ask for

/// A whole number from 0 to `most`. Throws Error{usage} that names `option`.
std::uint64_t parse_count(std::string_view option, const std::string& text,
                          std::uint64_t most = std::numeric_limits<std::uint64_t>::max());

/// Bytes: a whole number, perhaps with K, M, G or T, which count by 1024. Throws Error{usage} that names `option`.
std::uint64_t parse_bytes(std::string_view option, const std::string& text);

/// A finite number >= 0. Throws Error{usage} that names `option`.
double parse_length(std::string_view option, const std::string& text);

/// 1234567 as "1,234,567".
std::string grouped(std::uint64_t number);

}  // namespace octopair::cli
