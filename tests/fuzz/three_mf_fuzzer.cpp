// Fuzzes the reader of 3MF. An input that begins like a ZIP archive is a file; any other one is the XML of a model, for which an archive is
// made. A file gives a scene with consistent arrays, or one line that describes the error.
#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "fuzz/mesh_scene_check.hpp"
#include "io/meshes/three_mf/three_mf_scene.hpp"
#include "io/zip_writer.hpp"
#include "octopair/error.hpp"

namespace {

using namespace octopair;
using test::require;

constexpr std::string_view relationships =
    "<Relationships><Relationship Type='http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel' "
    "Target='/m.model'/></Relationships>";

std::string archive_of(std::string_view model) {
    test::ZipWriter zip;
    zip.add("_rels/.rels", relationships, {.deflate = false});
    zip.add("m.model", model, {.deflate = false});
    return zip.bytes();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    const std::string_view input(reinterpret_cast<const char*>(bytes), size);
    const std::string file = input.starts_with("PK") ? std::string(input) : archive_of(input);
    Buffer<std::byte> copy{file.size()};
    std::memcpy(copy.data(), file.data(), file.size());
    try {
        test::check_mesh_scene(io::parse_three_mf_scene("f", std::move(copy), {io::MeshObjects::node, true, {}}, {}));
    } catch (const Error& error) {
        require(error.code() == ErrorCode::bad_input || error.code() == ErrorCode::resource_limit);
        const std::string_view words = error.what();
        require(words.starts_with("f: "));
        require(std::none_of(words.begin(), words.end(), [](char c) { return c >= 0 && c < ' '; }));
    }
    return 0;
}
