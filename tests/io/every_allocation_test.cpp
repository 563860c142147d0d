// Tests that the readers of octopair may run out of memory at each of their allocations. Left out are files that Assimp reads, and JSON: the
// destructor of nlohmann::json allocates, and ends the process if it cannot.
#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "io/boxes/npy.hpp"
#include "io/scene_reader.hpp"
#include "io/temporary.hpp"
#ifdef OCTOPAIR_WITH_MESHES
#include "io/three_mf_reading.hpp"
#endif
#include "scene/recording/recorder.hpp"
#include "scene/recording/replay.hpp"
#include "scene/recording_source.hpp"
#include "support/at_allocation.hpp"

namespace octopair::test {
namespace {

using io::LoadedScene;
using io::NpyType;

constexpr const char* cube_obj =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\ng a part with a long name\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
constexpr const char* cube_off = "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
constexpr const char* triangle_stl =
    "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid "
    "a\n";
constexpr const char* triangle_ply =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
    "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
class EveryAllocation : public ::testing::TestWithParam<std::pair<const char*, std::string>> {
protected:
    TemporaryDirectory directory_;
};

INSTANTIATE_TEST_SUITE_P(
    , EveryAllocation,
    ::testing::Values(std::pair("boxes.csv", "minx,miny,minz,maxx,maxy,maxz\n0,0,0,1,1,1\n1,1,1,2,2,2\n"),
                      std::pair("boxes.npy", npy_of(NpyType::float32, {2, 6}, std::vector<float>(12))),
                      std::pair("mesh.obj", cube_obj), std::pair("mesh.off", cube_off),
                      std::pair("mesh.stl", triangle_stl), std::pair("mesh.ply", triangle_ply)),
    [](const auto& test) { return std::string(test.param.first).substr(std::string(test.param.first).find('.') + 1); });

#ifdef OCTOPAIR_WITH_MESHES
INSTANTIATE_TEST_SUITE_P(
    OfPackages, EveryAllocation,
    ::testing::Values(std::pair(
        "mesh.3mf",
        package_of(model_text("<basematerials id='5'><base name='a material with a long name'/></basematerials>"
                              "<object id='1' name='a part with a long name' pid='5' pindex='0'>" +
                                  tetrahedron() +
                                  "</object><object id='2'><components><component objectid='1'/></components>"
                                  "</object>",
                              "<item objectid='2'/><item objectid='1'/>")))),
    [](const auto&) { return "ThreeMf"; });
#endif

TEST_P(EveryAllocation, OfAReaderMayFail) {
    const auto& [name, content] = GetParam();
    const std::string path = directory_.file(name);
    write_file(path, content);
    const std::uint64_t objects = io::read_scene(path, {}).objects;
    EXPECT_GT(objects, 0u);
    const std::uint64_t failures =
        fail_every_allocation([] { return std::optional<LoadedScene>(); },
                              [&](std::optional<LoadedScene>& scene) { scene.emplace(io::read_scene(path, {})); },
                              [&](std::optional<LoadedScene>& scene, bool failed) {
                                  EXPECT_EQ(scene.has_value(), !failed);
                                  if (scene) {
                                      EXPECT_EQ(scene->objects, objects);
                                  }
                              });
    EXPECT_GT(failures, 3u);
}

TEST(EveryAllocationOfARecording, MayFail) {
    const TemporaryDirectory directory;
    const std::string path = directory.file("r.rec");
    {
        SceneOptions options{.recording = path};
        Scene scene(options);
        const std::vector<Box3f> boxes(40, Box3f{{0, 0, 0}, {1, 1, 1}});
        std::vector<ObjectId> ids(boxes.size());
        scene.add({boxes}, ids);
        scene.step();
        scene.remove(std::span(ids).first(3));
        scene.step();
    }
    const std::string bytes = read_file(path);
    const std::uint64_t failures =
        fail_every_allocation([] { return ReplayReport(); },
                              [&](ReplayReport& report) {
                                  RecordingReader reader(source_of(bytes));
                                  report = replay(reader, {1, true});
                              },
                              [](ReplayReport& report, bool failed) { EXPECT_EQ(report.steps, failed ? 0u : 2u); });
    EXPECT_GT(failures, 10u);
}

}  // namespace
}  // namespace octopair::test
