#include "io/formats/format_version.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>

#include <fmt/format.h>

#include "io/files/input_file.hpp"
#include "io/formats.hpp"
#include "io/formats/content_marks.hpp"
#include "io/meshes/three_mf/three_mf_scene.hpp"

namespace octopair::io {

namespace {

/// Where a text states its version: after a key, up to one of the ends.
struct Place {
    std::string_view ending, key, ends;
};

constexpr auto places = std::to_array<Place>({
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
    for (const Place& place : places) {
        if (place.ending != ending) continue;
        const std::size_t at = head.find(place.key);
        if (at == std::string::npos) continue;
        const std::string_view rest = std::string_view(head).substr(at + place.key.size(), 40);
        return std::string(rest.substr(0, rest.find_first_of(place.ends)));
    }
    return {};
}

}  // namespace octopair::io
