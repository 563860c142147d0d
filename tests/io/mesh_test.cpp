// Mesh scenes: names, poses, boxes, triangles.
#include "io/mesh.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "io/temporary.hpp"

namespace octopair::test {
namespace {

using io::LoadedScene;
using io::MeshObjects;

const std::string tetrahedron_off =
    "OFF\n4 4 0\n0.1 0.2 0.3\n1 0 0\n0 1.7 0\n0 0 1\n3 0 1 2\n3 0 1 3\n3 0 2 3\n3 1 2 3\n";

class Mesh : public testing::Test {
protected:
    LoadedScene read(const std::string& name, const std::string& content, MeshObjects objects) const {
        write_file(directory_.file(name), content);
        return io::read_mesh_scene(directory_.file(name), objects);
    }

    TemporaryDirectory directory_;
};

TEST_F(Mesh, KnowsEndings) {
    for (const std::string ending : {".gltf", ".glb", ".obj", ".stl", ".ply", ".off"})
        EXPECT_TRUE(io::is_mesh_ending(ending));
    for (const std::string ending : {"", ".", ".npy", ".txt"}) EXPECT_FALSE(io::is_mesh_ending(ending));
}

TEST_F(Mesh, TrianglesKeepTheirCoordinates) {
    const LoadedScene scene = read("t.off", tetrahedron_off, MeshObjects::triangle);
    const auto& boxes = std::get<Buffer<Box3f>>(scene.boxes);
    ASSERT_EQ(boxes.size(), 4u);
    EXPECT_TRUE(scene.names.empty());
    const float expected[4][6] = {
        {0, 0, 0, 1, 1.7f, 0.3f}, {0, 0, 0, 1, 0.2f, 1}, {0, 0, 0, 0.1f, 1.7f, 1}, {0, 0, 0, 1, 1.7f, 1}};
    for (std::size_t i = 0; i < 4; ++i) {
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_EQ(boxes[i].min[axis], expected[i][axis]) << i;
            EXPECT_EQ(boxes[i].max[axis], expected[i][3 + axis]) << i;
        }
    }
}

TEST_F(Mesh, ANodeIsABoxOfFloat64) {
    const LoadedScene scene = read("t.off", tetrahedron_off, MeshObjects::node);
    const auto& boxes = std::get<Buffer<Box3d>>(scene.boxes);
    ASSERT_EQ(boxes.size(), 1u);
    EXPECT_EQ(scene.names.size(), 1u);
    EXPECT_EQ(boxes[0].max[1], double(1.7f));
}

TEST_F(Mesh, FacesWithMoreCornersAreCut) {
    const std::string obj = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 5 5 5\nf 1 2 3 4\nl 1 5\n";
    EXPECT_EQ(read("q.obj", obj, MeshObjects::triangle).objects, 2u);
}

/// A unit triangle that four nodes show: as it is, moved, mirrored in a child of the moved one, and without a name.
const std::string instances_gltf = R"({
  "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
  "nodes": [
    {"name": "world", "children": [1, 2, 4]},
    {"name": "still", "mesh": 0},
    {"name": "moved", "mesh": 0, "translation": [10, 20, 30], "children": [3]},
    {"name": "mirrored", "mesh": 0, "scale": [-2, 1, 1]},
    {"mesh": 0, "translation": [0.1, 0, 0], "scale": [3, 3, 3]}
  ],
  "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
  "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}],
  "bufferViews": [{"buffer": 0, "byteLength": 36}],
  "buffers": [{"byteLength": 36, "uri": "triangle.bin"}]
})";

TEST_F(Mesh, InstancesArePosedAndNamedByPath) {
    write_file(directory_.file("triangle.bin"), bytes_of<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}));
    const LoadedScene scene = read("i.gltf", instances_gltf, MeshObjects::node);
    const auto& boxes = std::get<Buffer<Box3d>>(scene.boxes);
    ASSERT_EQ(boxes.size(), 4u);
    const auto at = [&](const std::string& ending) {
        for (std::size_t i = 0; i < scene.names.size(); ++i) {
            if (scene.names[i].ends_with(ending)) return boxes[i];
        }
        ADD_FAILURE() << "no object " << ending;
        return boxes[0];
    };
    EXPECT_EQ(at("world/still").max[0], 1.0);
    EXPECT_EQ(at("world/moved").min[2], 30.0);
    EXPECT_EQ(at("world/moved").max[0], 11.0);
    EXPECT_EQ(at("world/moved/mirrored").min[0], 8.0);
    EXPECT_EQ(at("world/moved/mirrored").max[0], 10.0);
    const std::string unnamed = scene.names.back();
    EXPECT_LT(at(unnamed).max[0], 3.1000001);
    EXPECT_GE(at(unnamed).max[0], double(0.1f) + 3.0);
    EXPECT_EQ(io::read_mesh_scene(directory_.file("i.gltf"), MeshObjects::triangle).objects, 4u);
}

TEST_F(Mesh, RefusesVerticesThatAreNowhere) {
    write_file(directory_.file("triangle.bin"), bytes_of<float>({0, 0, 0, 1, 0, 0, 0, -INFINITY, 0}));
    for (const MeshObjects objects : {MeshObjects::node, MeshObjects::triangle}) {
        const std::string words =
            error_of(ErrorCode::bad_input, [&] { (void)read("i.gltf", instances_gltf, objects); });
        // The file's own number, not what posing makes of it: -infinity times 0 is not a number.
        EXPECT_NE(words.find("vertex 2 is at -inf, not at a finite place"), std::string::npos) << words;
    }
}

TEST_F(Mesh, RefusesFilesThatAssimpRefuses) {
    for (const std::string name : {"a.off", "a.obj", "a.stl", "a.ply", "a.gltf", "a.glb", "a.dae"}) {
        const std::string words = error_of(ErrorCode::bad_input, [&] { (void)read(name, "", MeshObjects::node); });
        EXPECT_TRUE(words.starts_with(directory_.file(name) + ": ")) << words;
        EXPECT_EQ(words.find('\n'), std::string::npos);
    }
    EXPECT_NE(error_of(ErrorCode::io_failed,
                       [&] { (void)io::read_mesh_scene(directory_.file("none.obj"), MeshObjects::node); }),
              "");
}

}  // namespace
}  // namespace octopair::test
