// Tests the reader of mesh scenes: names, poses, boxes and triangles.
#include "io/meshes/assimp/mesh_reader.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "io/temporary.hpp"

namespace octopair::test {
namespace {

using io::LoadedScene;
using io::MeshObjects;

const std::string tetrahedron_off =
    "OFF\n4 4 0\n0.1 0.2 0.3\n1 0 0\n0 1.7 0\n0 0 1\n3 0 1 2\n3 0 1 3\n3 0 2 3\n3 1 2 3\n";

class Mesh : public ::testing::Test {
protected:
    LoadedScene read(const std::string& name, const std::string& content, MeshObjects objects,
                     bool shapes = false) const {
        write_file(directory_.file(name), content);
        return io::read_mesh_scene(directory_.file(name), {objects, shapes});
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

/// A unit triangle in four nodes: unchanged, moved, mirrored in a child of the moved node, and in a node without
/// a name.
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

TEST_F(Mesh, FacesThatTouchThemselvesAreCutWithinTheirOutline) {
    const std::string vertices = "v 0 0 0\nv 10 5 0\nv 0 10 0\nv 4 5 0\n";
    const LoadedScene nodes = read("a.obj", vertices + "f 1 2 2 3 4\n", MeshObjects::node, true);
    ASSERT_EQ(nodes.warnings.size(), 1u);
    EXPECT_TRUE(has_text(nodes.warnings[0], "Assimp reads OBJ"));
    const auto& mesh = std::get<shape::Mesh>(nodes.shapes->shapes[0]);
    const LoadedScene triangles = read("a.obj", vertices + "f 1 2 2 3 4\n", MeshObjects::triangle, true);
    ASSERT_EQ(triangles.triangles->triangles.size(), mesh.triangles.size());
    double area = 0;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        Triangle3d corners;
        for (std::size_t k = 0; k < 3; ++k) corners[k] = mesh.vertices[mesh.triangles[i][k]];
        EXPECT_EQ(triangles.triangles->triangles[i], corners);
        const auto& [a, b, c] = corners;
        area += std::abs((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2;
    }
    EXPECT_EQ(area, 30);
    EXPECT_EQ(read("a.obj", vertices + "f 1 2 2 3 4\n", MeshObjects::triangle).objects, mesh.triangles.size());

    const LoadedScene crossing = read("b.obj", vertices + "v 10 10 0\nf 1 2 3 4\nf 1 5 2 3\n", MeshObjects::node, true);
    ASSERT_EQ(crossing.warnings.size(), 2u);
    EXPECT_TRUE(has_text(crossing.warnings[1], "b.obj: 1 face crosses itself or folds (the first: face "));
}

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
    EXPECT_EQ(io::read_mesh_scene(directory_.file("i.gltf"), {MeshObjects::triangle}).objects, 4u);
}

TEST_F(Mesh, InstancesShareShapes) {
    write_file(directory_.file("triangle.bin"), bytes_of<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}));
    const LoadedScene scene = read("i.gltf", instances_gltf, MeshObjects::node, true);
    ASSERT_TRUE(scene.shapes);
    EXPECT_EQ(scene.names.size(), 4u);
    EXPECT_EQ(scene.shapes->geometry, (std::vector<std::uint32_t>{0, 0, 0, 0}));
    ASSERT_EQ(scene.shapes->shapes.size(), 1u);
    const auto& mesh = std::get<shape::Mesh>(scene.shapes->shapes[0]);
    EXPECT_EQ(mesh.vertices, (std::vector<Point3d>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
    EXPECT_EQ(mesh.triangles, (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}}));
    // 'still', 'moved' and the node without a name are children of 'world'. 'mirrored' is a child of 'moved'.
    const auto& parents = scene.shapes->parents;
    EXPECT_EQ(parents, (std::vector<std::uint32_t>{0, 0, 1, 0}));
    const Pose mirrored = scene.shapes->poses[2];
    EXPECT_EQ(mirrored.rows[0], (std::array<double, 4>{-2, 0, 0, 10}));
    EXPECT_EQ(mirrored.rows[2], (std::array<double, 4>{0, 0, 1, 30}));
    EXPECT_EQ(std::get<Buffer<Box3d>>(scene.boxes).size(), 4u);
}

TEST_F(Mesh, AShapeHasTheTrianglesOfAllMeshesOfItsNode) {
    const std::string obj =
        "v 9 9 9\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 5 5 5\no quad\nf 2 3 4 5\nl 2 6\no line\nl 2 6\n";
    const LoadedScene scene = read("q.obj", obj, MeshObjects::node, true);
    ASSERT_EQ(scene.objects, 2u);
    ASSERT_EQ(scene.shapes->shapes.size(), 2u);
    const auto& quad = std::get<shape::Mesh>(scene.shapes->shapes[scene.shapes->geometry[0]]);
    EXPECT_EQ(quad.triangles.size(), 2u);
    EXPECT_EQ(quad.vertices.size(), 4u);
    EXPECT_TRUE(std::get<shape::Mesh>(scene.shapes->shapes[scene.shapes->geometry[1]]).triangles.empty());
    // The option `shapes` changes neither objects nor boxes.
    const LoadedScene plain = read("q.obj", obj, MeshObjects::node);
    EXPECT_EQ(plain.names, scene.names);
    EXPECT_FALSE(plain.shapes);
    const auto &boxes = std::get<Buffer<Box3d>>(scene.boxes), &same = std::get<Buffer<Box3d>>(plain.boxes);
    ASSERT_EQ(boxes.size(), same.size());
    EXPECT_EQ(std::memcmp(boxes.data(), same.data(), 2 * sizeof(Box3d)), 0);
}

TEST_F(Mesh, TrianglesStandInTheWorldWithTheirOwners) {
    write_file(directory_.file("triangle.bin"), bytes_of<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}));
    const LoadedScene nodes = read("i.gltf", instances_gltf, MeshObjects::node, true);
    const LoadedScene scene = read("i.gltf", instances_gltf, MeshObjects::triangle, true);
    ASSERT_TRUE(scene.triangles);
    EXPECT_TRUE(scene.lacks_boxes());
    EXPECT_EQ(scene.objects, 4u);
    EXPECT_EQ(scene.triangles->owner_names, nodes.names);
    EXPECT_EQ(scene.triangles->owners, (std::vector<std::uint32_t>{0, 1, 2, 3}));
    for (std::size_t i = 0; i < 4; ++i) {
        const auto& rows = nodes.shapes->poses[i].rows;
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const Point3d v = std::get<shape::Mesh>(nodes.shapes->shapes[0]).vertices[corner];
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const auto& r = rows[axis];
                EXPECT_EQ(scene.triangles->triangles[i][corner][axis],
                          ((r[0] * v[0] + r[1] * v[1]) + r[2] * v[2]) + r[3]);
            }
        }
    }
}

TEST_F(Mesh, RefusesVerticesThatAreNowhere) {
    write_file(directory_.file("triangle.bin"), bytes_of<float>({0, 0, 0, 1, 0, 0, 0, -INFINITY, 0}));
    for (const MeshObjects objects : {MeshObjects::node, MeshObjects::triangle}) {
        const std::string words =
            error_of(ErrorCode::bad_input, [&] { (void)read("i.gltf", instances_gltf, objects); });
        // The message has the number of the file. After the pose, the number would be nan: -infinity times 0.
        EXPECT_TRUE(has_text(words, "vertex 2 has the coordinate -inf, which is not finite"));
        expect_error(ErrorCode::bad_input, "has the coordinate nan, which is not finite", [&] {
            (void)read("q.off", "OFF\n4 1 0\n0 0 0\n1 0 0\n1 nan 0\n0 1 0\n4 0 1 2 3\n", objects, true);
        });
    }
}

TEST_F(Mesh, RefusesFilesThatAssimpRefuses) {
    for (const std::string name : {"a.off", "a.obj", "a.stl", "a.ply", "a.gltf", "a.glb", "a.dae"}) {
        const std::string words = error_of(ErrorCode::bad_input, [&] { (void)read(name, "", MeshObjects::node); });
        EXPECT_TRUE(words.starts_with(directory_.file(name) + ": ")) << words;
        EXPECT_EQ(words.find('\n'), std::string::npos);
    }
    EXPECT_NE(error_of(ErrorCode::io_failed,
                       [&] { (void)io::read_mesh_scene(directory_.file("none.obj"), {MeshObjects::node}); }),
              "");
}

}  // namespace
}  // namespace octopair::test
