// Free memory: how much memory this process can still get, and texts with amounts.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "base/private_export.hpp"

namespace octopair {

/// Returns an upper bound on the bytes of memory that this process can still fill where it has mapped addresses. It is the lesser of: the
/// available memory and the free swap space of the machine (/proc/meminfo), and what the control groups of this process leave. Returns
/// nothing if neither can be read. `root`: folder that contains proc and sys. Complexity: reads a few files, some 50 microseconds.
OCTOPAIR_PRIVATE_EXPORT std::optional<std::uint64_t> free_mapped_memory(const std::string& root = "");

/// Returns an upper bound on the bytes of memory that this process can still allocate: as free_mapped_memory(), but at most what RLIMIT_AS
/// leaves.
OCTOPAIR_PRIVATE_EXPORT std::optional<std::uint64_t> free_memory(const std::string& root = "");

/// Returns a number with a comma before each group of three digits: 12,345,678.
OCTOPAIR_PRIVATE_EXPORT std::string digit_groups(std::uint64_t number);

/// Returns an amount of bytes with its unit, rounded to three significant digits: 999 bytes, 1.60 GB, 160 GB. 1 GB is 10^9 bytes.
OCTOPAIR_PRIVATE_EXPORT std::string byte_text(std::uint64_t bytes);

}  // namespace octopair
