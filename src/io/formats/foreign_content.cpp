// Recognises content that is no model at all, such as programs, pictures and letters (foreign_content()).
#include "io/formats/content_marks.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "io/formats/format_table.hpp"

namespace octopair::io {

namespace {

using namespace std::string_view_literals;

/// Bytes at the beginning of a file, and what the file is.
struct ForeignMark {
    std::string_view bytes, message;
};

constexpr std::string_view no_scene = "give octopair a model, or boxes as .npy or .csv";

/// Marks have at least four bytes. So a file of a format without a mark is unlikely to begin with one of them.
constexpr auto foreign_marks = std::to_array<ForeignMark>({
    {"\x7f\x45LF"sv, "is a program (ELF), not a model"},
    {"SQLite format 3\0"sv, "is a database (SQLite), not a model; export the model from the program that wrote it"},
    {"{\\rtf"sv, "is a document (RTF), not a model; save it as plain text"},
    {"GIF87a"sv, "is a picture (GIF), not a model"},
    {"GIF89a"sv, "is a picture (GIF), not a model"},
    {"II*\0"sv, "is a picture (TIFF), not a model"},
    {"MM\0*"sv, "is a picture (TIFF), not a model"},
    {"DDS \x7c\0\0\0"sv, "is a picture (DDS), not a model"},
    {"8BPS\0\x01"sv, "is a picture (Photoshop), not a model"},
    {"\x76\x2f\x31\x01"sv, "is a picture (OpenEXR), not a model"},
    {"#?RADIANCE"sv, "is a picture (Radiance), not a model"},
    {"L\0\0\0\x01\x14\x02\0"sv, "is a shortcut of Windows, not the file itself; give the file that it names"},
    {"[InternetShortcut]"sv, "is a shortcut of Windows, not the file itself; download the file that it names"},
    {"[Desktop Entry]"sv, "is a shortcut, not the file itself; give the file that it names"},
    {"\0\x05\x16\x07"sv,
     "has only the attributes that macOS keeps of a file (AppleDouble); give the file without ._ in its name"},
    {"\0\x05\x16\0"sv, "is a file with its attributes in one (AppleSingle); unpack it first"},
    {"/annex/objects/"sv, "is a pointer of git-annex, not the file itself; run `git annex get`"},
    {"outs:\n- md5:"sv, "is a pointer of DVC, not the file itself; run `dvc pull`"},
    {"404: Not Found"sv, "is the answer of a web server, not a model; download the file itself"},
    {"MIME-Version:"sv, "is a message with parts (MIME), not a model; save the part with the model"},
});

std::string_view without_white(std::string_view text) {
    return text.substr(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
}

/// Removes and returns the first line of a text, without its end.
std::string_view take_line_of(std::string_view& text) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.ends_with('\r')) line.remove_suffix(1);
    return line;
}

/// Returns whether a file is a Windows program: it begins with "MZ", and has "PE" at the place that its header names.
bool is_windows_program(std::string_view bytes) {
    if (!bytes.starts_with("MZ") || bytes.size() < 64) return false;
    const auto low = static_cast<unsigned char>(bytes[60]), high = static_cast<unsigned char>(bytes[61]);
    const std::size_t at = low + std::size_t(high) * 256;
    return at + 4 <= bytes.size() && bytes.substr(at, 4) == "PE\0\0"sv;
}

bool is_bitmap(const FileHead& head) {
    if (!head.bytes.starts_with("BM") || head.bytes.size() < 14) return false;
    std::uint64_t size = 0;
    for (std::size_t k = 4; k > 0; --k) size = size * 256 + static_cast<unsigned char>(head.bytes[k + 1]);
    return size == head.size;
}

bool is_webp(std::string_view bytes) { return bytes.starts_with("RIFF") && bytes.substr(8, 4) == "WEBP"; }

/// Returns the name in "-----BEGIN NAME-----".
std::string_view armour_name(std::string_view text) {
    constexpr std::string_view begin = "-----BEGIN ";
    if (!text.starts_with(begin)) return {};
    text.remove_prefix(begin.size());
    const std::size_t end = text.find("-----");
    return end == std::string_view::npos ? std::string_view() : text.substr(0, end);
}

/// Returns whether a text begins with whole lines of at least 60 characters of base64. No model has such lines: spaces separate numbers.
bool is_base64(std::string_view text) {
    std::size_t lines = 0;
    while (text.find('\n') != std::string_view::npos) {
        const std::string_view line = take_line_of(text);
        const bool last = without_white(text).empty();
        const bool legal = std::all_of(line.begin(), line.end(), [](char c) {
            return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '+' || c == '/' ||
                   c == '=';
        });
        if (!legal || (line.size() < 60 && !last)) return false;
        lines += line.size() >= 60;
    }
    return lines > 0;
}

/// Returns the number of the line with the first conflict marker of a version control system, from 1; 0 if there is none.
std::size_t conflict_line(std::string_view text) {
    for (std::size_t line = 1; !text.empty(); ++line) {
        if (take_line_of(text).starts_with("<<<<<<< ")) return line;
    }
    return 0;
}

/// Returns whether files with this ending may be XML of any kind.
bool may_be_xml(std::string_view ending) {
    constexpr std::array xml = {".amf"sv, ".dae"sv, ".irr"sv, ".irrmesh"sv, ".x3d"sv, ".xgl"sv, ".xml"sv};
    return std::find(xml.begin(), xml.end(), ending) != xml.end();
}

std::string foreign_xml(std::string_view text, std::string_view ending) {
    const std::string_view element = first_element(text);
    if (element.empty() || may_be_xml(ending) || text.find('\0') != std::string_view::npos) return {};
    return fmt::format("is XML with the element <{}>, which is no model that octopair knows; export glTF, OBJ or STL",
                       shown(element));
}

}  // namespace

std::string_view first_element(std::string_view text) {
    text = without_white(text);
    while (text.starts_with("<?") || text.starts_with("<!")) {
        const std::string_view ends = text.starts_with("<?") ? "?>" : text.starts_with("<!--") ? "-->" : ">";
        const std::size_t end = text.find(ends);
        if (end == std::string_view::npos) return {};
        text = without_white(text.substr(end + ends.size()));
    }
    if (!text.starts_with('<')) return {};
    const std::string_view name = text.substr(1, text.find_first_of(" \t\r\n/>", 1) - 1);
    const bool is_name =
        !name.empty() && std::all_of(name.begin(), name.end(), [](char c) { return c > ' ' && c != '<'; });
    return is_name && text.size() > name.size() + 1 ? name : std::string_view();
}

std::string foreign_content(const FileHead& head, std::string_view ending) {
    const std::string whole = text_of(head);
    const std::string_view text = without_white(whole);
    for (const ForeignMark& mark : foreign_marks) {
        if (!head.bytes.starts_with(mark.bytes) && !text.starts_with(mark.bytes)) continue;
        return mark.message.find(';') == std::string_view::npos ? fmt::format("{}; {}", mark.message, no_scene)
                                                                : std::string(mark.message);
    }
    if (is_windows_program(head.bytes)) return fmt::format("is a program (Windows), not a model; {}", no_scene);
    if (is_bitmap(head)) return fmt::format("is a picture (BMP), not a model; {}", no_scene);
    if (is_webp(head.bytes)) return fmt::format("is a picture (WebP), not a model; {}", no_scene);
    if (const std::string_view name = armour_name(text); !name.empty())
        return fmt::format("is encoded text ({}), not a model; decode or decrypt it first", shown(name));
    if (text.starts_with("data:") && text.substr(0, 200).find(";base64,") != std::string_view::npos)
        return "is a data URI; decode what follows the comma, for example with `base64 -d`";
    if (is_base64(text)) return "is text in base64; decode it first, for example with `base64 -d`";
    if (const std::size_t line = conflict_line(whole); line > 0)
        return fmt::format("line {}: has the conflict markers of git; resolve the conflict first", line);
    return foreign_xml(text, ending);
}

}  // namespace octopair::io
