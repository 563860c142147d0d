// Fuzzes the reader of 3MF. An input that begins like a ZIP archive is a file; any other one is the XML of a model, for which an archive is
// made. A file gives a scene with consistent arrays, or one line that describes the error.
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "fuzz/mesh_scene_check.hpp"
#include "fuzz/require.hpp"
#include "io/meshes/three_mf/three_mf_scene.hpp"
#include "io/zip_writer.hpp"

namespace {

using namespace octopair;
using fuzz::require;

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
    fuzz::require_clear_errors(
        {.begin = "f: ", .codes = {ErrorCode::bad_input, ErrorCode::resource_limit}, .printable = true}, [&] {
            fuzz::check_mesh_scene(
                io::parse_three_mf_scene("f", std::move(copy), {io::MeshObjects::node, true, {}}, {}));
        });
    return 0;
}
