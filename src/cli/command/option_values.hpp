// Checks and parses values of options. Numbers are decimal. Parsing does not depend on the locale, and the whole text must be a
// number.
// No output file may replace an input, or another output.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace octopair::cli {

/// Throws: Error{usage} that names `option`, lists the valid values, and suggests a similar one, unless `value` is one of them.
void check_value(std::string_view option, const std::vector<std::string_view>& valid, const std::string& value);

/// Returns a whole number from 0 to `most`. Throws: Error{usage} that names `option`.
std::uint64_t parse_count(std::string_view option, const std::string& text,
                          std::uint64_t most = std::numeric_limits<std::uint64_t>::max());

/// Returns the value of --threads. Throws: Error{usage} for more than max_threads (octopair/limits.hpp).
unsigned parse_threads(const std::string& text);

/// Returns a number of bytes. The suffixes K, M, G and T are powers of 1024. Throws: Error{usage} that names `option`.
std::uint64_t parse_bytes(std::string_view option, const std::string& text);

/// Returns a finite number >= 0. Throws: Error{usage} that names `option`.
double parse_length(std::string_view option, const std::string& text);

/// Returns the number with commas between groups of three digits: 1234567 gives "1,234,567".
std::string grouped(std::uint64_t number);

/// A file of an option, for messages. An empty path means that the option is not given.
struct FileOption {
    std::string_view option;  ///< empty: the file is an argument
    std::string path;
};

/// Throws: Error{usage} if an output is the same regular file as an input or another output, also by another name or through a link.
void check_outputs(const std::vector<FileOption>& inputs, const std::vector<FileOption>& outputs);

}  // namespace octopair::cli
