// Tests the serialization of scenes: the transfer preserves every part of a scene.
#include "cli/input/isolated_read.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <stdexcept>
#include <vector>

#include "octopair/error.hpp"

namespace octopair::test {
namespace {

using io::LoadedScene;

std::vector<std::byte> bytes_of(const LoadedScene& scene) {
    std::vector<std::byte> bytes;
    cli::send_scene(scene,
                    [&](std::span<const std::byte> some) { bytes.insert(bytes.end(), some.begin(), some.end()); });
    return bytes;
}

LoadedScene scene_of(std::span<const std::byte> bytes) {
    const LoadedScene scene = cli::receive_scene([&](std::span<std::byte> some) {
        if (some.size() > bytes.size()) throw std::out_of_range("no more bytes");
        if (!some.empty()) std::memcpy(some.data(), bytes.data(), some.size());
        bytes = bytes.subspan(some.size());
    });
    EXPECT_TRUE(bytes.empty());
    return cli::receive_scene([again = bytes_of(scene), at = std::size_t(0)](std::span<std::byte> some) mutable {
        if (!some.empty()) std::memcpy(some.data(), again.data() + at, some.size());
        at += some.size();
    });
}

LoadedScene full_scene() {
    LoadedScene scene;
    Buffer<Box3d> boxes{2};
    boxes[0] = {{0, 1, 2}, {3, 4, 5}};
    boxes[1] = {{-1, 0, 0}, {1, 1e300, 1}};
    scene.boxes = std::move(boxes);
    scene.objects = 2;
    scene.frames = 1;
    scene.names = {"", "wheel"};
    scene.shapes.emplace();
    scene.shapes->shapes = {shape::Cone{1, 2}, shape::Mesh{{{1, 2, 3}, {4, 5, 6}}, {{0, 1, 1}}},
                            shape::ConvexHull{{{7, 8, 9}}}};
    scene.shapes->geometry = {1, 2};
    scene.shapes->poses.resize(2);
    scene.shapes->poses[1].rows[2][3] = 4.5;
    scene.shapes->parents = {0, 0};
    scene.shapes->padding = {0.5, 0.25};
    scene.triangles = io::LoadedTriangles{{Triangle3d{{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}}}, {1}, {"none", "wheel"}, {}};
    io::DetailsBuilder(scene.details).add({"w", "wheel", "7", "car", "", "steel"});
    io::DetailsBuilder(scene.triangles->owner_details).add({"o", "", "", "", "", ""});
    scene.space = {io::UpAxis::y, "mm"};
    scene.converted_from = "in";
    scene.relations.keys = {"", "p/d", "p/w"};
    scene.relations.elements = {1, 2};
    scene.relations.links = {{{{1, 2}}, {{2, 1}}, {{1, 1}}}};
    scene.elements = {4, 3, {{"a.ifc", "IFCWALL", 1, "x"}}, {{"IFCSPACE", 2}}};
    return scene;
}

TEST(SceneTransfer, AllThatASceneHoldsArrives) {
    const LoadedScene sent = full_scene();
    const LoadedScene scene = scene_of(bytes_of(sent));
    EXPECT_EQ(bytes_of(scene), bytes_of(sent));
    EXPECT_EQ(std::get<Buffer<Box3d>>(scene.boxes)[1].max[1], 1e300);
    EXPECT_EQ(scene.objects, 2u);
    EXPECT_EQ(scene.names, sent.names);
    EXPECT_EQ(scene.details.of(0, io::Detail::material), "steel");
    EXPECT_EQ(scene.details.rows, sent.details.rows);
    EXPECT_EQ(scene.space, sent.space);
    EXPECT_EQ(scene.converted_from, "in");
    EXPECT_EQ(scene.relations.keys, sent.relations.keys);
    EXPECT_EQ(scene.relations.elements, sent.relations.elements);
    EXPECT_EQ(scene.relations.links, sent.relations.links);
    EXPECT_EQ(scene.elements.lost[0].first, "x");
    EXPECT_EQ(scene.elements.left_out[0].count, 2u);
    ASSERT_TRUE(scene.shapes && scene.triangles);
    EXPECT_EQ(std::get<shape::Cone>(scene.shapes->shapes[0]).length, 2);
    EXPECT_EQ(std::get<shape::Mesh>(scene.shapes->shapes[1]).triangles, (decltype(shape::Mesh::triangles){{0, 1, 1}}));
    EXPECT_EQ(std::get<shape::ConvexHull>(scene.shapes->shapes[2]).points[0][2], 9);
    EXPECT_EQ(scene.shapes->geometry, sent.shapes->geometry);
    EXPECT_EQ(scene.shapes->poses[1].rows, sent.shapes->poses[1].rows);
    EXPECT_EQ(scene.shapes->padding, sent.shapes->padding);
    EXPECT_EQ(scene.triangles->triangles, sent.triangles->triangles);
    EXPECT_EQ(scene.triangles->owner_names, sent.triangles->owner_names);
    EXPECT_EQ(scene.triangles->owner_details.of(0, io::Detail::label), "o");
}

TEST(SceneTransfer, BytesOfNoSceneAreAnError) {
    std::vector<std::byte> bytes = bytes_of({});
    bytes[0] = std::byte(2);  // kind of boxes; only 0 and 1 exist
    EXPECT_THROW((void)scene_of(bytes), Error);
    EXPECT_THROW((void)scene_of(std::span(bytes).first(3)), std::out_of_range);
}

}  // namespace
}  // namespace octopair::test
