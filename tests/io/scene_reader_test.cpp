// Tests scene files of every kind, several files as one set, and the search for invalid boxes.
#include "io/scene_reader.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "io/temporary.hpp"

namespace octopair::test {
namespace {

using io::LoadedScene;
using io::MeshObjects;

template <typename Real>
LoadedScene scene_of(const std::vector<Box<Real>>& boxes, std::uint64_t frames = 1, bool moving = false) {
    LoadedScene scene;
    Buffer<Box<Real>> buffer{boxes.size()};
    std::copy(boxes.begin(), boxes.end(), buffer.data());
    scene.boxes = std::move(buffer);
    scene.objects = boxes.size() / frames;
    scene.frames = frames;
    scene.moving = moving;
    return scene;
}

Box3f box_at(float x) { return {{x, 0, 0}, {x + 1, 1, 1}}; }
Box3d wide_box_at(double x) { return {{x, 0, 0}, {x + 1, 1, 1}}; }

Pose make_move(double x) {
    Pose pose;
    pose.rows[0][3] = x;
    return pose;
}

TEST(SceneReader, KnowsFilesByTheirEnding) {
    const TemporaryDirectory directory;
    write_file(directory.file("a.CSV"), "0,0,0,1,1,1\n");
    EXPECT_EQ(io::read_scene(directory.file("a.CSV"), {MeshObjects::node}).objects, 1u);
    for (const std::string name : {"a", "a.txt", "a.npz", "a."}) {
        write_file(directory.file(name), "");
        EXPECT_NE(
            error_of(ErrorCode::bad_input, [&] { (void)io::read_scene(directory.file(name), {MeshObjects::node}); }),
            "");
        EXPECT_FALSE(io::is_mesh_file(name));
    }
}

TEST(SceneReader, JoinsInOrder) {
    std::vector<LoadedScene> scenes;
    scenes.push_back(scene_of<float>({box_at(0), box_at(1)}));
    scenes.push_back(scene_of<float>({}));
    scenes.push_back(scene_of<float>({box_at(2)}));
    scenes[2].names = {"last"};
    const LoadedScene joined = io::join_scenes(scenes, std::vector<std::string>{"a", "b", "c"});
    EXPECT_EQ(joined.objects, 3u);
    for (int i = 0; i < 3; ++i) EXPECT_EQ(std::get<Buffer<Box3f>>(joined.boxes)[i].min[0], float(i));
    EXPECT_EQ(joined.names, (std::vector<std::string>{"", "", "last"}));
}

TEST(SceneReader, JoinsPrecisionsAsFloat64) {
    std::vector<LoadedScene> scenes;
    scenes.push_back(scene_of<float>({box_at(0.1f)}));
    scenes.push_back(scene_of<double>({wide_box_at(0.1)}));
    const LoadedScene joined = io::join_scenes(scenes, std::vector<std::string>{"a", "b"});
    const auto& boxes = std::get<Buffer<Box3d>>(joined.boxes);
    EXPECT_EQ(boxes[0].min[0], double(0.1f));
    EXPECT_EQ(boxes[1].min[0], 0.1);
}

TEST(SceneReader, JoinsFrameByFrame) {
    std::vector<LoadedScene> scenes;
    scenes.push_back(scene_of<float>({box_at(0), box_at(1), box_at(10), box_at(11)}, 2, true));
    scenes.push_back(scene_of<float>({box_at(2), box_at(12)}, 2, true));
    const LoadedScene joined = io::join_scenes(scenes, std::vector<std::string>{"a", "b"});
    ASSERT_EQ(joined.frames, 2u);
    ASSERT_EQ(joined.objects, 3u);
    const auto second = std::get<std::span<const Box3f>>(joined.frame(1).boxes);
    for (int i = 0; i < 3; ++i) EXPECT_EQ(second[i].min[0], float(10 + i));
}

/// Returns a scene with two objects of the same shape.
LoadedScene shaped_scene(double radius) {
    LoadedScene scene = scene_of<double>({wide_box_at(0), wide_box_at(1)});
    scene.shapes.emplace();
    scene.shapes->shapes = {shape::Sphere{radius}};
    scene.shapes->geometry = {0, 0};
    scene.shapes->poses = {make_move(radius), make_move(2 * radius)};
    scene.shapes->parents = {0, 1};
    return scene;
}

TEST(SceneReader, JoinsShapes) {
    std::vector<LoadedScene> scenes;
    scenes.push_back(shaped_scene(1));
    scenes.push_back(shaped_scene(2));
    scenes[1].shapes->padding = {0.5, 0.25};
    scenes[1].shapes->masks = {6, 7};
    scenes[1].shapes->end_poses = {make_move(8), make_move(9)};
    const LoadedScene joined = io::join_scenes(scenes, std::vector<std::string>{"a", "b"});
    EXPECT_FALSE(joined.lacks_boxes());
    ASSERT_TRUE(joined.shapes);
    const io::LoadedShapes& shapes = *joined.shapes;
    EXPECT_EQ(shapes.geometry, (std::vector<std::uint32_t>{0, 0, 1, 1}));
    EXPECT_EQ(std::get<shape::Sphere>(shapes.shapes[1]).radius, 2);
    EXPECT_EQ(shapes.parents, (std::vector<std::uint32_t>{0, 1, 2, 3}));
    EXPECT_EQ(shapes.padding, (std::vector<double>{0, 0, 0.5, 0.25}));
    EXPECT_EQ(shapes.masks, (std::vector<std::uint32_t>{0xFFFFFFFF, 0xFFFFFFFF, 6, 7}));
    EXPECT_TRUE(shapes.groups.empty());
    const double places[] = {1, 2, 2, 4}, ends[] = {1, 2, 8, 9};
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(shapes.poses[i].rows[0][3], places[i]);
        EXPECT_EQ(shapes.end_poses[i].rows[0][3], ends[i]);
    }
}

TEST(SceneReader, ASetLacksBoxesWhereOneOfItsScenesDoes) {
    std::vector<LoadedScene> scenes;
    scenes.push_back(shaped_scene(1));
    scenes.push_back(shaped_scene(2));
    scenes[1].boxes = {};
    const LoadedScene joined = io::join_scenes(scenes, std::vector<std::string>{"a", "b"});
    EXPECT_TRUE(joined.lacks_boxes());
    EXPECT_EQ(joined.objects, 4u);
    EXPECT_EQ(joined.shapes->poses.size(), 4u);
}

TEST(SceneReader, JoinsTriangles) {
    std::vector<LoadedScene> scenes(2);
    for (LoadedScene& scene : scenes) {
        scene.objects = 2;
        scene.triangles = io::LoadedTriangles{std::vector<Triangle3d>(2), {0, 1}, {"first", "second", "empty"}, {}};
    }
    const LoadedScene joined = io::join_scenes(scenes, std::vector<std::string>{"a", "b"});
    EXPECT_EQ(joined.triangles->owners, (std::vector<std::uint32_t>{0, 1, 3, 4}));
    EXPECT_EQ(joined.triangles->owner_names.size(), 6u);
    EXPECT_EQ(joined.triangles->triangles.size(), 4u);
}

TEST(SceneReader, RefusesShapesBesideBoxesAlone) {
    std::vector<LoadedScene> scenes;
    scenes.push_back(shaped_scene(1));
    scenes.push_back(scene_of<double>({wide_box_at(0)}));
    EXPECT_EQ(error_of(ErrorCode::bad_input,
                       [&] {
                           (void)io::join_scenes(scenes, std::vector<std::string>{"a", "b"});
                       }),
              "b: has only boxes, but a has shapes; the files of one set must have the same");
}

TEST(SceneReader, RefusesFramesThatDoNotAgree) {
    std::vector<LoadedScene> scenes;
    scenes.push_back(scene_of<float>({box_at(0), box_at(1)}, 2, true));
    scenes.push_back(scene_of<float>({box_at(2)}));
    EXPECT_EQ(error_of(ErrorCode::bad_input,
                       [&] {
                           (void)io::join_scenes(scenes, std::vector<std::string>{"a", "b"});
                       }),
              "b: has 1 frames, but a has 2; the files of one set must have the same number");
}

TEST(SceneReader, FindsInvalidBoxes) {
    EXPECT_FALSE(io::find_invalid_box(scene_of<float>({box_at(0), box_at(1)})));
    EXPECT_FALSE(io::find_invalid_box(scene_of<float>({})));
    auto bad = box_at(0);
    bad.min[1] = -std::nanf("");
    EXPECT_EQ(io::find_invalid_box(scene_of<float>({box_at(0), bad}))->what, "min y is nan, not a finite number");
    bad = box_at(0);
    bad.max[2] = INFINITY;
    const auto fault = io::find_invalid_box(scene_of<float>({box_at(0), box_at(1), box_at(2), bad}, 2, true));
    EXPECT_EQ(fault->frame, 1u);
    EXPECT_EQ(fault->object, 1u);
    EXPECT_EQ(fault->what, "max z is inf, not a finite number");
    auto inverted = wide_box_at(0.25);
    inverted.max[0] = 0.1;
    EXPECT_EQ(io::find_invalid_box(scene_of<double>({inverted}))->what, "min x 0.25 is above max x 0.1");
}

}  // namespace
}  // namespace octopair::test
