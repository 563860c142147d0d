// Reads the data of an exported page or a report as a browser does, without code of the viewer. Needs zlib.
#pragma once

#include <gtest/gtest.h>
#include <zlib.h>

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>

namespace octopair::test {

inline int base64_value(char c) {
    constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const std::size_t at = digits.find(c);
    return at == std::string_view::npos ? -1 : int(at);
}

inline std::string from_base64(std::string_view text) {
    EXPECT_EQ(text.size() % 4, 0u);
    std::string bytes;
    std::uint32_t word = 0, bits = 0;
    for (const char c : text) {
        if (c == '=') break;
        EXPECT_GE(base64_value(c), 0);
        word = word << 6 | std::uint32_t(base64_value(c));
        bits += 6;
        if (bits < 8) continue;
        bits -= 8;
        bytes += char(word >> bits & 255);
    }
    return bytes;
}

/// Unpacks gzip of any length, without code of the viewer.
inline std::string unpacked(const std::string& compressed) {
    z_stream stream{};
    EXPECT_EQ(inflateInit2(&stream, 15 + 16), Z_OK);
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(compressed.data()));
    stream.avail_in = uInt(compressed.size());
    std::string out;
    int result = Z_OK;
    while (result == Z_OK) {
        std::array<char, 65536> part;
        stream.next_out = reinterpret_cast<Bytef*>(part.data());
        stream.avail_out = uInt(part.size());
        result = inflate(&stream, Z_NO_FLUSH);
        out.append(part.data(), part.size() - stream.avail_out);
    }
    EXPECT_EQ(result, Z_STREAM_END);
    inflateEnd(&stream);
    return out;
}

/// Returns the data of each address.
inline std::map<std::string, std::string> data_of(const std::string& page) {
    std::map<std::string, std::string> data;
    constexpr std::string_view before = "<script type=\"application/octet-stream\" data-address=\"", end = "</script>";
    for (std::size_t at = 0; (at = page.find(before, at)) != std::string::npos;) {
        const std::size_t name = at + before.size(), quote = page.find("\">", name), last = page.find(end, quote);
        const std::string address = page.substr(name, quote - name);
        EXPECT_FALSE(data.contains(address)) << address;
        data[address] = unpacked(from_base64(std::string_view(page).substr(quote + 2, last - quote - 2)));
        at = last;
    }
    return data;
}

}  // namespace octopair::test
