// ZipWriter: writes ZIP archives for tests, in all forms that readers must know.
#pragma once

#include <zlib.h>

#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>

namespace octopair::test {

/// Appends a number in little endian.
template <typename T>
void append_number(std::string& to, T number) {
    for (std::size_t i = 0; i < sizeof(T); ++i) to += char(std::uint64_t(number) >> (8 * i) & 0xFF);
}

/// Returns the raw deflated data of a text.
inline std::string deflated(std::string_view text, int level = 6) {
    z_stream stream{};
    if (deflateInit2(&stream, level, Z_DEFLATED, -MAX_WBITS, 8, Z_DEFAULT_STRATEGY) != Z_OK)
        throw std::runtime_error("zlib fails");
    std::string packed(deflateBound(&stream, uLong(text.size())), '\0');
    stream.next_in = const_cast<Bytef*>(reinterpret_cast<const Bytef*>(text.data()));
    stream.avail_in = uInt(text.size());
    stream.next_out = reinterpret_cast<Bytef*>(packed.data());
    stream.avail_out = uInt(packed.size());
    deflate(&stream, Z_FINISH);
    deflateEnd(&stream);
    return packed.substr(0, stream.total_out);
}

/// How an entry is written.
struct ZipForm {
    bool deflate = true;
    bool sizes_follow = false;  ///< the header before the entry has no sizes; they are after it
    bool zip64 = false;
    std::string comment = {};
};

class ZipWriter {
public:
    void add(std::string_view name, std::string_view content, const ZipForm& form = {}) {
        const std::string packed = form.deflate ? deflated(content) : std::string(content);
        const auto crc = std::uint32_t(
            crc32(crc32(0, nullptr, 0), reinterpret_cast<const Bytef*>(content.data()), uInt(content.size())));
        add_packed(name, packed, {crc, content.size()}, form);
    }

    /// Checksum and size of the content of an entry.
    struct Unpacked {
        std::uint32_t crc;
        std::uint64_t size;
    };
    /// Adds an entry whose data may disagree with what the archive says.
    void add_packed(std::string_view name, std::string_view packed, const Unpacked& unpacked, const ZipForm& form) {
        const std::uint64_t offset = bytes_.size();
        bytes_ += "PK\x03\x04";
        add_shared(bytes_, form);
        std::string fields;
        append_number(fields, form.sizes_follow ? 0 : unpacked.crc);
        append_number(fields, form.sizes_follow ? 0 : form.zip64 ? in_zip64 : std::uint32_t(packed.size()));
        append_number(fields, form.sizes_follow ? 0 : form.zip64 ? in_zip64 : std::uint32_t(unpacked.size));
        bytes_ += fields;
        const std::string local_extra = form.zip64 && !form.sizes_follow ? extra({unpacked.size, packed.size()}) : "";
        append_number(bytes_, std::uint16_t(name.size()));
        append_number(bytes_, std::uint16_t(local_extra.size()));
        bytes_ += std::string(name) + local_extra + std::string(packed);
        if (form.sizes_follow) {
            bytes_ += "PK\x07\x08";
            append_number(bytes_, unpacked.crc);
            append_number(bytes_, std::uint32_t(packed.size()));
            append_number(bytes_, std::uint32_t(unpacked.size));
        }
        directory_ += "PK\x01\x02";
        append_number(directory_, std::uint16_t(45));
        add_shared(directory_, form);
        append_number(directory_, unpacked.crc);
        append_number(directory_, form.zip64 ? in_zip64 : std::uint32_t(packed.size()));
        append_number(directory_, form.zip64 ? in_zip64 : std::uint32_t(unpacked.size));
        const std::string wide = form.zip64 ? extra({unpacked.size, packed.size(), offset}) : "";
        append_number(directory_, std::uint16_t(name.size()));
        append_number(directory_, std::uint16_t(wide.size()));
        append_number(directory_, std::uint16_t(form.comment.size()));
        directory_ += std::string(8, '\0');  // number of the disk, attributes
        append_number(directory_, form.zip64 ? in_zip64 : std::uint32_t(offset));
        directory_ += std::string(name) + wide + form.comment;
        ++count_;
    }

    /// Returns the archive. `zip64`: with the directory of ZIP64.
    std::string bytes(bool zip64 = false, std::string_view comment = {}) const {
        std::string all = bytes_ + directory_;
        if (zip64) {
            const std::uint64_t end64 = all.size();
            all += "PK\x06\x06";
            append_number(all, std::uint64_t(44));
            append_number(all, std::uint32_t(0x002D002D));
            all += std::string(8, '\0');
            for (const std::uint64_t number :
                 {count_, count_, std::uint64_t(directory_.size()), std::uint64_t(bytes_.size())})
                append_number(all, number);
            all += "PK\x06\x07" + std::string(4, '\0');
            append_number(all, end64);
            append_number(all, std::uint32_t(1));
        }
        all += "PK\x05\x06" + std::string(4, '\0');
        append_number(all, zip64 ? std::uint16_t(0xFFFF) : std::uint16_t(count_));
        append_number(all, zip64 ? std::uint16_t(0xFFFF) : std::uint16_t(count_));
        append_number(all, zip64 ? in_zip64 : std::uint32_t(directory_.size()));
        append_number(all, zip64 ? in_zip64 : std::uint32_t(bytes_.size()));
        append_number(all, std::uint16_t(comment.size()));
        return all + std::string(comment);
    }

private:
    static constexpr std::uint32_t in_zip64 = 0xFFFFFFFF;

    /// Appends the fields that the header and the directory have in common.
    static void add_shared(std::string& to, const ZipForm& form) {
        append_number(to, std::uint16_t(form.zip64 ? 45 : 20));
        append_number(to, std::uint16_t(form.sizes_follow ? 8 : 0));
        append_number(to, std::uint16_t(form.deflate ? 8 : 0));
        append_number(to, std::uint32_t(0x00210000));  // 1 January 1980
    }
    static std::string extra(std::initializer_list<std::uint64_t> numbers) {
        std::string field;
        append_number(field, std::uint16_t(0x5455));  // a field that readers skip
        append_number(field, std::uint16_t(1));
        field += 'x';
        append_number(field, std::uint16_t(1));
        append_number(field, std::uint16_t(8 * numbers.size()));
        for (const std::uint64_t number : numbers) append_number(field, number);
        return field;
    }

    std::string bytes_, directory_;
    std::uint64_t count_ = 0;
};

}  // namespace octopair::test
