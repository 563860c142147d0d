// Fuzzes the reader of JSON scenes. The reader returns a scene with consistent arrays, or one line that describes the
// error.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "io/json/json_scene.hpp"
#include "octopair/error.hpp"

namespace {

using namespace octopair;

void require(bool holds) {
    if (!holds) std::abort();
}

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
    try {
        const auto scene = io::parse_json_scene(text, "f.json", [](const std::string&) { return shape::Mesh(); });
        require(scene.shapes.has_value() && scene.names.size() == scene.objects);
        check_shapes(*scene.shapes, scene.objects);
    } catch (const Error& error) {
        require(error.code() == ErrorCode::bad_input);
        const std::string_view words = error.what();
        require(words.starts_with("f.json: "));
        require(std::none_of(words.begin(), words.end(), [](char c) { return c >= 0 && c < ' '; }));
    }
    return 0;
}
