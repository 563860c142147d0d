#include "io/meshes/ifc_elements.hpp"

#include <charconv>
#include <cstdint>
#include <optional>

namespace octopair::io {

namespace {

void append_utf8(std::string& text, std::uint32_t letter) {
    if (letter < 0x80) {
        text += char(letter);
        return;
    }
    if (letter < 0x800) {
        text += char(0xC0 | letter >> 6);
    } else if (letter < 0x10000) {
        text += char(0xE0 | letter >> 12);
        text += char(0x80 | (letter >> 6 & 0x3F));
    } else {
        text += char(0xF0 | letter >> 18);
        text += char(0x80 | (letter >> 12 & 0x3F));
        text += char(0x80 | (letter >> 6 & 0x3F));
    }
    text += char(0x80 | (letter & 0x3F));
}

/// Returns the number of `digits` hexadecimal digits at the beginning of a text.
std::optional<std::uint32_t> hexadecimal(std::string_view text, std::size_t digits) {
    if (text.size() < digits) return std::nullopt;
    std::uint32_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + digits, value, 16);
    if (error != std::errc() || end != text.data() + digits) return std::nullopt;
    return value;
}

/// Decodes the letters of \X2\ (4 digits each) or \X4\ (8 digits each), up to \X0\. Appends them to `decoded`. Returns the number of
/// bytes read; 0 if the code is not valid.
std::size_t decode_letters(std::string_view text, std::size_t digits, std::string& decoded) {
    std::string letters;
    std::uint32_t high = 0;  // first half of a UTF-16 pair
    std::size_t at = 0;
    for (; !text.substr(at).starts_with("\\X0\\"); at += digits) {
        const auto letter = hexadecimal(text.substr(at), digits);
        if (!letter || *letter > 0x10FFFF) return 0;
        const bool is_high = *letter >= 0xD800 && *letter < 0xDC00, is_low = *letter >= 0xDC00 && *letter < 0xE000;
        if (is_low != (high != 0) || (is_high && digits != 4)) return 0;
        if (is_high) {
            high = *letter;
            continue;
        }
        append_utf8(letters, is_low ? 0x10000 + ((high - 0xD800) << 10) + (*letter - 0xDC00) : *letter);
        high = 0;
    }
    if (high != 0) return 0;
    decoded += letters;
    return at + 4;
}

/// Decodes a code that begins with a backslash. Returns the number of bytes read; 0 if the code is not valid.
std::size_t decode_code(std::string_view text, std::string& decoded) {
    if (text.starts_with("\\\\")) {
        decoded += '\\';
        return 2;
    }
    if (text.starts_with("\\S\\") && text.size() > 3) {
        append_utf8(decoded, 0x80 | static_cast<unsigned char>(text[3]));
        return 4;
    }
    if (text.starts_with("\\X\\")) {
        const auto letter = hexadecimal(text.substr(3), 2);
        if (letter) append_utf8(decoded, *letter);
        return letter ? 5 : 0;
    }
    for (const auto& [begin, digits] : {std::pair("\\X2\\", 4u), std::pair("\\X4\\", 8u)}) {
        if (!text.starts_with(begin)) continue;
        const std::size_t read = decode_letters(text.substr(4), digits, decoded);
        return read == 0 ? 0 : 4 + read;
    }
    return 0;
}

constexpr std::string_view space = " \t\r\n", digits = "0123456789",
                           keyword = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_";

/// Reads the instances of a STEP file: #NUMBER = KEYWORD(attributes);
class StepReader {
public:
    explicit StepReader(std::string_view step) : rest_(step) {}

    bool at_end() const { return rest_.empty(); }

    /// Skips white space and comments. Returns whether the next character is `c`, and skips that one, too.
    bool take(char c) {
        skip(space);
        while (rest_.starts_with("/*")) {
            const std::size_t end = rest_.find("*/", 2);
            rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 2);
            skip(space);
        }
        if (rest_.empty() || rest_.front() != c) return false;
        rest_.remove_prefix(1);
        return true;
    }
    /// Reads a text in quotes, without decoding it.
    std::optional<std::string_view> take_text() {
        if (!take('\'')) return std::nullopt;
        for (std::size_t at = rest_.find('\''); at != std::string_view::npos; at = rest_.find('\'', at + 2)) {
            if (at + 1 < rest_.size() && rest_[at + 1] == '\'') continue;
            const std::string_view text = rest_.substr(0, at);
            rest_.remove_prefix(at + 1);
            return text;
        }
        return std::nullopt;
    }
    /// Skips all characters of `set`.
    void skip(std::string_view set) {
        const std::size_t end = rest_.find_first_not_of(set);
        rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end);
    }
    /// Goes behind the next ";" that is not in a text.
    void skip_instance() {
        while (!rest_.empty()) {
            const std::size_t at = rest_.find_first_of(";'/");
            if (at == std::string_view::npos) break;
            rest_.remove_prefix(at);
            if (take(';')) return;
            if (!rest_.empty() && rest_.front() == '\'' && !take_text()) break;
            if (!rest_.empty() && rest_.front() == '/') rest_.remove_prefix(1);
        }
        rest_ = {};
    }

private:
    std::string_view rest_;
};

/// Reads the beginning of an instance, #NUMBER = KEYWORD(GLOBALID, OWNER, NAME. Adds the name, if the instance has both texts.
void read_instance(StepReader& reader, IfcNames& names) {
    constexpr std::size_t id_length = 22;
    if (!reader.take('#')) return;
    reader.skip(digits);
    if (!reader.take('=')) return;
    reader.skip(space);
    reader.skip(keyword);
    if (!reader.take('(')) return;
    const auto id = reader.take_text();
    if (!id || id->size() != id_length || !reader.take(',')) return;
    reader.skip(" \t\r\n#$*");
    reader.skip(digits);
    if (!reader.take(',')) return;
    const auto name = reader.take_text();
    if (name && !name->empty()) names.emplace(*id, decode_step_text(*name));
}

}  // namespace

std::optional<IfcElement> parse_ifc_element(std::string_view node_name) {
    constexpr std::size_t id_length = 22;
    if (!node_name.starts_with("Ifc") || node_name.size() < id_length + 2) return std::nullopt;
    const std::size_t type_end = node_name.find('_'), name_end = node_name.size() - id_length - 1;
    if (node_name[name_end] != '_' || type_end > name_end) return std::nullopt;
    IfcElement element{node_name.substr(0, type_end), {}, node_name.substr(name_end + 1)};
    if (type_end < name_end) element.name = node_name.substr(type_end + 1, name_end - type_end - 1);
    if (element.name == "Unnamed") element.name = {};  // by Assimp
    return element;
}

std::string decode_step_text(std::string_view text) {
    std::string decoded;
    for (std::size_t at = 0; at < text.size();) {
        const char c = text[at];
        if (c == '\'' && text.substr(at).starts_with("''")) ++at;
        if (const std::size_t read = c == '\\' ? decode_code(text.substr(at), decoded) : 0) {
            at += read;
            continue;
        }
        decoded += c;
        ++at;
    }
    return decoded;
}

IfcNames find_ifc_names(std::string_view step) {
    IfcNames names;
    StepReader reader(step);
    while (!reader.at_end()) {
        read_instance(reader, names);
        reader.skip_instance();
    }
    return names;
}

}  // namespace octopair::io
