// Fuzzes the .npy reader. An accepted array has exactly the length of its shape, and stays the same when its header is
// written again.
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <vector>

#include "fuzz/require.hpp"
#include "io/boxes/npy.hpp"
#include "octopair/spheres.hpp"

namespace {

using namespace octopair;
using fuzz::require;

void check_round_trip(const io::NpyHeader& header, std::uint64_t data_bytes) {
    const std::string again = io::make_npy_header(header.type, header.shape);
    const auto parsed = io::parse_npy_header(std::as_bytes(std::span(again)), again.size() + data_bytes, "again");
    require(parsed.type == header.type && parsed.shape == header.shape);
}

template <typename Real>
void check_spheres(std::span<const std::byte> data, std::uint64_t objects) {
    std::vector<SphereRow<Real>> spheres(objects);
    if (objects > 0) std::memcpy(spheres.data(), data.data(), data.size());
    std::vector<Box<Real>> boxes(objects);
    boxes_of(spheres, boxes);
    for (std::size_t i = 0; i < objects; ++i) {
        for (int axis = 0; axis < 3; ++axis) {
            require(boxes[i].min[axis] <= spheres[i].centre[axis] && spheres[i].centre[axis] <= boxes[i].max[axis]);
        }
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    const auto file = std::as_bytes(std::span(bytes, size));
    fuzz::require_clear_errors({}, [&] {
        const io::NpyHeader header = io::parse_npy_header(file, size, "f.npy");
        require(header.data_offset <= size);
        const auto data = file.subspan(header.data_offset);
        check_round_trip(header, data.size());
        const io::SceneShape shape = io::scene_shape(header, "f.npy");
        const std::uint64_t columns = shape.spheres ? 4 : 6;
        // Without data, the lengths can have any values.
        require(data.empty() || shape.objects * shape.frames * columns * io::item_bytes(header.type) == data.size());
        if (shape.spheres && header.type == io::NpyType::float32) check_spheres<float>(data, shape.objects);
        if (shape.spheres && header.type == io::NpyType::float64) check_spheres<double>(data, shape.objects);
    });
    return 0;
}
