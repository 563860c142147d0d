// FileMapping: parts of files that are mapped into memory, so that large files are not copied. The system reads a page when it
// is used, and drops pages when memory is short. So a file may be larger than the memory.
//
// Invariants
//   Mappings are private: a write changes neither the file nor what other processes see.
//   If another program writes or shortens a mapped file, the numbers in memory change at any time. So code that reads a number again
//   must accept any value. After such a change check_mapping() throws, as InputFile::check_unchanged() does.
//   Pages that cannot be read, such as those that a shortened file loses, get bytes of 0xFF, which are NaN as floats. Without this, the
//   system would end the process by SIGBUS. If a shortened file ends within a page, the rest of the page reads as zeros.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "base/memory.hpp"
#include "io/files/input_file.hpp"

namespace octopair::io {

/// Maps a part of a file. Returns null if the system or a limit of this process (64 mappings) refuses.
/// Requires: mapped_pages().free() is called with the result and `bytes`.
/// Thread safety: any thread may call it.
void* map_file(const InputFile& file, std::uint64_t offset, std::size_t bytes);

/// Returns the source of mapped pages, for a Buffer that adopts them. It reserves no pages.
PageSource& mapped_pages();

/// Returns whether `memory` belongs to a mapping.
bool is_mapped(std::span<const std::byte> memory);

/// Throws: Error{bad_input} if `memory` belongs to a mapping whose file was changed since it was opened; Error{io_failed} if
/// a page could not be read. Other memory is not checked.
void check_mapping(std::span<const std::byte> memory);

}  // namespace octopair::io
