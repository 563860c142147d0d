#include "io/formats/content_marks.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>

#include <fmt/format.h>

#include "io/files/letter_case.hpp"
#include "io/formats/format_table.hpp"

namespace octopair::io {

namespace {

using namespace std::string_view_literals;

/// Bytes that files of a format have at an offset.
struct Mark {
    std::size_t offset;
    std::string_view bytes;
    std::string_view ending;  ///< ending of the format, or its name
};

constexpr auto binary_marks = std::to_array<Mark>({
    {0, "\x93NUMPY"sv, ".npy"},
    {0, "OPMODEL\n"sv, ".opmodel"},
    {0, "glTF\x01\0\0\0"sv, ".glb"},
    {0, "glTF\x02\0\0\0"sv, ".glb"},
    {8, "LWO2"sv, ".lwo"},
    {8, "LWOB"sv, ".lwo"},
    {8, "LXOB"sv, ".lwo"},
    {0, "BLENDER"sv, ".blend"},
    {0, "BB3D"sv, ".b3d"},
    {0, "IDP2\x08\0\0\0"sv, ".md2"},
    {0, "IDP3\x0f\0\0\0"sv, ".md3"},
    {0, "MS3D000000"sv, ".ms3d"},
    {0, "INTERQUAKEMODEL\0"sv, ".iqm"},
    {0, "Kaydara FBX Binary"sv, ".fbx"},
    {0, "ASSIMP.binary"sv, ".assbin"},
    {0, "Caligari "sv, ".cob"},
    {0, "quick3Do"sv, ".q3o"},
    {0, "quick3Ds"sv, ".q3o"},
    {0, "AutoCAD Binary DXF"sv, "binary DXF"},
    {0, "PXR-USDC"sv, ".usd"},
    {0, "3D Geometry File Format "sv, ".3dm"},
    {0, "\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1"sv, "Microsoft compound document"},
    {0, "\xff\xfe\xff\x0eS\0k\0e\0t\0c\0h\0U\0p"sv, ".skp"},
    {0, "%PDF-"sv, ".pdf"},
    {0, "\x89PNG\r\n\x1a\n"sv, ".png"},
    {0, "\xff\xd8\xff"sv, ".jpg"},
    {0, "LASF"sv, ".las"},
    {0, "ASTM-E57"sv, ".e57"},
});

/// Texts at the beginning of a file.
constexpr auto text_marks = std::to_array<Mark>({
    {0, "ply\n"sv, ".ply"},
    {0, "ply\r"sv, ".ply"},
    {0, "AC3D"sv, ".ac"},
    {0, "xof 0"sv, ".x"},
    {0, "MD5Version"sv, ".md5mesh"},
    {0, "; FBX "sv, ".fbx"},
    {0, "*3DSMAX_ASCIIEXPORT"sv, ".ase"},
    {0, "LWSC"sv, ".lws"},
    {0, "#VRML V"sv, ".wrl"},
    {0, "#usda "sv, ".usd"},
    {0, "# vtk DataFile"sv, ".vtk"},
    {0, "# .PCD v"sv, ".pcd"},
});

/// First elements of XML files.
constexpr auto elements = std::to_array<Mark>({
    {0, "<COLLADA"sv, ".dae"},
    {0, "<X3D"sv, ".x3d"},
    {0, "<amf"sv, ".amf"},
    {0, "<irr_scene"sv, ".irr"},
    {0, "<WORLD"sv, ".xgl"},
    {0, "<VTKFile"sv, ".vtk"},
    {0, "<ifc:"sv, ".ifcxml"},
    {0, "<ifcXML"sv, ".ifcxml"},
});

/// First bytes of compressed files, and the command that prints their content.
struct Packing {
    std::size_t offset;
    std::string_view bytes, name, command;
};
constexpr auto packings = std::to_array<Packing>({
    {0, "\x1f\x8b"sv, "compressed with gzip", "gzip -dc"},
    {0,
     "\xfd"
     "7zXZ\0"sv,
     "compressed with xz", "xz -dc"},
    {0, "BZh"sv, "compressed with bzip2", "bzip2 -dc"},
    {0, "\x28\xb5\x2f\xfd"sv, "compressed with zstd", "zstd -dc"},
    {0, "\x04\x22\x4d\x18"sv, "compressed with lz4", "lz4 -dc"},
    {0, "LZIP\x01"sv, "compressed with lzip", "lzip -dc"},
    {0, "\x89LZO\0"sv, "compressed with lzop", "lzop -dc"},
    {0, "\x1f\x9d"sv, "compressed with compress", "gzip -dc"},
    {0, "MSCF\0\0\0\0"sv, "a cabinet archive", "cabextract"},
    {0, "!<arch>\n"sv, "an ar archive", "ar x"},
    {0, "7z\xbc\xaf\x27\x1c"sv, "a 7z archive", "7z x"},
    {0, "Rar!\x1a\x07"sv, "a RAR archive", "unrar x"},
    {0, "PK\x03\x04"sv, "a ZIP archive", "unzip"},
    {0, "PK\x05\x06"sv, "an empty ZIP archive", "unzip"},
    {257, "ustar"sv, "a tar archive", "tar -xf"},
});

constexpr std::string_view white = " \t\r\n";

bool has_at(std::string_view bytes, std::size_t offset, std::string_view mark) {
    return bytes.size() >= offset + mark.size() && bytes.substr(offset, mark.size()) == mark;
}

std::string_view skip_white(std::string_view text) {
    return text.substr(std::min(text.find_first_not_of(white), text.size()));
}

/// Returns the 32-bit number at an offset. Requires: the bytes are there.
std::uint32_t number_at(std::string_view bytes, std::size_t offset) {
    std::uint32_t number = 0;
    std::memcpy(&number, bytes.data() + offset, sizeof number);
    return number;
}

/// Returns whether the outer object of a JSON text has a key, such as "asset". The end of the text may be missing.
bool has_key(std::string_view text, std::string_view key) {
    int depth = 0;
    for (std::size_t at = 0; at < text.size(); ++at) {
        if (text[at] == '{' || text[at] == '[') ++depth;
        if (text[at] == '}' || text[at] == ']') --depth;
        if (text[at] != '"') continue;
        const std::size_t begin = at + 1;
        for (++at; at < text.size() && text[at] != '"'; ++at) at += text[at] == '\\' ? 1 : 0;
        const std::string_view name = text.substr(std::min(begin, text.size()), at - begin);
        if (depth == 1 && name == key && skip_white(text.substr(std::min(at + 1, text.size()))).starts_with(':'))
            return true;
    }
    return false;
}

/// Returns whether a JSON text is glTF: it has keys that no JSON scene has. JSON scenes have no mark, because glTF may have their keys.
bool is_gltf(std::string_view text) {
    return text.starts_with('{') &&
           (has_key(text, "asset") || has_key(text, "bufferViews") || has_key(text, "accessors"));
}

std::string_view step_format(std::string_view text) {
    if (!text.starts_with("ISO-10303-21")) return {};
    const std::size_t schema = text.find("FILE_SCHEMA");
    if (schema == std::string_view::npos) return {};
    return skip_white(text.substr(schema + 11)).substr(0, 40).find("IFC") == std::string_view::npos ? ".step" : ".ifc";
}

/// Returns whether a text is DXF: pairs of lines, a code and a value, that begin with a section, maybe after comments (code 999).
bool is_dxf(std::string_view text) {
    for (int pair = 0; pair < 20; ++pair) {
        std::array<std::string_view, 2> lines;
        for (std::string_view& line : lines) {
            const std::size_t end = text.find('\n');
            if (end == std::string_view::npos) return false;
            line = skip_white(text.substr(0, end));
            line = line.substr(0, line.find_last_not_of(white) + 1);
            text.remove_prefix(end + 1);
        }
        if (lines[0] == "0") return lines[1] == "SECTION";
        if (lines[0] != "999") return false;
    }
    return false;
}

bool is_iges(std::string_view text) {
    return text.size() > 80 && text[72] == 'S' && text.substr(73, 7).find_first_not_of(" 01") == std::string_view::npos;
}

/// Returns whether a text begins with the keyword "OFF", or with ST, C or N before it, and continues with a number or a comment.
bool is_off(std::string_view text) {
    for (const std::string_view name : {"STOFF"sv, "COFF"sv, "NOFF"sv, "CNOFF"sv, "OFF"sv}) {
        if (!text.starts_with(name) || text.size() <= name.size()) continue;
        const std::string_view next = skip_white(text.substr(name.size()));
        return !next.empty() && (next.front() == '#' || (next.front() >= '0' && next.front() <= '9'));
    }
    return false;
}

bool is_stl(const FileHead& head, std::string_view text) {
    if (text.starts_with("solid") && text.find("facet normal") != std::string_view::npos) return true;
    if (head.bytes.size() < 84) return false;
    const std::uint64_t triangles = number_at(head.bytes, 80);
    return triangles > 0 && head.size == 84 + 50 * triangles;
}

/// Returns the next word of a line, and removes it.
std::string_view take_word(std::string_view& line) {
    line = skip_white(line);
    const std::string_view word = line.substr(0, line.find_first_of(white));
    line.remove_prefix(word.size());
    return word;
}

bool is_number(std::string_view word) {
    double value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    return error == std::errc() && end == word.data() + word.size();
}

/// Returns whether a text is OBJ: all whole lines of the head are lines of OBJ, and at least one of them is a vertex.
bool is_obj(std::string_view text) {
    constexpr std::string_view keywords = " v vt vn vp f l p o g s mg usemtl mtllib usemap shadow_obj trace_obj ";
    bool vertex = false;
    while (!text.empty()) {
        const std::size_t end = text.find('\n');
        if (end == std::string_view::npos) break;
        std::string_view line = text.substr(0, end);
        text.remove_prefix(end + 1);
        const std::string_view word = take_word(line);
        if (word.empty() || word.starts_with('#')) continue;
        if (keywords.find(fmt::format(" {} ", word)) == std::string_view::npos) return false;
        if (word != "v") continue;
        for (int i = 0; i < 3; ++i) {
            if (!is_number(take_word(line))) return false;
        }
        vertex = true;
    }
    return vertex;
}

/// Returns the format that the names of files in a ZIP archive show. The names are in the head and in the directory of the archive.
std::string_view zip_format(const FileHead& head) {
    const std::string_view bytes = head.bytes;
    if (!bytes.starts_with(FileHead::zip_mark) || bytes.size() < 30) return {};
    const std::size_t length = number_at(bytes, 26) & 0xFFFF;
    if (bytes.substr(30, length).ends_with(".npy")) return ".npz";
    const auto has_name = [&](std::string_view name) {
        return bytes.find(name) != std::string_view::npos || head.tail.find(name) != std::string::npos;
    };
    return has_name("3D/3dmodel.model") || (has_name("_rels/.rels") && has_name(".model")) ? ".3mf" : "";
}

std::string_view text_format(const FileHead& head) {
    const std::string whole = text_of(head);
    const std::string_view text = skip_white(whole);
    for (const Mark& mark : text_marks) {
        if (text.starts_with(mark.bytes)) return mark.ending;
    }
    if (text.starts_with('<')) {
        for (const Mark& mark : elements) {
            if (text.find(mark.bytes) != std::string_view::npos) return mark.ending;
        }
        return {};
    }
    if (is_gltf(text)) return ".gltf";
    if (const std::string_view step = step_format(text); !step.empty()) return step;
    if (is_dxf(text)) return ".dxf";
    if (is_iges(whole)) return ".igs";
    if (is_off(text)) return ".off";
    if (is_stl(head, text)) return ".stl";
    return is_obj(text) ? ".obj" : "";
}

/// Returns whether files with this ending may be packed in this way.
bool is_legal_packing(const Packing& packing, std::string_view ending) {
    constexpr std::array zipped = {".3mf"sv, ".zae"sv, ".pk3"sv};
    if (packing.bytes.starts_with("PK")) return std::find(zipped.begin(), zipped.end(), ending) != zipped.end();
    return ending == ".blend" && (packing.bytes[0] == '\x1f' || packing.bytes[0] == '\x28');
}

/// Returns whether a text is HTML, or XHTML after an XML declaration and comments.
bool is_html(std::string_view text) {
    const std::string begin = in_lower_case(text);
    return begin.starts_with("<!doctype html") || first_element(begin) == "html" || first_element(begin) == "head";
}

/// Returns whether all bytes are those of ASCII text in UTF-16, without a byte order mark. `high`: place of the high byte in a character.
bool is_wide_ascii(std::string_view bytes, std::size_t high) {
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        const auto byte = static_cast<unsigned char>(bytes[i]);
        const bool text = byte == '\t' || byte == '\n' || byte == '\r' || (byte >= ' ' && byte < 127);
        if (i % 2 == high ? byte != 0 : !text) return false;
    }
    return bytes.size() >= 16;
}

/// Returns whether bytes begin as an LZMA file: usual properties, a dictionary of a power of 2, and a size that is unknown or below 2^48.
bool is_lzma(std::string_view bytes) {
    if (bytes.size() < 14 || !bytes.starts_with("\x5d\0\0"sv)) return false;
    const std::string_view size = bytes.substr(5, 8);
    return size == "\xff\xff\xff\xff\xff\xff\xff\xff"sv || (size.ends_with("\0\0"sv) && size != "\0\0\0\0\0\0\0\0"sv);
}

/// Returns whether octopair reads files with this ending itself, or no reader is known. The other files go to Assimp, which reads UTF-16.
bool is_for_octopair(std::string_view ending) {
    const FileFormat* const format = format_with_ending(ending);
    return format == nullptr ? ending != ".xml" : format->reader == FormatReader::octopair;
}

}  // namespace

std::string_view wide_encoding(std::string_view bytes) {
    if (has_at(bytes, 0, "\xff\xfe\0\0"sv) || has_at(bytes, 0, "\0\0\xfe\xff"sv)) return "UTF-32";
    if (has_at(bytes, 0, "\xff\xfe"sv) || has_at(bytes, 0, "\xfe\xff"sv)) return "UTF-16";
    const std::string_view begin = bytes.substr(0, 64);
    return is_wide_ascii(begin, 0) || is_wide_ascii(begin, 1) ? "UTF-16" : "";
}

std::string text_of(const FileHead& head) {
    std::string_view bytes = head.bytes;
    if (bytes.starts_with("\xef\xbb\xbf")) bytes.remove_prefix(3);
    std::string text(bytes);
    if (!wide_encoding(bytes).empty())
        std::erase_if(text, [](char c) { return c == 0 || (static_cast<unsigned char>(c) & 0x80) != 0; });
    return text;
}

std::string_view marked_format(const FileHead& head) {
    for (const Mark& mark : binary_marks) {
        if (has_at(head.bytes, mark.offset, mark.bytes)) return mark.ending;
    }
    // 3DS: a chunk that is as long as the file.
    if (head.bytes.size() >= 6 && head.bytes.starts_with("MM") && number_at(head.bytes, 2) == head.size) return ".3ds";
    if (const std::string_view zip = zip_format(head); !zip.empty()) return zip;
    return text_format(head);
}

std::string wrapping_of(const FileHead& head, std::string_view ending) {
    if (head.bytes.starts_with("version https://git-lfs.github.com/spec/"))
        return "is a Git LFS pointer, not the file itself; run `git lfs pull`";
    const std::string text = text_of(head);
    if (is_lzma(head.bytes) && marked_format(head).empty())
        return "is compressed with LZMA; unpack it first, for example with `xz --format=lzma -dc`";
    if (is_html(skip_white(text))) return "is an HTML page, not a model; download the file itself";
    for (const Packing& packing : packings) {
        if (!has_at(head.bytes, packing.offset, packing.bytes) || is_legal_packing(packing, ending)) continue;
        if (!marked_format(head).empty()) return {};  // a format inside ZIP
        return fmt::format("is {}; unpack it first, for example with `{}`", packing.name, packing.command);
    }
    const std::string_view encoding = wide_encoding(head.bytes), mark = marked_format(head);
    if (mark.empty()) {
        if (std::string foreign = foreign_content(head, ending); !foreign.empty()) return foreign;
    }
    if (encoding.empty() || !is_for_octopair(mark.empty() ? ending : mark)) return {};
    return fmt::format("is text in {}; save it as UTF-8", encoding);
}

}  // namespace octopair::io
