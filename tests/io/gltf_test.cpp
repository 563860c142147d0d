// Tests the reader of glTF: nodes, names, transforms, copies, extensions, warnings.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "io/gltf_reading.hpp"
#include "io/json/json_scene.hpp"

namespace octopair::test {
namespace {

TEST(Gltf, IntegersGiveAWarningWithTheirStep) {
    GltfBuilder builder = with_positions<std::int16_t>({0, 0, 0, 1, 0, 0, 0, 1, 0}, int16, false);
    EXPECT_EQ(scene_of(builder).largest_rounded, 0);
    builder.root["nodes"][0]["scale"] = {1, 0.25, 0.5};
    builder.root["nodes"][0]["translation"] = {5, 0, 0};
    const LoadedScene scene = scene_of(builder);
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_EQ(scene.warnings[0],
              "f.glb: has coordinates that are integers, in steps of up to 1; parts that touched may overlap by as "
              "much (--tolerance 1)");
    EXPECT_EQ(scene.largest_rounded, 6);  // exporters compute transforms in float32
}

TEST(Gltf, FloatsAndTheirTransformsCountAsRounded) {
    GltfBuilder builder;
    const std::size_t mesh = builder.mesh(builder.positions({0, 0, 0, 3, 0, 0, 0, -4, 0}));
    builder.node({{"mesh", mesh}});
    EXPECT_EQ(scene_of(builder).largest_rounded, 4);
    builder.root["nodes"] = json::array({{{"translation", {0, -100, 0}}, {"scale", {2, 2, 2}}, {"children", {1}}},
                                         {{"mesh", mesh}, {"translation", {1, 0, 0}}}});
    EXPECT_EQ(scene_of(builder).largest_rounded, 100 + 2 * 1 + 2 * 4);
}

TEST(Gltf, TransformsAreFloat64) {
    GltfBuilder builder;
    builder.node({{"mesh", builder.triangle()}, {"translation", {5000000.1, 0, 0}}});
    builder.node({{"mesh", 0}, {"matrix", {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0.1, 0.2, 0.3, 1}}});
    const LoadedScene scene = scene_of(builder);
    EXPECT_EQ(scene.shapes->poses[0].rows[0], (std::array<double, 4>{1, 0, 0, 5000000.1}));
    EXPECT_EQ(box_at(scene).min[0], 5000000.1);
    EXPECT_EQ(scene.shapes->poses[1].rows[2], (std::array<double, 4>{0, 0, 2, 0.3}));
    EXPECT_LE(box_at(scene, 1).min[1], 0.2);
}

TEST(Gltf, QuarterTurnsAreExactAndQuaternionsMayHaveAnyLength) {
    GltfBuilder builder;
    builder.triangle();
    for (const double half : {std::sqrt(0.5), 3.0, 0.7071068}) {
        builder.root["nodes"] = json::array({{{"mesh", 0}, {"rotation", {0, 0, half, half}}, {"scale", {2, 3, 4}}}});
        const auto rows = scene_of(builder).shapes->poses[0].rows;
        EXPECT_EQ(rows[0], (std::array<double, 4>{0, -3, 0, 0})) << half;
        EXPECT_EQ(rows[1], (std::array<double, 4>{2, 0, 0, 0})) << half;
    }
    builder.root["nodes"][0]["rotation"] = {0, 0, 0, 0};
    expect_refusal(builder, "f.glb: nodes[0]: the rotation has the length 0");
}

TEST(Gltf, APoseIsEitherAMatrixOrItsParts) {
    GltfBuilder builder;
    builder.node({{"mesh", builder.triangle()},
                  {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}},
                  {"scale", {1, 1, 1}}});
    expect_refusal(builder, "nodes[0]: scale: the node has a matrix, too");
    builder.root["nodes"][0].erase("scale");
    EXPECT_EQ(scene_of(builder).objects, 1u);
    builder.root["nodes"][0]["matrix"][15] = 2;
    expect_refusal(builder, "nodes[0]: matrix: the last row is not 0, 0, 0, 1");
    builder.root["nodes"][0]["matrix"].erase(15);
    expect_refusal(builder, "nodes[0]: matrix: an array of 15, not an array of 16 numbers");
    builder.root["nodes"][0]["matrix"] = 3;
    expect_refusal(builder, "nodes[0]: matrix: a number, not an array of 16 numbers");
    builder.root["nodes"][0] = {{"mesh", 0}, {"scale", {1, "2", 1}}};
    expect_refusal(builder, "nodes[0]: scale: a string, not a number in an array of 3 numbers");
}

TEST(Gltf, RequiredExtensionsAreReadOrRefusedByName) {
    GltfBuilder builder;
    builder.node({{"mesh", builder.triangle()}});
    builder.root["extensionsRequired"] = {"KHR_materials_unlit",     "KHR_texture_transform", "KHR_mesh_quantization",
                                          "EXT_mesh_gpu_instancing", "KHR_lights_punctual",   "KHR_xmp_json_ld"};
    EXPECT_EQ(scene_of(builder).objects, 1u);
    builder.root["extensionsRequired"] = {"KHR_materials_unlit", "ACME_moved_vertices"};
    expect_refusal(builder,
                   "f.glb: extensionsRequired: the file needs ACME_moved_vertices, which octopair does not read");
    builder.root["extensionsRequired"] = {"EXT_meshopt_compression"};
    expect_refusal(builder,
                   "EXT_meshopt_compression, which octopair does not read; write the file without compression");
    builder.root["extensionsRequired"] = {7};
    expect_refusal(builder, "f.glb: extensionsRequired: a number, not a string");
    builder.root.erase("extensionsRequired");
    builder.root["extensionsUsed"] = {"ACME_moved_vertices"};
    EXPECT_EQ(scene_of(builder).objects, 1u);
}

TEST(Gltf, AssimpReadsOnlyMeshesWithoutACopyThatIsNotCompressed) {
    const auto is_for_assimp = [](const GltfBuilder& builder) {
        return !io::parse_gltf_scene("f.glb", as_buffer(builder.text()), {}, {});
    };
    GltfBuilder builder;
    builder.node({{"mesh", builder.triangle()}});
    json& primitive = builder.root["meshes"][0]["primitives"][0];
    primitive["extensions"] = {{"KHR_draco_mesh_compression", {{"bufferView", 0}}}};
    EXPECT_FALSE(is_for_assimp(builder));
    primitive["indices"] = builder.accessor<std::uint8_t>({0, 1, 2}, uint8, "SCALAR");
    builder.root["accessors"][1].erase("bufferView");
    EXPECT_TRUE(is_for_assimp(builder));
    primitive.erase("indices");
    builder.root["accessors"][0].erase("bufferView");
    EXPECT_TRUE(is_for_assimp(builder));
    builder.root["extensionsUsed"] = {"KHR_mesh_quantization"};
    expect_refusal(
        builder,
        "f.glb: uses KHR_draco_mesh_compression and KHR_mesh_quantization, which octopair does not read together");
}

TEST(Gltf, VersionsAreReadOrRefusedByNumber) {
    GltfBuilder builder;
    builder.node({{"mesh", builder.triangle()}});
    for (const json& version : {json("2.0"), json("2.1"), json(2.0)}) {
        builder.root["asset"]["version"] = version;
        EXPECT_EQ(scene_of(builder).objects, 1u);
    }
    for (const std::string& old : {std::string(R"({"asset": {"version": "1.0"}})"), glb_of("", 1)})
        EXPECT_FALSE(io::parse_gltf_scene("f", as_buffer(old), {}, {}));
    builder.root["asset"]["version"] = "3.0";
    expect_refusal(builder, "f.glb: is of glTF 3.0; octopair reads glTF 2 and 1.0");
    builder.root["asset"].erase("version");
    expect_refusal(builder, "f.glb: asset: the key 'version' is missing");
    builder.root.erase("asset");
    expect_refusal(builder, "f.glb: the key 'asset' is missing");
}

TEST(Gltf, FilesForAssimpShowInTheirText) {
    const TemporaryDirectory directory;
    const auto shows = [&](const std::string& content) {
        write_file(directory.file("f"), content);
        return io::may_be_gltf_for_assimp(directory.file("f"));
    };
    GltfBuilder builder;
    builder.node({{"mesh", builder.triangle()}});
    EXPECT_FALSE(shows(builder.text()));
    EXPECT_FALSE(shows(builder.glb()));
    EXPECT_FALSE(shows("glTF"));
    EXPECT_TRUE(shows(glb_of("", 1)));
    EXPECT_TRUE(shows("{\"asset\" : { \"version\" :\n\"1.0\"}}"));
    EXPECT_FALSE(shows("{\"version\"}"));
    builder.root["extensionsUsed"] = {"KHR_draco_mesh_compression"};
    EXPECT_TRUE(shows(builder.glb()));
    builder.root.erase("extensionsUsed");
    builder.data = "\"version\":\"1.0\"";  // outside of the JSON
    EXPECT_FALSE(shows(builder.glb()));
    EXPECT_FALSE(io::may_be_gltf_for_assimp(directory.file("none")));
}

TEST(Gltf, AnObjectIsNamedByItsPath) {
    GltfBuilder builder;
    const std::size_t mesh = builder.triangle();
    builder.root["meshes"].push_back(builder.root["meshes"][mesh]);
    builder.root["meshes"][1]["name"] = "wheel";
    builder.root["nodes"] = json::array({{{"name", "car"}, {"children", {1, 2, 3, 4}}},
                                         {{"name", "front"}, {"mesh", 1}},
                                         {{"mesh", 1}, {"children", {5}}},
                                         {{"mesh", 0}},
                                         {{"name", ""}, {"children", {6}}},
                                         {{"name", "nut"}, {"mesh", 0}},
                                         {{"name", "bolt"}, {"mesh", 0}}});
    LoadedScene scene = scene_of(builder);
    EXPECT_EQ(scene.names, (Strings{"car/front", "car/wheel", "car/wheel/nut", "car/#2", "car/#3/bolt"}));
    const Strings labels = {"front", "wheel", "nut", "", "bolt"}, parents = {"car", "car", "wheel", "car", "car"};
    for (std::size_t i = 0; i < labels.size(); ++i) {
        EXPECT_EQ(scene.details.of(i, Detail::label), labels[i]) << i;
        EXPECT_EQ(scene.details.of(i, Detail::parent), parents[i]) << i;
    }
    EXPECT_EQ(scene.shapes->parents, (std::vector<std::uint32_t>{0, 0, 1, 0, 2}));
    // Names of meshes that siblings share get the position.
    builder.root["nodes"][3]["mesh"] = 1;
    EXPECT_EQ(scene_of(builder).names,
              (Strings{"car/front", "car/wheel#1", "car/wheel#1/nut", "car/wheel#2", "car/#3/bolt"}));
    builder.root["nodes"][3]["mesh"] = 0;
    builder.root["nodes"].push_back({{"name", "road"}, {"mesh", 0}});
    scene = scene_of(builder);
    EXPECT_EQ(scene.names.front(), "ROOT/car/front");
    EXPECT_EQ(scene.names.back(), "ROOT/road");
    EXPECT_EQ(scene.details.of(5, Detail::parent), "ROOT");
    EXPECT_EQ(scene.details.of(0, Detail::parent), "car");
}

TEST(Gltf, MaterialsAreThoseOfAllPrimitives) {
    GltfBuilder builder;
    builder.node({{"mesh", builder.triangle()}});
    builder.root["materials"] = {{{"name", "steel"}}, {{"name", "brass"}}, json::object()};
    json& primitives = builder.root["meshes"][0]["primitives"];
    for (const int material : {0, 1, 2}) {
        json primitive = primitives[0];
        primitive["material"] = material;
        primitives.push_back(primitive);
    }
    EXPECT_EQ(scene_of(builder).details.of(0, Detail::material), "brass, steel");
    primitives[0]["material"] = 3;
    expect_refusal(builder, "f.glb: refers to materials[3], but the file has 3 materials");
}

TEST(Gltf, OnlyOneSceneIsRead) {
    GltfBuilder builder;
    const std::size_t mesh = builder.triangle();
    for (const char* const name : {"a", "b", "c"}) builder.node({{"name", name}, {"mesh", mesh}});
    EXPECT_EQ(scene_of(builder).names, (Strings{"ROOT/a", "ROOT/b", "ROOT/c"}));  // without scenes: all roots
    builder.root["scenes"] = {{{"nodes", {2}}}};
    EXPECT_EQ(scene_of(builder).names, (Strings{"c"}));
    builder.root["scenes"].push_back({{"nodes", {1, 0}}, {"name", "other"}});
    EXPECT_EQ(scene_of(builder).names, (Strings{"c"}));
    EXPECT_EQ(scene_of(builder).warnings, (Strings{"f.glb: has 2 scenes; only scenes[0] is read"}));
    builder.root["scene"] = 1;
    EXPECT_EQ(scene_of(builder).names, (Strings{"ROOT/b", "ROOT/a"}));
    EXPECT_EQ(scene_of(builder).warnings, (Strings{"f.glb: has 2 scenes; only scenes[1] 'other' is read"}));
    builder.root["scene"] = 2;
    expect_refusal(builder, "f.glb: refers to scenes[2], but the file has 2 scenes");
    builder.root["scene"] = -1;
    expect_refusal(builder, "f.glb: scene: -1 is not a whole number from 0 to 2^53");
    builder.root["scene"] = "0";
    expect_refusal(builder, "f.glb: scene: a string, not a whole number");
    builder.root["scenes"] = json::array({json::object()});
    builder.root.erase("scene");
    EXPECT_EQ(scene_of(builder).objects, 0u);
}

TEST(Gltf, NodesAreATree) {
    GltfBuilder builder;
    builder.triangle();
    builder.root["scenes"] = {{{"nodes", {0}}}};
    builder.root["nodes"] = {{{"children", {1, 2}}}, {{"children", {3}}}, {{"children", {3}}}, {{"mesh", 0}}};
    expect_refusal(builder, "f.glb: nodes[3]: occurs twice in the scene: a node must have one parent at most");
    builder.root["nodes"][2]["children"] = {0};
    expect_refusal(builder, "f.glb: nodes[0]: occurs twice");
    builder.root["nodes"][2]["children"] = {4};
    expect_refusal(builder, "f.glb: refers to nodes[4], but the file has 4 nodes");
    builder.root["nodes"][2]["children"] = {0.5};
    expect_refusal(builder, "nodes[2]: children: 0.5 is not a whole number");
    builder.root["nodes"][2]["children"] = 3;
    expect_refusal(builder, "nodes[2]: children: a number, not an array");
    builder.root["nodes"][2].erase("children");
    EXPECT_EQ(scene_of(builder).objects, 1u);
}

TEST(Gltf, AChainOfNodesMayBeLong) {
    GltfBuilder builder;
    builder.triangle();
    constexpr int length = 4000;
    for (int i = 0; i + 1 < length; ++i) builder.node({{"children", {i + 1}}, {"name", "n"}});
    builder.node({{"mesh", 0}});
    EXPECT_EQ(scene_of(builder).names[0].size(), 2 * length);
}

/// Returns the triangles of a primitive of 7 vertices (i, 0, 0) as their x, and the number of vertices in all.
std::vector<std::array<std::uint32_t, 3>> triangles_in_mode(int mode, std::size_t& vertices) {
    GltfBuilder builder;
    std::vector<float> values;
    for (const float x : {0.F, 1.F, 2.F, 3.F, 4.F, 5.F, 6.F}) values.insert(values.end(), {x, 0, 0});
    builder.node({{"mesh", builder.mesh(builder.positions(values), {{"mode", mode}})}});
    const LoadedScene scene = scene_of(builder);
    EXPECT_EQ(scene.objects, 1u);
    vertices = std::size_t(box_at(scene).max[0]) + 1;
    const auto& mesh = mesh_of(scene);
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) EXPECT_EQ(mesh.vertices[i][0], double(i));
    EXPECT_EQ(scene.warnings.size(), std::size_t(mode == 1 || mode == 4) + std::size_t(mode < 4));
    return mesh.triangles;
}

TEST(Gltf, StripsAndFansAreTriangles) {
    using Corners = std::vector<std::array<std::uint32_t, 3>>;
    std::size_t vertices = 0;
    EXPECT_EQ(triangles_in_mode(4, vertices), (Corners{{0, 1, 2}, {3, 4, 5}}));
    EXPECT_EQ(vertices, 6u);
    EXPECT_EQ(triangles_in_mode(5, vertices), (Corners{{0, 1, 2}, {2, 1, 3}, {2, 3, 4}, {4, 3, 5}, {4, 5, 6}}));
    EXPECT_EQ(vertices, 7u);
    EXPECT_EQ(triangles_in_mode(6, vertices), (Corners{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}, {0, 5, 6}}));
    for (const int mode : {0, 1, 2, 3}) {
        EXPECT_EQ(triangles_in_mode(mode, vertices), Corners());
        EXPECT_EQ(vertices, mode == 1 ? 6u : 7u) << mode;
    }
    GltfBuilder builder;
    builder.node({{"mesh", builder.mesh(builder.positions({0, 0, 0, 1, 0, 0}), {{"mode", 7}})}});
    expect_refusal(builder, "meshes[0].primitives[0]: mode: 7 is not a mode of glTF, which are 0 to 6");
    for (const int mode : {4, 5, 6}) {
        builder.root["meshes"][0]["primitives"][0]["mode"] = mode;
        const LoadedScene scene = scene_of(builder);
        EXPECT_EQ(scene.objects, 0u);
        EXPECT_EQ(scene.warnings,
                  (Strings{"f.glb: meshes[0].primitives[0]: its last 2 of 2 vertices make no complete face and are not "
                           "read"}));
    }
    json& primitives = builder.root["meshes"][0]["primitives"];
    primitives.push_back(primitives[0]);
    expect_part(scene_of(builder).warnings[0], "are not read; so are those of 1 more primitives");
}

TEST(Gltf, APrimitiveWithoutPositionsHasNoGeometry) {
    GltfBuilder builder;
    builder.node({{"mesh", builder.triangle()}});
    builder.root["meshes"][0]["primitives"][0]["attributes"] = {{"NORMAL", 0}};
    EXPECT_EQ(scene_of(builder).objects, 0u);
}

TEST(Gltf, CopiesOfANodeAreObjects) {
    GltfBuilder builder;
    const std::size_t mesh = builder.triangle();
    json attributes = {{"TRANSLATION", builder.positions({0, 0, 0, 10, 0, 0, 0, 20, 0})},
                       {"ROTATION", builder.accessor<std::int8_t>({0, 0, 0, 127, 0, 0, 127, 0, 0, 0, 90, 90}, int8,
                                                                  "VEC4", {{"normalized", true}})},
                       {"SCALE", builder.positions({1, 1, 1, 2, 2, 2, 1, 1, 3})}};
    builder.node({{"name", "line"}, {"children", {1}}, {"translation", {0, 0, 5}}});
    builder.node({{"name", "bolt"}, {"mesh", mesh}, {"scale", {2, 2, 2}}, {"children", {2}}});
    builder.node({{"name", "head"}, {"mesh", mesh}});
    json& extension = builder.root["nodes"][1]["extensions"]["EXT_mesh_gpu_instancing"];
    extension["attributes"] = attributes;
    builder.root["scenes"] = {{{"nodes", {0}}}};
    const LoadedScene scene = scene_of(builder);
    EXPECT_EQ(scene.names, (Strings{"line/bolt/#0", "line/bolt/#1", "line/bolt/#2", "line/bolt/head"}));
    EXPECT_EQ(scene.shapes->shapes.size(), 1u);
    EXPECT_EQ(scene.shapes->poses[0].rows[0], (std::array<double, 4>{2, 0, 0, 0}));
    EXPECT_EQ(scene.shapes->poses[1].rows[0], (std::array<double, 4>{-4, 0, 0, 20}));
    EXPECT_EQ(scene.shapes->poses[2].rows[0], (std::array<double, 4>{0, -2, 0, 0}));
    EXPECT_EQ(scene.shapes->poses[2].rows[1], (std::array<double, 4>{2, 0, 0, 40}));
    EXPECT_EQ(scene.shapes->poses[2].rows[2], (std::array<double, 4>{0, 0, 6, 5}));
    EXPECT_EQ(scene.details.of(2, Detail::label), "bolt");
    EXPECT_EQ(scene.details.of(2, Detail::parent), "line");
    EXPECT_EQ(scene.shapes->parents, (std::vector<std::uint32_t>{0, 0, 0, 1}));
    EXPECT_EQ(box_at(scene, 2).max[1], 42);
    extension["attributes"] = {{"_ID", attributes["SCALE"]}};
    EXPECT_EQ(scene_of(builder).objects, 4u);
    extension["attributes"] = attributes;
    builder.root["accessors"][3]["count"] = 2;
    expect_refusal(builder, "nodes[1]: EXT_mesh_gpu_instancing: attributes: has arrays of 3 and 2 elements");
    extension["attributes"] = {{"ROTATION", builder.accessor<float>({0, 0, 0, 1, 0, 0, 0, NAN}, float32, "VEC4")}};
    expect_refusal(builder, "nodes[1]: EXT_mesh_gpu_instancing: copy 1: the rotation has the length nan");
    extension["attributes"] = {{"SCALE", builder.positions({INFINITY, 0, 0})}};
    expect_refusal(builder, "copy 0: the transform has the number inf");
    extension.erase("attributes");
    expect_refusal(builder, "nodes[1]: EXT_mesh_gpu_instancing: the key 'attributes' is missing");
}

TEST(Gltf, WhatIsNotAppliedIsSaid) {
    GltfBuilder builder;
    const std::size_t mesh = builder.triangle();
    builder.root["nodes"] = json::array(
        {{{"children", {1, 2, 3}}}, {{"mesh", mesh}, {"skin", 0}}, {{"mesh", mesh}, {"skin", 0}}, {{"skin", 0}}});
    EXPECT_EQ(scene_of(builder).warnings,
              (Strings{"f.glb: 2 nodes have skins; this is not applied: their geometry at rest is read"}));
    builder.root["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", 0}}};
    builder.root["nodes"][2] = json::object();
    // An animation of a camera, or of what is not a node, moves no mesh.
    const auto channel = [](const json& node) { return json{{"target", {{"node", node}, {"path", "translation"}}}}; };
    builder.root["animations"] = {{{"channels", {channel(0), channel(3), channel(77), channel("0"), json(7)}}},
                                  json(3)};
    EXPECT_EQ(scene_of(builder).warnings,
              (Strings{"f.glb: 1 node has a skin, 1 node has morph targets, 1 node is animated; this is not "
                       "applied: their geometry at rest is read"}));
}

TEST(Gltf, ProgressEndsAtOne) {
    GltfBuilder builder;
    builder.node({{"mesh", builder.triangle()}});
    builder.node({{"mesh", builder.triangle()}});
    std::vector<double> parts;
    (void)scene_of(builder.text(), {MeshObjects::node, false, [&](double part) { parts.push_back(part); }});
    EXPECT_EQ(parts, (std::vector<double>{0.5, 1}));
}

TEST(Gltf, AJsonSceneMayNameAGlbFile) {
    const TemporaryDirectory directory;
    GltfBuilder builder = with_positions<std::int16_t>({0, 0, 0, 100, 0, 0, 0, 100, 0}, int16, false);
    builder.root["nodes"][0]["scale"] = {0.5, 0.5, 0.5};
    builder.node({{"mesh", 0}, {"translation", {0, 0, 7}}});
    write_file(directory.file("m.glb"), builder.glb());
    write_file(directory.file("s.json"), R"({"objects": [{"shape": {"type": "mesh", "file": "m.glb"}}]})");
    const LoadedScene scene = io::read_json_scene(directory.file("s.json"));
    const auto& mesh = std::get<shape::Mesh>(scene.shapes->shapes[0]);
    EXPECT_EQ(mesh.vertices,
              (std::vector<Point3d>{{0, 0, 0}, {50, 0, 0}, {0, 50, 0}, {0, 0, 7}, {100, 0, 7}, {0, 100, 7}}));
    EXPECT_EQ(mesh.triangles, (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {3, 4, 5}}));
    EXPECT_EQ(scene.largest_rounded, 107);
}

TEST(Gltf, FilesForNewerReadersAreRefused) {
    GltfBuilder builder;
    builder.node({{"mesh", builder.triangle()}});
    builder.root["asset"] = {{"version", "2.1"}, {"minVersion", "2.0"}};
    EXPECT_EQ(scene_of(builder).objects, 1u);
    for (const json& least : {json("2.1"), json("3.0"), json(2.5), json("next")}) {
        builder.root["asset"]["minVersion"] = least;
        expect_refusal(builder, "f.glb: asset: minVersion: the file needs a reader of glTF ");
    }
    builder.root["asset"]["minVersion"] = json::array();
    expect_refusal(builder, "asset: minVersion: an array, not a string");
}

TEST(Gltf, HiddenNodesAreReadAndTold) {
    GltfBuilder builder;
    const std::size_t mesh = builder.triangle();
    const json hidden = {{"KHR_node_visibility", {{"visible", false}}}};
    builder.node({{"mesh", mesh}, {"name", "door"}, {"extensions", hidden}, {"children", {1}}});
    builder.node({{"mesh", mesh}, {"name", "hinge"}, {"extensions", {{"KHR_node_visibility", {{"visible", true}}}}}});
    builder.node({{"mesh", mesh}, {"name", "wall"}, {"extensions", {{"KHR_node_visibility", json::object()}}}});
    builder.root["extensionsRequired"] = builder.root["extensionsUsed"] = {"KHR_node_visibility"};
    const LoadedScene scene = scene_of(builder);
    EXPECT_EQ(scene.names, (Strings{"ROOT/door", "ROOT/door/hinge", "ROOT/wall"}));
    EXPECT_EQ(scene.warnings,
              Strings{"f.glb: 2 nodes are not visible (KHR_node_visibility); they are read like all others, "
                      "because visibility is about pictures. Rules (--exclude) can leave them out"});
    builder.root["nodes"][0]["extensions"]["KHR_node_visibility"]["visible"] = 0;
    expect_refusal(builder, "f.glb: nodes[0]: KHR_node_visibility: visible: a number, not true or false");
}

TEST(Gltf, PointsAndLinesAreTold) {
    GltfBuilder builder;
    const std::size_t places = builder.positions({0, 0, 0, 1, 0, 0, 0, 1, 0});
    builder.node({{"mesh", builder.mesh(places, {{"mode", 0}})}});
    EXPECT_EQ(scene_of(builder).warnings,
              Strings{"f.glb: 1 primitive is of points or lines, which have no surface: only "
                      "boxes contain it, not shapes and triangles"});
    builder.node({{"mesh", builder.mesh(places, {{"mode", 3}})}});
    EXPECT_EQ(scene_of(builder).warnings,
              Strings{"f.glb: 2 primitives are of points or lines, which have no surface: only "
                      "boxes contain them, not shapes and triangles"});
}

TEST(Gltf, DataUrisAreReadInAllSpellings) {
    GltfBuilder builder;
    const std::size_t places = builder.positions({0, 0, 0, 1, 0, 0, 0, 1, 0, -1e-30F, 5e7F, 2});
    builder.node({{"mesh", builder.mesh(places, {{"mode", 5}})}});
    const std::string data = base64(builder.data);
    std::string for_urls = data, bytes;
    std::replace(for_urls.begin(), for_urls.end(), '+', '-');
    std::replace(for_urls.begin(), for_urls.end(), '/', '_');
    for (const char c : builder.data) bytes += fmt::format("%{:02X}", std::uint8_t(c));
    const LoadedScene expected = scene_of(builder);
    for (const std::string& uri : {"data:application/gltf-buffer;base64," + data, "DATA:;BASE64," + data,
                                   "data:; base64 ," + data, "data:a/b;charset=x;base64," + for_urls,
                                   "data:;base64," + data.substr(0, 8) + "\r\n " + data.substr(8) + "\n",
                                   "data:," + bytes, "data:a/b;base64=no," + bytes}) {
        EXPECT_EQ(mesh_of(scene_of(builder.text(uri))).vertices, mesh_of(expected).vertices) << uri;
    }
    expect_part(refusal_of(builder.text("data:application/octet-stream;base64")),
                "buffers[0]: uri: 'data:application/octet-stream;base64' has no comma");
    expect_part(refusal_of(builder.text("data:;base64,A" + data)), "is not valid base64");
}

}  // namespace
}  // namespace octopair::test
