#include "io/boxes/npy_header.hpp"

#include <array>
#include <charconv>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "io/files/failure.hpp"

namespace octopair::io {

namespace {

constexpr std::string_view magic = "\x93NUMPY";

struct TypeRow {
    NpyType type;
    std::string_view text;
    std::size_t bytes;
};
constexpr std::array<TypeRow, 4> types = {{
    {NpyType::float32, "<f4", 4},
    {NpyType::float64, "<f8", 8},
    {NpyType::uint32, "<u4", 4},
    {NpyType::uint64, "<u8", 8},
}};

/// Returns a byte sequence in quotes, as printable ASCII of at most 40 bytes, for messages.
std::string quoted(std::string_view text) {
    std::string out = "'";
    for (const char c : text.substr(0, 40)) {
        if (c >= ' ' && c <= '~') {
            out += c;
        } else {
            out += fmt::format("\\x{:02x}", unsigned(std::uint8_t(c)));
        }
    }
    return out + (text.size() > 40 ? "...'" : "'");
}

struct Fields {
    std::optional<std::string> descr;
    std::optional<bool> fortran_order;
    std::optional<std::vector<std::uint64_t>> shape;
};

/// Parses the dict literal token by token. Between tokens it accepts spaces, but no other Python whitespace or comments.
class DictParser {
public:
    DictParser(std::string_view text, std::string_view file) : text_(text), file_(file) {}

    Fields parse() {
        Fields fields;
        expect('{');
        while (!take('}')) {
            parse_item(fields);
            if (!take(',')) {
                expect('}');
                break;
            }
        }
        if (!fields.descr || !fields.fortran_order || !fields.shape) {
            refuse(file_, "its npy header lacks one of the keys 'descr', 'fortran_order', 'shape'");
        }
        const std::string_view rest = text_.substr(at_);
        if (rest.empty() || rest.back() != '\n' || rest.find_first_not_of(' ') != rest.size() - 1) malformed();
        return fields;
    }

private:
    void parse_item(Fields& fields) {
        const std::string_view key = parse_string();
        expect(':');
        if (key == "descr" && !fields.descr) {
            skip_spaces();
            if (peek() == '[')
                refuse(file_,
                       "its array has a structured type; '<f4' or '<f8' is needed: save one array of plain numbers");
            fields.descr = std::string(parse_string());
        } else if (key == "fortran_order" && !fields.fortran_order) {
            fields.fortran_order = parse_bool();
        } else if (key == "shape" && !fields.shape) {
            fields.shape = parse_shape();
        } else {
            refuse(file_, fmt::format("the key {} of its npy header is repeated or unknown", quoted(key)));
        }
    }

    std::string_view parse_string() {
        skip_spaces();
        const char quote = peek();
        if (quote != '\'' && quote != '"') malformed();
        const std::size_t end = text_.find(quote, at_ + 1);
        if (end == std::string_view::npos) malformed();
        const std::string_view value = text_.substr(at_ + 1, end - at_ - 1);
        at_ = end + 1;
        return value;
    }

    bool parse_bool() {
        skip_spaces();
        for (const bool value : {false, true}) {
            const std::string_view word = value ? "True" : "False";
            if (text_.substr(at_, word.size()) == word) {
                at_ += word.size();
                return value;
            }
        }
        malformed();
    }

    std::vector<std::uint64_t> parse_shape() {
        std::vector<std::uint64_t> shape;
        bool comma = true;
        expect('(');
        while (!take(')')) {
            if (!comma || shape.size() == 32) malformed();
            shape.push_back(parse_length());
            comma = take(',');
        }
        if (shape.size() == 1 && !comma) malformed();  // (3) is a number in Python, not a tuple
        return shape;
    }

    std::uint64_t parse_length() {
        skip_spaces();
        const char* begin = text_.data() + at_;
        const char* end = text_.data() + text_.size();
        std::uint64_t value = 0;
        const auto [stop, error] = std::from_chars(begin, end, value);
        if (error == std::errc::result_out_of_range) refuse(file_, "its npy header has a length beyond 64 bits");
        if (error != std::errc() || (*begin == '0' && stop != begin + 1)) malformed();
        at_ += std::size_t(stop - begin);
        if (peek() == 'L') ++at_;
        return value;
    }

    void skip_spaces() {
        while (peek() == ' ') ++at_;
    }
    char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }
    bool take(char c) {
        skip_spaces();
        if (peek() != c) return false;
        ++at_;
        return true;
    }
    void expect(char c) {
        if (!take(c)) malformed();
    }
    [[noreturn]] void malformed() const {
        refuse(file_,
               fmt::format("its npy header is malformed at character {}: {}; save the array again with numpy.save", at_,
                           quoted(text_.substr(at_))));
    }

    std::string_view text_;
    std::string_view file_;
    std::size_t at_ = 0;
};

/// Returns the header, a Python dictionary as text, and the offset of the data in the file. Throws: Error{bad_input}.
std::pair<std::string_view, std::uint64_t> find_text(std::string_view bytes, std::string_view file) {
    if (bytes.empty()) refuse(file, "is empty");
    const std::string_view start = bytes.substr(0, magic.size());
    if (start != magic.substr(0, start.size())) {
        refuse(file, fmt::format("not an npy file: it begins with {}; save the array with numpy.save", quoted(start)));
    }
    if (bytes.size() < 12) refuse(file, "truncated npy file: it ends within the header; copy or save it again");
    const unsigned major = std::uint8_t(bytes[6]), minor = std::uint8_t(bytes[7]);
    if (major < 1 || major > 3 || minor != 0) {
        refuse(file, fmt::format("npy format version {}.{}; versions 1.0, 2.0 and 3.0 are supported", major, minor));
    }
    const std::size_t begin = major == 1 ? 10 : 12;
    std::uint64_t length = 0;
    for (std::size_t i = begin; i-- > 8;) length = length << 8 | std::uint8_t(bytes[i]);
    if (begin + length > npy_header_max_bytes)
        refuse(file, fmt::format("its npy header has {} bytes, which is too long: at most 65536 are read", length));
    if (begin + length > bytes.size())
        refuse(file, "truncated npy file: it ends within the header; copy or save it again");
    return {bytes.substr(begin, std::size_t(length)), begin + length};
}

/// Sets the type and the byte order of a header from the text of the key 'descr'.
void set_type(NpyHeader& header, std::string_view descr, std::string_view file) {
    header.big_endian = descr.starts_with('>');
    for (const TypeRow& row : types) {
        if (descr.empty() || descr.substr(1) != row.text.substr(1) || !(descr[0] == '<' || header.big_endian)) continue;
        header.type = row.type;
        return;
    }
    refuse(file,
           fmt::format("its array is of type {}; '<f4' or '<f8' is needed: save array.astype('<f8')", quoted(descr)));
}

/// Throws: Error{bad_input} if integers are big endian or in Fortran order, because octopair never writes such integers.
void check_layout(const NpyHeader& header, std::string_view file) {
    if (header.type == NpyType::float32 || header.type == NpyType::float64) return;
    if (header.big_endian) refuse(file, "its integers are big endian; save array.astype('<u4')");
    if (header.fortran_order) refuse(file, "its integers are in Fortran order; save numpy.ascontiguousarray(array)");
}

/// Returns the size of the array in bytes, or nothing if it exceeds 64 bits.
std::optional<std::uint64_t> data_bytes(const NpyHeader& header) {
    std::uint64_t bytes = item_bytes(header.type);
    bool empty = false, overflow = false;
    for (const std::uint64_t length : header.shape) {
        empty |= length == 0;
        overflow |= length != 0 && bytes > std::numeric_limits<std::uint64_t>::max() / length;
        bytes *= length;
    }
    if (empty) return 0;
    return overflow ? std::nullopt : std::optional(bytes);
}

/// Returns the type of an array, with its order of bytes.
std::string type_text(const NpyHeader& header) {
    return (header.big_endian ? ">" : "<") + std::string(io::type_text(header.type).substr(1));
}

void check_size(const NpyHeader& header, std::uint64_t file_size, std::string_view file) {
    const std::optional<std::uint64_t> needed = data_bytes(header);
    const std::uint64_t present = file_size - header.data_offset;
    if (needed && *needed == present) return;
    const std::string_view verdict =
        !needed || present < *needed ? "the file is truncated" : "the file has trailing bytes";
    refuse(file, fmt::format("{}: shape {} of '{}' needs {} bytes of data, found {}", verdict, shape_text(header.shape),
                             type_text(header), needed ? std::to_string(*needed) : "more than 2^64", present));
}

}  // namespace

std::size_t item_bytes(NpyType type) { return types[std::size_t(type)].bytes; }
std::string_view type_text(NpyType type) { return types[std::size_t(type)].text; }

std::string shape_text(std::span<const std::uint64_t> shape) {
    return shape.size() == 1 ? fmt::format("({},)", shape[0]) : fmt::format("({})", fmt::join(shape, ", "));
}

NpyHeader parse_npy_header(std::span<const std::byte> bytes, std::uint64_t file_size, std::string_view file) {
    const std::string_view characters(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const auto [text, data_offset] = find_text(characters, file);
    const Fields fields = DictParser(text, file).parse();
    NpyHeader header;
    set_type(header, *fields.descr, file);
    header.fortran_order = *fields.fortran_order;
    header.shape = *fields.shape;
    header.data_offset = data_offset;
    check_layout(header, file);
    check_size(header, file_size, file);
    return header;
}

std::string make_npy_header(NpyType type, std::span<const std::uint64_t> shape) {
    const std::string dict =
        fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': {}, }}", type_text(type), shape_text(shape));
    const std::size_t total = std::max<std::size_t>(128, (10 + dict.size() + 1 + 63) / 64 * 64);
    std::string header(magic);
    const std::size_t length = total - 10;
    for (const std::size_t byte : {std::size_t(1), std::size_t(0), length & 0xff, length >> 8}) header += char(byte);
    header += dict;
    header.resize(total - 1, ' ');
    return header + '\n';
}

}  // namespace octopair::io
