// Fuzzes the reader of JSON scenes. The reader returns a scene with consistent arrays, or one line that describes the
// error.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string_view>

#include "fuzz/require.hpp"
#include "io/json/json_scene.hpp"

namespace {

using namespace octopair;
using fuzz::require;

void check_shapes(const io::LoadedShapes& loaded, std::uint64_t objects) {
    require(loaded.geometry.size() == objects && loaded.poses.size() == objects && loaded.parents.size() == objects);
    for (const std::size_t size :
         {loaded.end_poses.size(), loaded.padding.size(), loaded.groups.size(), loaded.masks.size()}) {
        require(size == 0 || size == objects);
    }
    for (const std::uint32_t shape : loaded.geometry) require(shape < loaded.shapes.size());
    for (const Pose& pose : loaded.poses) {
        for (const auto& row : pose.rows) {
            require(std::all_of(row.begin(), row.end(), [](double number) { return std::isfinite(number); }));
        }
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(bytes), size);
    fuzz::require_clear_errors({.begin = "f.json: ", .printable = true}, [&] {
        const auto scene = io::parse_json_scene(text, "f.json", [](const std::string&) { return shape::Mesh(); });
        require(scene.shapes.has_value() && scene.names.size() == scene.objects);
        check_shapes(*scene.shapes, scene.objects);
    });
    return 0;
}
