// Compares octopair's own readers with Assimp, on the models of Debian's package assimp-testmodels: the same vertices and triangles.
// docs/formats.md explains the differences.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include "io/meshes/assimp/mesh_file.hpp"
#include "io/meshes/assimp/scene_parts.hpp"
#include "io/scene_reader.hpp"
#include "io/temporary.hpp"

namespace octopair::test {
namespace {

namespace fs = std::filesystem;

using SurfaceCorner = std::array<std::size_t, 3>;
using SurfaceTriangle = std::array<SurfaceCorner, 3>;

/// Numbers of a coordinate axis. Numbers that differ by less than a tolerance are one, because Assimp rounds to float32, and not always to
/// the nearest number.
class AxisNumbers {
public:
    void add(double number) { numbers_.push_back(number); }
    void join(double tolerance) {
        std::sort(numbers_.begin(), numbers_.end());
        std::vector<double> first;
        double last = -std::numeric_limits<double>::infinity();
        for (const double number : numbers_) {
            if (number - last > tolerance) first.push_back(number);
            last = number;
        }
        numbers_ = std::move(first);
    }
    std::size_t index(double number) const {
        return std::size_t(std::upper_bound(numbers_.begin(), numbers_.end(), number) - numbers_.begin());
    }

private:
    std::vector<double> numbers_;
};

/// The surface of a file, with its coordinates as indices of AxisNumbers.
struct Surface {
    std::set<SurfaceCorner> vertices;
    std::vector<SurfaceTriangle> triangles;  ///< sorted; each begins with its smallest corner and keeps its direction
};

Surface surface_of(const io::LoadedTriangles& loaded, const std::array<AxisNumbers, 3>& axes) {
    Surface surface;
    for (const Triangle3d& triangle : loaded.triangles) {
        SurfaceTriangle corners;
        for (std::size_t k = 0; k < 3; ++k) {
            for (std::size_t axis = 0; axis < 3; ++axis) corners[k][axis] = axes[axis].index(triangle[k][axis]);
            surface.vertices.insert(corners[k]);
        }
        std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
        surface.triangles.push_back(corners);
    }
    std::sort(surface.triangles.begin(), surface.triangles.end());
    return surface;
}

/// Returns how two surfaces differ, in a word; empty if they are equal.
std::string surface_difference(const io::LoadedTriangles& own, const io::LoadedTriangles& assimp) {
    std::array<AxisNumbers, 3> axes;
    double largest = 0;
    for (const io::LoadedTriangles* loaded : {&own, &assimp}) {
        for (const Triangle3d& triangle : loaded->triangles) {
            for (const Point3d& place : triangle) {
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    axes[axis].add(place[axis]);
                    largest = std::max(largest, std::abs(place[axis]));
                }
            }
        }
    }
    for (AxisNumbers& axis : axes) axis.join(std::ldexp(largest, -21));
    const Surface a = surface_of(own, axes), b = surface_of(assimp, axes);
    if (a.triangles == b.triangles) return {};
    if (a.triangles.size() != b.triangles.size())
        return std::to_string(a.triangles.size()) + " triangles, not " + std::to_string(b.triangles.size());
    return a.vertices == b.vertices ? "other diagonals" : "other vertices";
}

template <typename Read>
std::optional<io::LoadedTriangles> read_or_refuse(const Read& read) {
    try {
        return read();
    } catch (const Error&) {
        return std::nullopt;
    }
}

/// The files that the two readers read differently.
const std::map<std::string, std::string> known_differences = {
    {"OBJ/box_UTF16BE.obj", "only Assimp"},
    {"OBJ/number_formats.obj", "only Assimp"},
    {"OFF/invalid.off", "only Assimp"},
    {"PLY/pond.0.ply", "only Assimp"},
    {"glTF2/IndexOutOfRange/IndexOutOfRange.gltf", "only Assimp"},
    {"glTF2/TestNoRootNode/NoScene.gltf", "only octopair"},
    {"glTF2/cameras/Cameras.gltf", "other vertices"},
    {"glTF2/issue_3269/texcoord_crash.gltf", "only octopair"},
    {"glTF2/wrongTypes/badExtension.gltf", "only octopair"},
    {"glTF2/wrongTypes/badNumber.gltf", "only octopair"},
    {"glTF2/wrongTypes/badObject.gltf", "only octopair"},
    {"glTF2/wrongTypes/badString.gltf", "only octopair"},
    {"glTF2/wrongTypes/badUint.gltf", "only octopair"},
};

TEST(SecondReader, ReadsTheSameSurfaces) {
    const fs::path models = OCTOPAIR_DATA "/assimp_models";
    if (!fs::exists(models)) GTEST_SKIP() << "no data; scripts/data unpacks it";
    const std::set<std::string> endings = {".obj", ".stl", ".ply", ".off", ".gltf", ".glb", ".3mf"};
    std::map<std::string, std::string> differences;
    std::size_t files = 0;
    for (const auto& entry : fs::recursive_directory_iterator(models)) {
        const std::string path = entry.path().string(), name = fs::relative(entry.path(), models).string();
        const std::string ending = io::ending_of(path);
        if (!entry.is_regular_file() || name.starts_with("invalid/")) continue;
        if (!endings.contains(ending)) continue;
        ++files;
        const auto own = read_or_refuse([&] {
            return *io::read_scene(path, {io::MeshObjects::triangle, true}).triangles;
        });
        const auto assimp = read_or_refuse([&] { return io::triangles_of(io::MeshFile(path, true)); });
        std::string differs = own ? "only octopair" : "only Assimp";
        if (own.has_value() == assimp.has_value()) differs = own ? surface_difference(*own, *assimp) : "";
        if (!differs.empty()) differences.emplace(name, differs);
    }
    EXPECT_GE(files, 40u);
    EXPECT_EQ(differences, known_differences);
}

}  // namespace
}  // namespace octopair::test
