// ZipArchive: the entries of a ZIP archive in memory, and their content.
//
// - The directory at the end of the archive lists the entries. Each entry that is read must have a header that agrees with the directory.
// - Entries do not overlap each other or the directory. So an archive cannot unpack the same bytes many times.
// - An entry is stored or deflated. Its size and its CRC-32 must be those of the directory. It is unpacked piece by piece.
// - ZIP64 is read. Archives of several parts and encrypted entries are refused.
//
// Source: PKWARE, APPNOTE.TXT, the ZIP file format specification, sections 4.3 and 4.4; RFC 1951.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/meshes/read_budget.hpp"

namespace octopair::io::three_mf {

/// An entry as the directory describes it.
struct ZipEntry {
    std::string_view name;  ///< borrowed from the archive
    std::uint16_t flags = 0, method = 0;
    std::uint32_t crc = 0;
    std::uint64_t packed_size = 0, size = 0;
    std::uint64_t offset = 0;  ///< offset of the header before the content
    std::uint64_t end = 0;     ///< offset of the next entry, or of the directory, which follows the content
};

class ZipArchive {
public:
    /// Reads the directory. Borrows the bytes and the budget.
    /// Throws: Error{bad_input} if there is no directory or it is wrong; Error{resource_limit}.
    ZipArchive(std::span<const std::byte> bytes, ReadBudget& budget);

    const std::vector<ZipEntry>& entries() const { return entries_; }

    /// Receives the next bytes of an entry. Returns false to stop unpacking.
    using Consumer = std::function<bool(std::string_view piece)>;
    /// Unpacks an entry in pieces of at most 64 KiB. If the consumer stops, the rest of the entry is not checked.
    /// Throws: Error{bad_input} "FILE: NAME: ..." if the entry is damaged, or packed in another way; Error{resource_limit} if all
    /// unpacked entries are larger than ReadBudget::limit(); Error{cancelled}; what the consumer throws.
    void unpack(const ZipEntry& entry, const Consumer& consumer);

private:
    struct Directory;
    Directory find_directory() const;
    void read_directory(const Directory& directory);
    void find_ends(std::uint64_t directory_offset);
    std::span<const std::byte> packed(const ZipEntry& entry) const;
    void inflate(const ZipEntry& entry, std::span<const std::byte> from, const Consumer& consumer);
    void copy(const ZipEntry& entry, std::span<const std::byte> from, const Consumer& consumer);
    [[noreturn]] void refuse_archive(std::string_view what) const;
    [[noreturn]] void refuse_entry(const ZipEntry& entry, std::string_view what) const;

    std::span<const std::byte> bytes_;
    ReadBudget& budget_;
    std::vector<ZipEntry> entries_;
    std::uint64_t unpacked_ = 0;  // bytes that were unpacked from all entries
};

}  // namespace octopair::io::three_mf
