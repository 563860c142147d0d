#include "io/formats/format_choice.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <span>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "io/files/input_file.hpp"
#include "io/files/letter_case.hpp"
#include "io/formats/content_marks.hpp"
#include "io/formats/format_table.hpp"
#include "io/meshes/assimp/mesh_reader.hpp"
#include "io/meshes/gltf/gltf_scene.hpp"
#include "io/meshes/stream/reader_program.hpp"
#include "io/meshes/three_mf/three_mf_scene.hpp"
#include "octopair/error.hpp"

namespace octopair::io {

std::string ending_of(const std::string& path) {
    return in_lower_case(std::filesystem::path(path).extension().string());
}

namespace {

/// Returns whether a path says nothing about the format: standard input or output ("-"), a stream, or a descriptor under /dev or
/// /proc.
bool lacks_name(const std::string& path) {
    if (path == "/dev/stdin" || path.starts_with("/dev/fd/") || path.starts_with("/proc/self/fd/")) return true;
    return is_stream(path) && format_with_ending(ending_of(path)) == nullptr;
}

FileHead read_head(const std::string& path) {
    const InputFile file(path);
    FileHead head{std::string(std::size_t(std::min<std::uint64_t>(file.size(), FileHead::head_bytes)), '\0'),
                  file.size()};
    file.read(0, std::as_writable_bytes(std::span(head.bytes)));
    if (head.bytes.starts_with(FileHead::zip_mark)) {
        head.tail.resize(std::size_t(std::min<std::uint64_t>(file.size(), FileHead::tail_bytes)));
        file.read(file.size() - head.tail.size(), std::as_writable_bytes(std::span(head.tail)));
    }
    return head;
}

/// Returns the beginning of a file. Returns nothing if it cannot be read, and for streams with an ending, which only their reader may read.
/// Throws: Error{io_failed} for a stream without an ending.
std::optional<FileHead> head_of(const std::string& path) {
    if (lacks_name(path)) return read_head(path);
    if (is_stream(path)) return std::nullopt;
    try {
        return read_head(path);
    } catch (const Error&) {
        return std::nullopt;  // when the reader opens the file, it gives the reason
    }
}

const FileFormat* format_of_mark(std::string_view mark) {
    if (mark.empty()) return nullptr;
    if (const FileFormat* const format = format_with_ending(mark)) return format;
    const auto formats = file_formats();
    const auto found =
        std::find_if(formats.begin(), formats.end(), [&](const FileFormat& format) { return format.name == mark; });
    return found == formats.end() ? nullptr : &*found;
}

/// Returns whether the first line of a text has six numbers, or six words as a header.
bool looks_like_csv(const FileHead& head) {
    const std::string text = text_of(head);
    const std::string line = text.substr(0, text.find('\n'));
    return std::count(line.begin(), line.end(), ',') == 5 && std::all_of(line.begin(), line.end(), [](char c) {
               return c == '\t' || c == '\r' || (c >= ' ' && c < 127);
           });
}

bool can_assimp_read([[maybe_unused]] const std::string& ending) {
#ifdef OCTOPAIR_WITH_MESHES
    return is_mesh_ending(ending);
#else
    return false;
#endif
}

/// Returns the ending of a format without a mark, for a file whose name says nothing; empty if the content does not show one.
std::string guessed_ending(const FileHead& head, bool stream) {
    const std::string text = text_of(head);
    const std::size_t first = text.find_first_not_of(" \t\r\n");
    const bool json = first != std::string::npos && (text[first] == '{' || text[first] == '[');
    if (json && (stream || text.find("\"objects\"") != std::string::npos)) return ".json";
    return stream || looks_like_csv(head) ? ".csv" : "";
}

KnownFormat known_by_head(const std::string& path, const std::optional<FileHead>& head) {
    const bool unnamed = lacks_name(path);
    const std::string ending = unnamed ? "" : ending_of(path);
    const FileFormat* const named = format_with_ending(ending);
    const FileFormat* const marked = head ? format_of_mark(marked_format(*head)) : nullptr;
    const bool agree =
        marked == nullptr || marked == named ||
        (named != nullptr && named->reader == FormatReader::nobody && marked->reader == FormatReader::nobody);
    if (!agree) return {marked, std::string(marked->first_ending()), true, true, named != nullptr};
    if (named != nullptr || !head || can_assimp_read(ending)) return {named, ending, marked != nullptr, false, false};
    const std::string guess = guessed_ending(*head, unnamed);
    if (guess.empty()) return {nullptr, ending, false, false, false};
    return {format_with_ending(guess), guess, false, true, false};
}

/// Throws: Error{bad_input} if the file is wrapped.
void refuse_wrapped(const std::string& path, const FileHead& head) {
    const std::string wrapping = wrapping_of(head, ending_of(path));
    if (!wrapping.empty()) refuse(path, wrapping);
}

/// Refuses text that lacks the mark of its format. From such text, Assimp makes wrong objects, or no objects without an error.
void refuse_without_mark(const std::string& path, std::string_view ending, const FileHead& head) {
    constexpr std::array<std::pair<std::string_view, std::string_view>, 6> marks = {{{".ase", "*3DSMAX_ASCIIEXPORT"},
                                                                                     {".ask", "*3DSMAX_ASCIIEXPORT"},
                                                                                     {".dae", "<"},
                                                                                     {".irr", "<"},
                                                                                     {".irrmesh", "<"},
                                                                                     {".x3d", "<"}}};
    const auto found = std::find_if(marks.begin(), marks.end(), [&](const auto& mark) { return mark.first == ending; });
    if (found == marks.end() || text_of(head).find(found->second) != std::string::npos) return;
    refuse(path, fmt::format("has no {} at its beginning, which files of its format ({}) have", found->second, ending));
}

/// Place where a text states its version: after `key`, up to the first of the ends.
struct VersionPlace {
    std::string_view ending, key, ends;
};

constexpr auto version_places = std::to_array<VersionPlace>({
    {".ifc", "FILE_SCHEMA(('", "'"},
    {".gltf", "\"version\":\"", "\""},
    {".gltf", "\"version\": \"", "\""},
    {".gltf", "\"version\" : \"", "\""},
    {".dae", "<COLLADA version=\"", "\""},
    {".dae", "COLLADASchema\" version=\"", "\""},
    {".x3d", "<X3D version=\"", "\""},
    {".amf", "<amf version=\"", "\""},
    {".dxf", "$ACADVER\n1\n", "\n"},
    {".dxf", "$ACADVER\n  1\n", "\n"},
    {".fbx", "FBXVersion: ", "\n"},
    {".ply", "format ", "\n"},
    {".x", "xof ", " \n"},
    {".md5mesh", "MD5Version ", "\n"},
    {".ac", "AC3D", "\n"},
});

std::uint32_t number_in(std::string_view bytes, std::size_t offset) {
    std::uint32_t number = 0;
    if (bytes.size() >= offset + sizeof number) std::memcpy(&number, bytes.data() + offset, sizeof number);
    return number;
}

std::string binary_version(std::string_view bytes, std::string_view ending) {
    if (ending == ".npy" && bytes.size() > 8) return fmt::format("{}.{}", int(bytes[6]), int(bytes[7]));
    if (ending == ".glb") return fmt::format("{}", number_in(bytes, 4));
    if (ending == ".fbx" && bytes.starts_with("Kaydara")) return fmt::format("{}", number_in(bytes, 23));
    if ((ending == ".lwo" || ending == ".lxo") && bytes.size() > 12) return std::string(bytes.substr(8, 4));
    if (ending == ".stl") return bytes.find("facet") == std::string_view::npos ? "binary" : "text";
    return {};
}

}  // namespace

namespace {

bool has_reader_program([[maybe_unused]] std::string_view ending) {
#ifdef OCTOPAIR_WITH_MESHES
    const std::string_view name = reader_program_of(ending);
    return !name.empty() && find_reader_program(name).has_value();
#else
    return false;
#endif
}

}  // namespace

KnownFormat known_format(const std::string& path) { return known_by_head(path, head_of(path)); }

void check_readable(const std::string& path) {
    std::error_code ignored;
    if (std::filesystem::is_directory(path, ignored)) refuse(path, "is a directory; give the name of a file in it");
    const std::optional<FileHead> head = head_of(path);
    if (!head) return;
    const KnownFormat known = known_by_head(path, head);
    if (head->size == 0 && known.ending != ".csv") refuse(path, "is empty");
    if (ending_of(path) == ".ifczip") {  // its reader expects an archive
        if (has_reader_program(".ifczip")) return;
        refuse(path, "is an archive, which octopair-ifc reads; install it, or unpack the archive");
    }
    refuse_wrapped(path, *head);
    refuse_without_mark(path, known.ending, *head);
    if (known.format == nullptr) return;
    const bool by_program = known.format->reader == FormatReader::program;
    if (has_reader_program(known.ending)) return;
    if (!by_program && known.format->reader != FormatReader::nobody) return;
    if (!known.marked && can_assimp_read(known.ending)) return;
    refuse(path,
           fmt::format("is {}, which {}; {}", known.format->name,
                       by_program ? "another program must read" : "octopair does not read", known.format->remedy));
}

void check_not_wrapped(const std::string& path) {
    if (const std::optional<FileHead> head = head_of(path)) refuse_wrapped(path, *head);
}

std::string name_warning(const std::string& path) {
    const KnownFormat known = known_format(path);
    if (!known.misnamed) return {};
    const FileFormat* const named = format_with_ending(ending_of(path));
    return fmt::format("{}: is {}, not {} as its name says; it is read as {}", path, known.format->name, named->name,
                       known.format->name);
}

SceneFormat scene_format(const std::string& path) {
    const KnownFormat known = known_format(path);
    if (known.ending == ".npy") return SceneFormat::npy;
    if (known.ending == ".csv") return SceneFormat::csv;
    if (known.ending == ".json") return SceneFormat::json;
#ifdef OCTOPAIR_WITH_MESHES
    if (known.ending == ".opmodel" || (known.format != nullptr && known.format->reader == FormatReader::program))
        return SceneFormat::mesh;
    const bool refused = known.format != nullptr && known.format->reader == FormatReader::nobody;
    if (known.format != nullptr && !refused) return SceneFormat::mesh;
    if (!(refused && known.marked) && can_assimp_read(known.ending)) return SceneFormat::mesh;
#endif
    return SceneFormat::unknown;
}

bool is_imported_file(const std::string& path) {
    if (!is_mesh_file(path)) return false;
    const KnownFormat known = known_format(path);
#ifdef OCTOPAIR_WITH_MESHES
    if (is_gltf_ending(known.ending)) return may_be_gltf_for_assimp(path);
#endif
    if (has_reader_program(known.ending)) return false;
    return known.format == nullptr || known.format->reader != FormatReader::octopair;
}

bool is_ifc_file(const std::string& path) {
    const std::string ending = format_ending(path);
    return ending == ".ifc" || ending == ".ifczip";
}

SceneSpace format_space(const std::string& path) {
    const std::string ending = format_ending(path);
    const auto is_any_of = [&](std::initializer_list<std::string_view> endings) {
        return std::find(endings.begin(), endings.end(), ending) != endings.end();
    };
    if (is_any_of({".ifc", ".ifczip"})) return {UpAxis::z, "m"};  // Assimp scales to metres
    // Assimp turns and scales COLLADA to the axes and the unit that glTF and X3D prescribe.
    if (is_any_of({".gltf", ".glb", ".dae", ".zae", ".x3d", ".x3db", ".wrl"})) return {UpAxis::y, "m"};
    return {};
}

bool may_name_files(const std::string& path) {
    const std::string ending = format_ending(path);
    return ending == ".gltf" || ending == ".json";
}

std::string version_of(const std::string& path) {
    const InputFile file(path);
    std::string head(std::size_t(std::min<std::uint64_t>(file.size(), FileHead::head_bytes)), '\0');
    file.read(0, std::as_writable_bytes(std::span(head)));
    const std::string ending = format_ending(path);
#ifdef OCTOPAIR_WITH_MESHES
    if (is_three_mf_ending(ending)) return three_mf_version(path);
#endif
    if (std::string version = binary_version(head, ending); !version.empty()) return version;
    std::erase(head, '\r');
    for (const VersionPlace& place : version_places) {
        if (place.ending != ending) continue;
        const std::size_t at = head.find(place.key);
        if (at == std::string::npos) continue;
        const std::string_view rest = std::string_view(head).substr(at + place.key.size(), 40);
        return std::string(rest.substr(0, rest.find_first_of(place.ends)));
    }
    return {};
}

ResultFormat result_format(const std::string& path) {
    const std::string ending = ending_of(path);
    if (ending == ".npy") return ResultFormat::npy;
    if (ending == ".csv") return ResultFormat::csv;
    if (ending == ".jsonl") return ResultFormat::jsonl;
    if (ending == ".bcf" || ending == ".bcfzip") return ResultFormat::bcf;
    if (path == "-" || path.starts_with("/dev/")) return ResultFormat::csv;
    throw Error(
        ErrorCode::usage,
        fmt::format("{}: unknown file type; the name of a result must end in .npy, .csv, .jsonl or .bcf", path));
}

ResultFormat pairs_format(const std::string& path) {
    const ResultFormat format = result_format(path);
    if (format != ResultFormat::bcf) return format;
    throw Error(ErrorCode::usage,
                fmt::format("{}: BCF holds collisions, not pairs of boxes; write pairs to .npy, .csv or .jsonl", path));
}

bool is_array_file(const std::string& path) { return !path.empty() && result_format(path) == ResultFormat::npy; }

}  // namespace octopair::io
