#include "io/meshes/three_mf/zip_archive.hpp"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <new>

#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "io/json/json_fields.hpp"
#include "octopair/error.hpp"

namespace octopair::io::three_mf {

namespace {

constexpr std::string_view end_mark = "PK\x05\x06", end64_mark = "PK\x06\x06", locator_mark = "PK\x06\x07",
                           entry_mark = "PK\x01\x02", local_mark = "PK\x03\x04";
constexpr std::size_t end_bytes = 22, end64_bytes = 56, locator_bytes = 20, entry_bytes = 46, local_bytes = 30;
constexpr std::uint32_t in_zip64 = 0xFFFFFFFF;  // marks a number that is in a field of ZIP64
constexpr std::size_t piece_bytes = 65536;

/// Reads a little-endian number. Requires: `bytes` has all bytes of the number.
template <typename T>
T number_in(std::string_view bytes, std::size_t offset) {
    std::uint64_t number = 0;
    for (std::size_t i = sizeof(T); i-- > 0;) number = number << 8 | std::uint8_t(bytes[offset + i]);
    return T(number);
}

std::string_view text_in(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Returns the fields of ZIP64 of an entry; empty if there are none.
std::string_view zip64_fields(std::string_view extra) {
    constexpr std::uint16_t zip64 = 1;
    while (extra.size() >= 4) {
        const std::size_t size = number_in<std::uint16_t>(extra, 2);
        if (size > extra.size() - 4) break;
        if (number_in<std::uint16_t>(extra, 0) == zip64) return extra.substr(4, size);
        extra.remove_prefix(4 + size);
    }
    return {};
}

/// State of zlib. The destructor frees it.
class Inflater {
public:
    Inflater() {
        // A negative number of bits: raw data without a header.
        if (inflateInit2(&stream_, -MAX_WBITS) != Z_OK) throw std::bad_alloc();
    }
    Inflater(const Inflater&) = delete;
    Inflater& operator=(const Inflater&) = delete;
    ~Inflater() { inflateEnd(&stream_); }

    /// Passes at most 1 GiB of further packed bytes to zlib, and removes them from `from`.
    void give(std::span<const std::byte>& from) {
        if (stream_.avail_in > 0) return;
        const std::size_t size = std::min<std::size_t>(from.size(), std::size_t(1) << 30);
        stream_.next_in = const_cast<Bytef*>(reinterpret_cast<const Bytef*>(from.data()));
        stream_.avail_in = uInt(size);
        from = from.subspan(size);
    }
    /// Unpacks at most as many bytes as `to` has. Returns their number.
    std::size_t take(std::span<char> to) {
        stream_.next_out = reinterpret_cast<Bytef*>(to.data());
        stream_.avail_out = uInt(to.size());
        result_ = ::inflate(&stream_, Z_NO_FLUSH);
        if (result_ == Z_MEM_ERROR) throw std::bad_alloc();
        return to.size() - stream_.avail_out;
    }
    bool ended() const { return result_ == Z_STREAM_END; }
    /// Returns whether the packed data are invalid, or end too early.
    bool failed() const { return result_ != Z_OK && result_ != Z_STREAM_END; }
    bool has_input() const { return stream_.avail_in > 0; }

private:
    z_stream stream_{};
    int result_ = Z_OK;
};

/// Size and checksum of the bytes that were unpacked from an entry.
class UnpackedCheck {
public:
    void add(std::string_view piece) {
        crc_ = ::crc32(crc_, reinterpret_cast<const Bytef*>(piece.data()), uInt(piece.size()));
        size_ += piece.size();
    }
    std::uint64_t size() const { return size_; }
    bool agrees(std::uint64_t size, std::uint32_t crc) const { return size_ == size && crc_ == crc; }

private:
    uLong crc_ = ::crc32(0, nullptr, 0);
    std::uint64_t size_ = 0;
};

}  // namespace

/// Place of the directory, which lists all entries, in the archive.
struct ZipArchive::Directory {
    std::uint64_t entries, size, offset;
};

ZipArchive::ZipArchive(std::span<const std::byte> bytes, ReadBudget& budget) : bytes_(bytes), budget_(budget) {
    const Directory directory = find_directory();
    read_directory(directory);
    find_ends(directory.offset);
}

ZipArchive::Directory ZipArchive::find_directory() const {
    const std::string_view all = text_in(bytes_);
    if (!all.starts_with("PK")) refuse_archive("is not a ZIP archive, which a 3MF file is");
    const std::size_t first = all.size() - std::min(all.size(), end_bytes + 65535);
    std::size_t end = all.rfind(end_mark);
    while (end != std::string_view::npos && end >= first && all.size() - end < end_bytes)
        end = end == 0 ? std::string_view::npos : all.rfind(end_mark, end - 1);
    if (end == std::string_view::npos || end < first)
        refuse_archive("is cut: a ZIP archive ends with its directory; copy or download the file again");
    Directory directory{number_in<std::uint16_t>(all, end + 10), number_in<std::uint32_t>(all, end + 12),
                        number_in<std::uint32_t>(all, end + 16)};
    const std::uint16_t disk = number_in<std::uint16_t>(all, end + 4);
    const bool has_locator = end >= locator_bytes && all.substr(end - locator_bytes).starts_with(locator_mark);
    if (has_locator) {
        const auto end64 = number_in<std::uint64_t>(all, end - locator_bytes + 8);
        const bool inside = end64 <= end - locator_bytes && end - locator_bytes - end64 >= end64_bytes;
        if (!inside || !all.substr(std::size_t(end64)).starts_with(end64_mark))
            refuse_archive("has no ZIP64 directory where it should be; write the file again");
        directory = {number_in<std::uint64_t>(all, std::size_t(end64) + 32),
                     number_in<std::uint64_t>(all, std::size_t(end64) + 40),
                     number_in<std::uint64_t>(all, std::size_t(end64) + 48)};
        end = std::size_t(end64);
    } else if (disk != 0) {
        refuse_archive("is one part of an archive of several parts; join them first");
    }
    if (directory.offset > end || directory.size > end - directory.offset)
        refuse_archive("has a directory that is not inside the archive; write the file again");
    return directory;
}

void ZipArchive::read_directory(const Directory& directory) {
    std::string_view rest = text_in(bytes_).substr(std::size_t(directory.offset), std::size_t(directory.size));
    const auto refuse_directory = [&] { refuse_archive("has a directory that is damaged; write the file again"); };
    if (directory.entries > rest.size() / entry_bytes) refuse_directory();
    budget_.charge(directory.entries, sizeof(ZipEntry));
    entries_.reserve(std::size_t(directory.entries));
    while (!rest.empty()) {
        if (rest.size() < entry_bytes || !rest.starts_with(entry_mark)) refuse_directory();
        const std::size_t name = number_in<std::uint16_t>(rest, 28), extra = number_in<std::uint16_t>(rest, 30),
                          comment = number_in<std::uint16_t>(rest, 32);
        if (name + extra + comment > rest.size() - entry_bytes) refuse_directory();
        ZipEntry entry{.name = rest.substr(entry_bytes, name),
                       .flags = number_in<std::uint16_t>(rest, 8),
                       .method = number_in<std::uint16_t>(rest, 10),
                       .crc = number_in<std::uint32_t>(rest, 16),
                       .packed_size = number_in<std::uint32_t>(rest, 20),
                       .size = number_in<std::uint32_t>(rest, 24),
                       .offset = number_in<std::uint32_t>(rest, 42)};
        std::string_view wide = zip64_fields(rest.substr(entry_bytes + name, extra));
        for (std::uint64_t* const number : {&entry.size, &entry.packed_size, &entry.offset}) {
            if (*number != in_zip64) continue;
            if (wide.size() < 8) refuse_directory();
            *number = number_in<std::uint64_t>(wide, 0);
            wide.remove_prefix(8);
        }
        if (entries_.size() == directory.entries) refuse_directory();
        entries_.push_back(entry);
        rest.remove_prefix(entry_bytes + name + extra + comment);
    }
    if (entries_.size() != directory.entries) refuse_directory();
}

/// Sets ZipEntry::end. Throws: Error{bad_input} if an entry does not fit before it.
void ZipArchive::find_ends(std::uint64_t directory_offset) {
    std::vector<ZipEntry*> by_place;
    by_place.reserve(entries_.size());
    for (ZipEntry& entry : entries_) by_place.push_back(&entry);
    std::sort(by_place.begin(), by_place.end(),
              [](const ZipEntry* a, const ZipEntry* b) { return a->offset < b->offset; });
    for (std::size_t i = 0; i < by_place.size(); ++i) {
        ZipEntry& entry = *by_place[i];
        entry.end = i + 1 < by_place.size() ? by_place[i + 1]->offset : directory_offset;
        const std::uint64_t head = local_bytes + entry.name.size();
        if (entry.offset > directory_offset || entry.end - entry.offset < head ||
            entry.end - entry.offset - head < entry.packed_size)
            refuse_entry(entry, "overlaps another entry of the archive; write the file again");
    }
}

std::span<const std::byte> ZipArchive::packed(const ZipEntry& entry) const {
    constexpr std::uint16_t encrypted = 0x2041, sizes_follow = 0x8;
    if ((entry.flags & encrypted) != 0) refuse_entry(entry, "is encrypted; write the file without a password");
    const std::string_view head =
        text_in(bytes_).substr(std::size_t(entry.offset), std::size_t(entry.end - entry.offset));
    const auto refuse_head = [&] {
        refuse_entry(entry, "is described in two ways in the archive; write the file again");
    };
    if (!head.starts_with(local_mark)) refuse_head();
    const std::size_t name = number_in<std::uint16_t>(head, 26), extra = number_in<std::uint16_t>(head, 28);
    if (head.substr(local_bytes, name) != entry.name) refuse_head();
    if (number_in<std::uint16_t>(head, 8) != entry.method) refuse_head();
    if (const auto flags = number_in<std::uint16_t>(head, 6); (flags & sizes_follow) == 0) {
        const auto packed_size = number_in<std::uint32_t>(head, 18), size = number_in<std::uint32_t>(head, 22);
        if (number_in<std::uint32_t>(head, 14) != entry.crc) refuse_head();
        if (packed_size != in_zip64 && packed_size != entry.packed_size) refuse_head();
        if (size != in_zip64 && size != entry.size) refuse_head();
    }
    const std::size_t begin = local_bytes + name + extra;
    if (begin > head.size() || entry.packed_size > head.size() - begin) refuse_head();
    return bytes_.subspan(std::size_t(entry.offset) + begin, std::size_t(entry.packed_size));
}

void ZipArchive::unpack(const ZipEntry& entry, const Consumer& consumer) {
    constexpr std::uint16_t stored = 0, deflated = 8;
    const auto from = packed(entry);
    if (entry.size > budget_.limit() - std::min(unpacked_, budget_.limit())) {
        throw Error(ErrorCode::resource_limit,
                    fmt::format("{}: its parts unpack to more than {} bytes, the limit for a file of its size",
                                budget_.path(), budget_.limit()));
    }
    unpacked_ += entry.size;
    if (entry.method == stored) {
        copy(entry, from, consumer);
    } else if (entry.method == deflated) {
        inflate(entry, from, consumer);
    } else {
        refuse_entry(entry, fmt::format("is packed by method {} of ZIP; pack the file with Deflate", entry.method));
    }
}

void ZipArchive::inflate(const ZipEntry& entry, std::span<const std::byte> from, const Consumer& consumer) {
    Inflater inflater;
    UnpackedCheck check;
    std::array<char, piece_bytes> piece;
    while (!inflater.ended()) {
        budget_.checkpoint();
        inflater.give(from);
        const std::string_view got(piece.data(), inflater.take(piece));
        if (inflater.failed()) refuse_entry(entry, "is damaged, or cut; copy or download the file again");
        check.add(got);
        if (check.size() > entry.size) break;
        if (!got.empty() && !consumer(got)) return;
    }
    if (!check.agrees(entry.size, entry.crc) || inflater.has_input() || !from.empty())
        refuse_entry(entry, "is damaged: its size or its checksum is wrong; copy or download the file again");
}

void ZipArchive::copy(const ZipEntry& entry, std::span<const std::byte> from, const Consumer& consumer) {
    UnpackedCheck check;
    while (!from.empty()) {
        budget_.checkpoint();
        const std::string_view piece = text_in(from.first(std::min(from.size(), piece_bytes)));
        from = from.subspan(piece.size());
        check.add(piece);
        if (!consumer(piece)) return;
    }
    if (!check.agrees(entry.size, entry.crc))
        refuse_entry(entry, "is damaged: its size or its checksum is wrong; copy or download the file again");
}

void ZipArchive::refuse_archive(std::string_view what) const { refuse(budget_.path(), what); }

void ZipArchive::refuse_entry(const ZipEntry& entry, std::string_view what) const {
    refuse(budget_.path(), fmt::format("{}: {}", shown_text(entry.name), what));
}

}  // namespace octopair::io::three_mf
