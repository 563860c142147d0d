#include "viewer/scene/answer.hpp"

#include <zlib.h>

#include <charconv>
#include <new>
#include <nlohmann/json.hpp>

namespace octopair::viewer {

namespace {

constexpr int gzip_format = 15 + 16;  // for zlib: the largest window, in the format of gzip

int hex_value(char digit) {
    if (digit >= '0' && digit <= '9') return digit - '0';
    const char lower = char(digit | 0x20);
    return lower >= 'a' && lower <= 'f' ? lower - 'a' + 10 : -1;
}

/// Decodes %XX. In a query, "+" is a space.
std::optional<std::string> decoded(std::string_view text, bool query) {
    std::string out;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] != '%') {
            out += query && text[i] == '+' ? ' ' : text[i];
            continue;
        }
        if (i + 2 >= text.size() || hex_value(text[i + 1]) < 0 || hex_value(text[i + 2]) < 0) return std::nullopt;
        out += char(hex_value(text[i + 1]) * 16 + hex_value(text[i + 2]));
        i += 2;
    }
    if (out.find('\0') != std::string::npos) return std::nullopt;
    return out;
}

std::vector<std::string_view> split(std::string_view text, char separator) {
    std::vector<std::string_view> parts;
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find(separator, begin), text.size());
        parts.push_back(text.substr(begin, end - begin));
        begin = end + 1;
    }
    return parts;
}

}  // namespace

std::optional<Address> Address::parse(std::string_view target) {
    if (target.empty() || target.front() != '/') return std::nullopt;
    const std::size_t question = std::min(target.find('?'), target.size());
    const auto path = decoded(target.substr(1, question - 1), false);
    if (!path) return std::nullopt;
    Address address;
    address.path_ = *path;
    for (const std::string_view part : address.parts()) {
        if (part == "." || part == "..") return std::nullopt;
    }
    if (question + 1 >= target.size()) return address;
    for (const std::string_view field : split(target.substr(question + 1), '&')) {
        const std::size_t equals = std::min(field.find('='), field.size());
        const auto name = decoded(field.substr(0, equals), true);
        const auto value = decoded(equals < field.size() ? field.substr(equals + 1) : std::string_view(), true);
        if (!name || !value) return std::nullopt;
        address.parameters_[*name] = *value;
    }
    return address;
}

std::vector<std::string_view> Address::parts() const { return split(path_, '/'); }

std::string_view Address::parameter(const std::string& name) const {
    const auto found = parameters_.find(name);
    return found == parameters_.end() ? std::string_view() : std::string_view(found->second);
}

Address Address::below(std::string_view first) const {
    Address rest = *this;
    rest.path_.erase(0, std::min(first.size() + 1, rest.path_.size()));
    return rest;
}

std::optional<std::uint64_t> whole_number(std::string_view text) {
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || error != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return value;
}

std::string gzip(std::string_view bytes, int level) {
    z_stream stream{};
    if (deflateInit2(&stream, level, Z_DEFLATED, gzip_format, 8, Z_DEFAULT_STRATEGY) != Z_OK) throw std::bad_alloc();
    std::string out(deflateBound(&stream, uLong(bytes.size())), '\0');
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    stream.avail_in = uInt(bytes.size());
    stream.next_out = reinterpret_cast<Bytef*>(out.data());
    stream.avail_out = uInt(out.size());
    const int result = deflate(&stream, Z_FINISH);
    out.resize(stream.total_out);
    deflateEnd(&stream);
    if (result != Z_STREAM_END) throw std::bad_alloc();
    return out;
}

std::string base64(std::string_view bytes) {
    constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    out.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t word = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            word = word << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
        }
        for (std::size_t k = 0; k < 4; ++k) {
            out += i + k > bytes.size() ? '=' : digits[word >> (18 - 6 * k) & 63];
        }
    }
    return out;
}

namespace {

std::string message(const nlohmann::ordered_json& json) {
    return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace

std::string progress_message(std::string_view what, double done) {
    return message({{"event", "progress"}, {"what", what}, {"done", done}});
}
std::string ready_message() { return message({{"event", "ready"}}); }
std::string failed_message(std::string_view why) { return message({{"event", "failed"}, {"message", why}}); }
std::string waiting_message(std::string_view why) { return message({{"event", "waiting"}, {"message", why}}); }
std::string timeline_message(std::uint64_t done) { return message({{"event", "timeline"}, {"done", done}}); }
std::string closed_message() { return message({{"event", "closed"}}); }

}  // namespace octopair::viewer
