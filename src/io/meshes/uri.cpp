#include "io/meshes/uri.hpp"

#include <array>
#include <cstdint>

#include "io/files/failure.hpp"
#include "io/files/letter_case.hpp"

namespace octopair::io {

namespace {

/// Returns the value of a hexadecimal digit, or -1.
int hex_digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

constexpr std::uint8_t no_digit = 64;

/// Value of each digit of base64 and base64url; `no_digit` for other characters.
constexpr std::array<std::uint8_t, 256> base64_digits = [] {
    constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::array<std::uint8_t, 256> values{};
    values.fill(no_digit);
    for (std::size_t i = 0; i < digits.size(); ++i) values[std::uint8_t(digits[i])] = std::uint8_t(i);
    values['-'] = values['+'];
    values['_'] = values['/'];
    return values;
}();

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

}  // namespace

std::string percent_decoded(std::string_view uri) {
    std::string text;
    text.reserve(uri.size());
    for (std::size_t i = 0; i < uri.size(); ++i) {
        const int high = i + 2 < uri.size() ? hex_digit(uri[i + 1]) : -1;
        const int low = i + 2 < uri.size() ? hex_digit(uri[i + 2]) : -1;
        if (uri[i] == '%' && high >= 0 && low >= 0) {
            text.push_back(char(high * 16 + low));
            i += 2;
        } else {
            text.push_back(uri[i]);
        }
    }
    return text;
}

std::optional<std::string_view> scheme_of(std::string_view uri) {
    for (std::size_t i = 0; i < uri.size(); ++i) {
        const char c = uri[i];
        if (c == ':') return i == 0 ? std::nullopt : std::optional(uri.substr(0, i));
        const bool inside = (c >= '0' && c <= '9') || c == '+' || c == '-' || c == '.';
        if (!is_letter(c) && !(i > 0 && inside)) return std::nullopt;
    }
    return std::nullopt;
}

std::optional<UriData> data_of(std::string_view uri) {
    const std::size_t comma = uri.find(',');
    if (comma == std::string_view::npos) return std::nullopt;
    std::string_view head = uri.substr(0, comma);
    head = head.substr(0, head.find_last_not_of(' ') + 1);
    const std::size_t last = head.find_last_of("; ");
    const bool is_base64 = last != std::string_view::npos && equal_in_any_case(head.substr(last + 1), "base64");
    return UriData{uri.substr(comma + 1), is_base64};
}

std::string without_blanks(std::string_view text) {
    std::string rest(text);
    std::erase_if(rest, [](char c) { return c == ' ' || (c >= '\t' && c <= '\r'); });
    return rest;
}

std::optional<Buffer<std::byte>> decoded_base64(std::string_view text, const std::stop_token& stop) {
    for (int padding = 0; padding < 2 && text.ends_with('='); ++padding) text.remove_suffix(1);
    if (text.size() % 4 == 1) return std::nullopt;
    Buffer<std::byte> bytes{text.size() / 4 * 3 + (text.size() % 4 == 0 ? 0 : text.size() % 4 - 1)};
    std::size_t written = 0;
    for (std::size_t begin = 0; begin < text.size(); begin += 4) {
        constexpr std::size_t piece = std::size_t(1) << 20;
        if (begin % piece == 0 && stop.stop_requested()) cancel();
        const std::size_t digits = std::min<std::size_t>(4, text.size() - begin);
        std::uint32_t bits = 0;
        for (std::size_t i = 0; i < 4; ++i) {
            const std::uint8_t digit = i < digits ? base64_digits[std::uint8_t(text[begin + i])] : std::uint8_t(0);
            if (digit == no_digit) return std::nullopt;
            bits = bits << 6 | digit;
        }
        for (std::size_t i = 0; i + 1 < digits; ++i) bytes.data()[written++] = std::byte(bits >> (16 - 8 * i));
    }
    return bytes;
}

}  // namespace octopair::io
