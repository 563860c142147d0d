// Tests the reader of glTF: numbers, indices, buffers, GLB and JSON, and their faults.
#include <gtest/gtest.h>

#include <cmath>

#include "io/gltf_reading.hpp"
#include "io/meshes/uri.hpp"
#include "support/calls.hpp"

namespace octopair::test {
namespace {

TEST(GltfData, IntegersAsPositionsAreExact) {
    using Vertices = std::vector<Point3d>;
    const auto vertices = [](const GltfBuilder& builder) { return mesh_of(scene_of(builder)).vertices; };
    EXPECT_EQ(vertices(with_positions<std::int16_t>({-32768, 0, 1, 2, 3, 4, 5, 6, 32767}, int16, false)),
              (Vertices{{-32768, 0, 1}, {2, 3, 4}, {5, 6, 32767}}));
    EXPECT_EQ(
        vertices(with_positions<std::int16_t>({-32768, -32767, 1, 2, 3, 4, 5, 6, 32767}, int16, true)),
        (Vertices{{-1, -1, 1.0 / 32767}, {2.0 / 32767, 3.0 / 32767, 4.0 / 32767}, {5.0 / 32767, 6.0 / 32767, 1}}));
    EXPECT_EQ(vertices(with_positions<std::int8_t>({-128, -127, 1, 2, 3, 4, 5, 6, 127}, int8, true)),
              (Vertices{{-1, -1, 1.0 / 127}, {2.0 / 127, 3.0 / 127, 4.0 / 127}, {5.0 / 127, 6.0 / 127, 1}}));
    EXPECT_EQ(vertices(with_positions<std::uint8_t>({0, 1, 2, 3, 4, 5, 6, 7, 255}, uint8, false)),
              (Vertices{{0, 1, 2}, {3, 4, 5}, {6, 7, 255}}));
    EXPECT_EQ(
        vertices(with_positions<std::uint16_t>({0, 1, 2, 3, 4, 5, 6, 7, 65535}, uint16, true)),
        (Vertices{
            {0, 1.0 / 65535, 2.0 / 65535}, {3.0 / 65535, 4.0 / 65535, 5.0 / 65535}, {6.0 / 65535, 7.0 / 65535, 1}}));
}

TEST(GltfData, IndicesChooseVertices) {
    GltfBuilder builder;
    const std::size_t positions = builder.positions({9, 9, 9, 0, 0, 0, 1, 0, 0, 0, 1, 0});
    builder.node(
        {{"mesh", builder.mesh(positions, {{"indices", builder.accessor<std::uint8_t>({3, 1, 2}, uint8, "SCALAR")}})}});
    builder.node({{"mesh", builder.mesh(positions,
                                        {{"indices", builder.accessor<std::uint16_t>({3, 1, 2}, uint16, "SCALAR")}})}});
    builder.node({{"mesh", builder.mesh(positions,
                                        {{"indices", builder.accessor<std::uint32_t>({3, 1, 2}, uint32, "SCALAR")}})}});
    const LoadedScene scene = scene_of(builder);
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(mesh_of(scene, i).vertices, (std::vector<Point3d>{{0, 1, 0}, {0, 0, 0}, {1, 0, 0}}));
        EXPECT_EQ(box_at(scene, i).max[2], 0);  // vertex 0 is not used
    }
}

TEST(GltfData, RefusesIndicesOfNoVertex) {
    GltfBuilder builder;
    const std::size_t mesh = builder.triangle();
    builder.node({{"name", "n"}, {"mesh", mesh}});
    json& indices = builder.root["meshes"][0]["primitives"][0]["indices"];
    indices = builder.accessor<std::uint16_t>({0, 1, 3}, uint16, "SCALAR");
    expect_refusal(builder, "f.glb: node 'n': meshes[0].primitives[0]: index 2 is vertex 3, but there are 3 vertices");
    indices = builder.accessor<std::uint8_t>({0, 255, 2}, uint8, "SCALAR");
    expect_refusal(
        builder, "f.glb: node 'n': meshes[0].primitives[0]: index 1 is 255, which glTF reserves to restart primitives");
    indices = builder.accessor<std::uint16_t>({0, 65535, 2}, uint16, "SCALAR");
    expect_refusal(builder, "index 1 is 65535, which");
    indices = builder.accessor<std::uint32_t>({0, 0xFFFFFFFF, 2}, uint32, "SCALAR");
    expect_refusal(builder, "index 1 is 4294967295, which");
    indices = builder.accessor<std::int16_t>({0, 1, 2}, int16, "SCALAR");
    expect_refusal(builder, "accessors[5]: indices must be unsigned integers that are not normalized");
    indices = builder.accessor<float>({0, 1, 2}, float32, "SCALAR");
    expect_refusal(builder, "accessors[6]: indices must be unsigned integers");
    indices = 0;
    expect_refusal(builder, "accessors[0]: type: 'VEC3', but SCALAR is needed here");
    indices = 99;
    expect_refusal(builder, "f.glb: refers to accessors[99], but the file has 7 accessors");
}

TEST(GltfData, RefusesVerticesThatAreNowhere) {
    GltfBuilder builder;
    builder.node({{"name", "n"}, {"mesh", builder.mesh(builder.positions({0, 0, 0, 1, 0, 0, 0, -INFINITY, 0}))}});
    expect_refusal(builder, "f.glb: node 'n': vertex 2 has the coordinate -inf, which is not finite");
    builder = with_positions<float>({0, 0, 0, 3e38F, 0, 0, 0, 1, 0}, float32, false);
    builder.root["nodes"][0].update({{"name", "n"}, {"scale", {1e300, 1, 1}}});
    expect_refusal(
        builder,
        "f.glb: node 'n': its transforms move the vertex 3e+38, 0, 0 to the coordinate inf, which is not finite");
    builder.root["nodes"][0]["scale"] = {10, 1, 1};
    EXPECT_EQ(scene_of(builder).objects, 1u);
    for (const bool shapes : {false, true}) {
        const std::string words = error_of(ErrorCode::bad_input, [&] {
            (void)scene_of(builder.text(), {MeshObjects::triangle, shapes, {}});
        });
        expect_part(words, "f.glb: node 'n': the coordinate 3");
        expect_part(words, "is beyond the range of float32");
    }
}

TEST(GltfData, ElementsMayHaveGaps) {
    GltfBuilder builder;
    const std::size_t view =
        builder.view(std::string(2, '?') + bytes_of<float>({0, 0, 0, 7, 1, 0, 0, 7, 0, 1, 0}), {{"byteStride", 16}});
    json accessor = {{"bufferView", view}, {"byteOffset", 2}, {"componentType", 5126}, {"count", 3}, {"type", "VEC3"}};
    builder.add("accessors", accessor);
    builder.node({{"mesh", builder.mesh(0)}});
    EXPECT_EQ(mesh_of(scene_of(builder)).vertices, (std::vector<Point3d>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
    builder.root["accessors"][0]["byteOffset"] = 3;
    expect_refusal(builder, "f.glb: accessors[0]: ends at byte 47 of bufferViews[0], which has 46 bytes");
    builder.root["bufferViews"][0]["byteStride"] = 8;
    expect_refusal(builder, "f.glb: accessors[0]: has elements of 12 bytes, but the byteStride of bufferViews[0] is 8");
}

TEST(GltfData, RefusesDataOutsideOfTheirPlace) {
    GltfBuilder builder;
    builder.node({{"mesh", builder.triangle()}});
    json& accessor = builder.root["accessors"][0];
    json& view = builder.root["bufferViews"][0];
    for (const std::uint64_t count : {std::uint64_t(4), std::uint64_t(1) << 53}) {
        accessor["count"] = count;
        expect_refusal(builder, "of bufferViews[0], which has 36 bytes");
    }
    accessor["count"] = 0x1p60;
    expect_refusal(builder, "accessors[0]: count: 1.152921504606847e+18 is not a whole number from 0 to 2^53");
    accessor["count"] = 3;
    accessor["byteOffset"] = std::uint64_t(1) << 53;
    expect_refusal(builder, "f.glb: accessors[0]: ends at byte 9007199254741028 of bufferViews[0]");
    accessor.erase("byteOffset");
    view["byteLength"] = 37;
    expect_refusal(builder, "f.glb: bufferViews[0]: ends at byte 37 of buffers[0], which has 36 bytes");
    view["byteLength"] = 36;
    view["byteOffset"] = 1;
    expect_refusal(builder, "f.glb: bufferViews[0]: ends at byte 37 of buffers[0], which has 36 bytes");
    view["byteOffset"] = 37;
    expect_refusal(builder, "f.glb: bufferViews[0]: ends at byte 73");
    view["buffer"] = 1;
    expect_refusal(builder, "f.glb: refers to buffers[1], but the file has 1 buffers");
    accessor["bufferView"] = 1;
    expect_refusal(builder, "f.glb: refers to bufferViews[1], but the file has 1 bufferViews");
    accessor["componentType"] = 5124;
    expect_refusal(builder, "f.glb: accessors[0]: componentType: 5124 is not a type of glTF");
    accessor["componentType"] = 5130;
    expect_refusal(builder, "componentType: 5130 is not a type of glTF");
    accessor["componentType"] = 5125;
    accessor["normalized"] = true;
    expect_refusal(builder, "accessors[0]: normalized: integers of 32 bits cannot be normalized");
    accessor.erase("componentType");
    expect_refusal(builder, "accessors[0]: the key 'componentType' is missing");
}

TEST(GltfData, SparseElementsReplaceOthers) {
    GltfBuilder builder;
    builder.node({{"mesh", builder.mesh(builder.positions({0, 0, 0, 1, 0, 0, 0, 1, 0}))}});
    json& sparse = builder.root["accessors"][0]["sparse"];
    sparse["count"] = 2;
    sparse["indices"] = {
        {"bufferView", builder.view(bytes_of<std::uint16_t>({9, 0, 2}))}, {"byteOffset", 2}, {"componentType", 5123}};
    sparse["values"] = {{"bufferView", builder.view(bytes_of<float>({5, 5, 5, 6, 6, 6}))}};
    EXPECT_EQ(mesh_of(scene_of(builder)).vertices, (std::vector<Point3d>{{5, 5, 5}, {1, 0, 0}, {6, 6, 6}}));
    json whole = builder.root["accessors"][0];
    builder.root["accessors"][0].erase("bufferView");
    EXPECT_EQ(mesh_of(scene_of(builder)).vertices, (std::vector<Point3d>{{5, 5, 5}, {0, 0, 0}, {6, 6, 6}}));
    builder.root["accessors"][0]["count"] = 2;
    expect_refusal(builder, "accessors[0]: sparse: indices: replaces element 2 of 2");
    builder.root["accessors"][0] = whole;
    builder.root["accessors"][0]["sparse"]["indices"]["byteOffset"] = 0;
    expect_refusal(builder, "accessors[0]: sparse: indices: replaces element 9 of 3");
    builder.root["accessors"][0]["sparse"]["indices"]["byteOffset"] = 4;
    expect_refusal(builder, "accessors[0]: sparse: indices: ends at byte 8 of bufferViews[1], which has 6 bytes");
    builder.root["accessors"][0] = whole;
    builder.root["accessors"][0]["sparse"]["indices"]["bufferView"] = builder.view(bytes_of<std::uint16_t>({0, 2, 2}));
    expect_refusal(builder, "accessors[0]: sparse: indices: index 1 is ");
    builder.root["accessors"][0]["sparse"]["indices"]["componentType"] = 5122;
    expect_refusal(builder, "accessors[0]: sparse: indices: indices must be unsigned integers");
    builder.root["accessors"][0]["sparse"]["values"]["byteOffset"] = 4;
    expect_refusal(builder, "accessors[0]: sparse: values: ends at byte 28 of bufferViews[2], which has 24 bytes");
    builder.root["bufferViews"][2]["byteStride"] = 4;
    expect_refusal(builder, "accessors[0]: sparse: values: has elements of 12 bytes");
    builder.root["bufferViews"][2]["byteStride"] = 16;
    builder.root["accessors"][0]["sparse"]["count"] = 1;
    expect_refusal(builder, "accessors[0]: sparse: values: has a byteStride, which sparse values must not have");
    builder.root["accessors"][0]["sparse"].erase("values");
    expect_refusal(builder, "accessors[0]: sparse: the key 'values' is missing");
    builder.root["accessors"][0]["sparse"]["values"] = 1;
    expect_refusal(builder, "accessors[0]: sparse: values: a number, not an object");
    builder.root["accessors"][0]["sparse"]["values"] = json::object();
    builder.root["accessors"][0]["sparse"]["indices"] = 1;
    expect_refusal(builder, "accessors[0]: sparse: indices: a number, not an object");
}

TEST(GltfData, AnAccessorWithoutDataHasZeros) {
    GltfBuilder builder;
    builder.add("accessors", {{"componentType", 5126}, {"count", 3}, {"type", "VEC3"}});
    builder.node({{"mesh", builder.mesh(0)}});
    EXPECT_EQ(mesh_of(scene_of(builder)).vertices, (std::vector<Point3d>{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}));
    builder.root["accessors"][0]["count"] = 4000000000;
    expect_refusal(builder, "f.glb: accessors[0]: has 4000000000 elements without data; at most 16777216 are read");
}

TEST(GltfData, BuffersAreFilesWithEncodedNames) {
    const TemporaryDirectory directory;
    GltfBuilder builder;
    builder.node({{"mesh", builder.triangle()}});
    const auto read = [&](const std::string& uri) {
        write_file(directory.file("f.gltf"), builder.text(uri));
        return io::read_scene(directory.file("f.gltf"), {}).objects;
    };
    const auto refusal = [&](ErrorCode code, const std::string& uri) {
        return error_of(code, [&] { (void)read(uri); });
    };
    write_file(directory.file("two words+\xC3\xBC.bin"), builder.data);
    EXPECT_EQ(read("two%20words+%c3%BC.bin"), 1u);
    EXPECT_EQ(read("./two words+\xC3\xBC.bin"), 1u);
    write_file(directory.file("100%.bin"), builder.data);
    EXPECT_EQ(read("100%.bin"), 1u);
    write_file(directory.file("a%20b.bin"), builder.data);
    EXPECT_EQ(read("a%20b.bin"), 1u);  // the exporter did not encode the name
    write_file(directory.file("a b.bin"), "");
    expect_part(refusal(ErrorCode::bad_input, "a%20b.bin"), ": buffers[0]: byteLength: 36, but its data have 0 bytes");
    std::filesystem::create_directory(directory.file("folder"));
    EXPECT_EQ(read("folder/../100%.bin"), 1u);
    expect_part(refusal(ErrorCode::bad_input, "folder"), ": buffers[0]: uri: 'folder' is not a regular file");
    EXPECT_EQ(refusal(ErrorCode::bad_input, "no%20ne.bin"),
              directory.file("f.gltf") + ": buffers[0]: uri: there is no file 'no ne.bin' in " + directory.path());
    expect_part(refusal(ErrorCode::bad_input, "https://example.org/a.bin"),
                "has the scheme 'https', not the name of a file; put the data");
    expect_part(refusal(ErrorCode::bad_input, "file:///a.bin"), "has the scheme 'file'");
    expect_part(refusal(ErrorCode::bad_input, directory.file("100%.bin")), "is an absolute name");
    expect_part(refusal(ErrorCode::bad_input, "a%00b"), "is not the name of a file");
}

TEST(GltfData, BuffersAreBase64) {
    GltfBuilder builder;
    builder.node({{"mesh", builder.triangle()}});
    EXPECT_EQ(scene_of(builder.text("data:;base64," + base64(builder.data))).objects, 1u);
    std::string encoded = base64(builder.data);
    EXPECT_EQ(encoded.back(), 'A');  // 36 bytes need no padding
    encoded.replace(encoded.find('A'), 1, "%41");
    EXPECT_EQ(scene_of(builder.text("data:;base64," + encoded)).objects, 1u);
    expect_part(refusal_of(builder.text("data:;base64,AAAA?AAA")),
                "f.glb: buffers[0]: uri: 'data:;base64,AAAA?AAA' is not valid base64");
    expect_part(refusal_of(builder.text("data:;base64,AAAAA")), "is not valid base64");
    expect_part(refusal_of(builder.text("data:,AAAA")), "buffers[0]: byteLength: 36, but its data have 4 bytes");
    expect_part(refusal_of(builder.text("data:;base64")), "'data:;base64' has no comma before its data");
    expect_part(refusal_of(builder.text("data:;base64,AAAA")), "buffers[0]: byteLength: 36, but its data have 3 bytes");
    for (const std::string& text :
         Strings{"", "f", "fo", "foo", "foob", "fooba", "foobar", std::string("\xFF\0\x80", 3)}) {
        auto coded = base64(text);
        for (int i = 0; i < 2; ++i) {  // with and without padding
            const auto bytes = io::decoded_base64(coded, {});
            ASSERT_TRUE(bytes);
            EXPECT_EQ(std::string(reinterpret_cast<const char*>(bytes->data()), bytes->size()), text);
            coded.erase(std::min(coded.find('='), coded.size()));
        }
    }
}

TEST(GltfData, GlbIsKnownByItsContent) {
    GltfBuilder builder;
    builder.node({{"mesh", builder.triangle()}});
    const std::string glb = builder.glb();
    EXPECT_EQ(scene_of(glb).objects, 1u);
    EXPECT_EQ(scene_of(glb + "more").objects, 1u);
    EXPECT_EQ(
        scene_of(glb_of(glb.substr(12) + glb_chunk("XXXX", "") + glb_chunk(std::string_view("BIN\0", 4), ""))).objects,
        1u);
    EXPECT_EQ(scene_of(glb_of(glb_chunk("JSON", builder.text() + std::string(3, '\0')))).objects, 1u);
    EXPECT_EQ(scene_of("\xEF\xBB\xBF" + builder.text()).objects, 1u);
    const std::string size = std::to_string(glb.size());
    expect_part(refusal_of(glb.substr(0, glb.size() - 1)),
                "f.glb: is cut: a GLB file of " + std::to_string(glb.size() - 1) + " bytes, but it says that it has " +
                    size + "; copy it again");
    expect_part(refusal_of("glTF"), "f.glb: is cut: a GLB file of 4 bytes, but it says that it has 12; copy it again");
    std::string longer = glb;
    longer[12] = char(longer[12] + 100);
    expect_part(refusal_of(longer), "f.glb: is cut");
    expect_part(refusal_of(glb_of(glb_chunk("XXXX", "{}"))), "f.glb: the first chunk of the GLB file is not JSON");
    expect_part(refusal_of(glb_of("")), "f.glb: ");
    builder.root["buffers"][0]["byteLength"] = 36;
    expect_part(refusal_of(builder.root.dump()),
                "f.glb: buffers[0]: has no URI, and the file has no binary chunk for it");
    builder.root["bufferViews"][0]["buffer"] = 1;
    builder.root["buffers"].push_back({{"byteLength", 36}});
    expect_part(refusal_of(builder.glb()), "f.glb: buffers[1]: has no URI, and the file has no binary chunk for it");
    builder.root["buffers"][0]["byteLength"] = 41;
    EXPECT_EQ(refusal_of(""), "f.glb: is empty");
}

TEST(GltfData, JsonMayBeUnusual) {
    GltfBuilder builder;
    builder.node({{"name", "n\xC3\xBC"}, {"mesh", builder.triangle()}});
    json deep = 1;
    for (int i = 0; i < 300; ++i) deep = json::array({deep});
    builder.root["extras"] = deep;
    std::string text = builder.text();
    EXPECT_EQ(scene_of(text).names[0], "n\xC3\xBC");
    text.erase(text.find('\xC3'), 1);  // not UTF-8
    EXPECT_EQ(scene_of(text).names[0], "n\xEF\xBF\xBD");
    builder.root["accessors"][0]["count"] = 3.0;
    EXPECT_EQ(scene_of(builder).objects, 1u);
    expect_part(refusal_of("{\"asset\": 1, \"asset\": 2}"), "f.glb: the key 'asset' occurs twice in one object");
    expect_part(refusal_of("[]"), "f.glb: an array, not an object");
    expect_part(refusal_of("nonsense"), "f.glb: ");
    builder.root["nodes"] = json::object();
    expect_refusal(builder, "f.glb: nodes: an object, not an array");
}

TEST(GltfData, ASmallFileCannotFillTheMemory) {
    const auto refusal = [](const GltfBuilder& builder, const io::SceneContent& content) {
        return error_of(ErrorCode::resource_limit, [&] { (void)scene_of(builder.text(), content); });
    };
    GltfBuilder builder;
    const std::size_t mesh = builder.triangle();
    // Copies of a node, from an accessor without data.
    builder.add("accessors", {{"componentType", 5126}, {"count", 1 << 24}, {"type", "VEC3"}});
    builder.node(
        {{"mesh", mesh}, {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", 1}}}}}}}});
    expect_part(refusal(builder, {}), "f.glb: its content needs more than 4");
    builder.root["accessors"][1]["count"] = 1 << 14;  // with long names
    builder.root["nodes"][0]["name"] = std::string(1 << 20, 'x');
    expect_part(refusal(builder, {}), "f.glb: its content needs more than 4");
    // Nodes with the same mesh.
    builder = GltfBuilder();
    const std::size_t indices = builder.accessor(std::vector<std::uint8_t>(90000), uint8, "SCALAR");
    builder.mesh(builder.positions({0, 0, 0}), {{"indices", indices}});
    for (int i = 0; i < 7000; ++i) builder.node({{"mesh", 0}});
    expect_part(refusal(builder, {MeshObjects::triangle, false, {}}), "f.glb: its content needs more than 4");
}

TEST(GltfData, StopsSoon) {
    GltfBuilder builder;
    builder.node({{"mesh", builder.triangle()}});
    for (const std::size_t length : {0, 70000}) {  // stops after the JSON, and within it
        builder.root["extras"] = std::string(length, 'x');
        EXPECT_NE(error_of(ErrorCode::cancelled,
                           [&] { (void)io::parse_gltf_scene("f", as_buffer(builder.text()), {}, requested_stop()); }),
                  "");
    }
    EXPECT_NE(error_of(ErrorCode::cancelled, [&] { (void)io::decoded_base64("AAAA", requested_stop()); }), "");
}

}  // namespace
}  // namespace octopair::test
