// Tests which parts of a DXF file are found to be read wrongly, or not at all.
#include "io/meshes/dxf_content.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "io/meshes/mesh_reader.hpp"
#include "io/temporary.hpp"

namespace octopair::test {
namespace {

const std::string one_face =
    "0\n3DFACE\n8\n0\n10\n0\n20\n0\n30\n0\n11\n1\n21\n0\n31\n0\n12\n0\n22\n2\n32\n4\n13\n0\n23\n2\n33\n4\n";

std::string dxf_section(const std::string& name, const std::string& content) {
    return "0\nSECTION\n2\n" + name + "\n" + content + "0\nENDSEC\n";
}

/// A file with a block A, whose base is `base` on each axis, and an insert of A at 10, 20, 30 with further groups.
std::string dxf_with_insert(const std::string& groups, const std::string& content = one_face,
                            const std::string& base = "0") {
    const std::string block = "0\nBLOCK\n8\n0\n2\nA\n70\n0\n10\n" + base + "\n20\n" + base + "\n30\n" + base + "\n" +
                              content + "0\nENDBLK\n8\n0\n";
    return dxf_section("BLOCKS", block) +
           dxf_section("ENTITIES", "0\nINSERT\n8\n0\n2\nA\n10\n10\n20\n20\n30\n30\n" + groups) + "0\nEOF\n";
}

std::string wrong_in(const std::string& text) { return io::find_dxf_faults(text).wrong; }
std::vector<std::string> lost_in(const std::string& text) { return io::find_dxf_faults(text).lost; }

TEST(DxfContent, InsertsThatAssimpPlacesRightlyAreAccepted) {
    for (const std::string groups :
         {"", "41\n1\n42\n1\n43\n1\n50\n0\n", "50\n360.0\n", "70\n1\n71\n1\n", "210\n0\n220\n0\n230\n1\n"})
        EXPECT_EQ(wrong_in(dxf_with_insert(groups)), "") << groups;
    EXPECT_EQ(wrong_in(dxf_with_insert("", one_face, "1")), "");
    EXPECT_EQ(wrong_in(dxf_with_insert("10\n0\n20\n0\n30\n0\n41\n2\n42\n3\n43\n5\n")), "") << "a scale at the origin";
    const std::string line = "0\nCIRCLE\n40\n2\n";
    EXPECT_EQ(wrong_in(dxf_with_insert("50\n90\n", line)), "") << "a block without anything that is read";
}

TEST(DxfContent, InsertsThatAssimpPlacesWronglyAreFound) {
    for (const std::string groups :
         {"41\n2\n", "43\n-1\n", "50\n90\n", "70\n3\n", "71\n2\n", "210\n0\n220\n0\n230\n-1\n"})
        EXPECT_NE(wrong_in(dxf_with_insert(groups)), "") << groups;
    EXPECT_NE(wrong_in(dxf_with_insert("", one_face + "0\nCIRCLE\n10\n5\n20\n0\n30\n0\n40\n2\n")), "")
        << "Assimp takes the middle of the circle for the base of the block";
    EXPECT_EQ(wrong_in(dxf_with_insert("50\n90\n")).substr(0, 8), "line 57:");
}

TEST(DxfContent, NumbersAndLineEndsOfAllSpellingsAreUnderstood) {
    for (const std::string groups : {"50\n+90\n", "70\n+3\n", "41\n1,5\n", "10\n+20.0\n41\n2\n"})
        EXPECT_NE(wrong_in(dxf_with_insert(groups)), "") << groups;
    EXPECT_EQ(wrong_in(dxf_with_insert("41\n+1\n50\n+0\n")), "");
    std::string text = dxf_with_insert("50\n90\n");
    std::replace(text.begin(), text.end(), '\n', '\r');
    EXPECT_NE(wrong_in(text), "");
    EXPECT_EQ(lost_in(dxf_section("ENTITIES", "0\nINSERT\n2\na\n")).size(), 1u) << "a block that is missing";
}

TEST(DxfContent, WhatIsLostIsCounted) {
    EXPECT_TRUE(lost_in(dxf_with_insert("")).empty());
    const std::string solids = "0\n3DSOLID\n8\n0\n0\n3DSOLID\n8\n0\n0\nMESH\n8\n0\n";
    EXPECT_EQ(lost_in(dxf_section("ENTITIES", one_face + solids)),
              (std::vector<std::string>{"entities of type 3DSOLID (2)", "entities of type MESH (1)"}));
    EXPECT_EQ(lost_in(dxf_with_insert("", "0\nINSERT\n2\nB\n" + one_face)),
              std::vector<std::string>{"entities of block 'A' (2)"});
    EXPECT_EQ(lost_in(dxf_with_insert("", one_face + "0\nATTDEF\n2\nTAG\n")),
              std::vector<std::string>{"inserts of block 'A' (1)"});
    EXPECT_EQ(lost_in(dxf_section("ENTITIES", "0\nPOLYLINE\n70\n16\n")),
              std::vector<std::string>{"meshes of M x N points (POLYLINE) (1)"});
    EXPECT_EQ(lost_in(dxf_section("ENTITIES", "0\nVERTEX\n70\n128\n71\n1\n72\n-2\n73\n3\n")),
              std::vector<std::string>{"corners of polyface meshes, after invisible edges (1)"});
}

TEST(DxfContent, AnyTextIsAccepted) {
    for (const std::string text :
         {"", "\n", "0", "0\nSECTION\n2\nBLOCKS\n10\n1\n", "0\nSECTION\n2\nENTITIES\n0\nINSERT", "x\ny\nz\n"}) {
        EXPECT_EQ(wrong_in(text), "") << text;
    }
}

TEST(DxfContent, TheReaderRefusesOrWarns) {
    const TemporaryDirectory directory;
    const std::string path = directory.file("a.dxf");
    write_file(path, dxf_with_insert("41\n2\n"));
    EXPECT_EQ(
        error_of(ErrorCode::bad_input, [&] { (void)io::read_mesh_scene(path, {io::MeshObjects::node}); }),
        path +
            ": line 57: the block 'A' is inserted with a scale, a rotation, a base or copies, which Assimp places "
            "wrongly; explode the blocks (EXPLODE), or export glTF, OBJ or STL");
    write_file(path, dxf_section("ENTITIES", one_face + "0\n3DSOLID\n8\n0\n") + "0\nEOF\n");
    const io::LoadedScene scene = io::read_mesh_scene(path, {io::MeshObjects::node});
    ASSERT_EQ(scene.warnings.size(), 2u);
    EXPECT_EQ(scene.warnings[1],
              path + ": Assimp does not read entities of type 3DSOLID (1); export the model as glTF, OBJ or STL");
    const auto& boxes = std::get<Buffer<Box3d>>(scene.boxes);
    ASSERT_EQ(boxes.size(), 1u);
    EXPECT_EQ(boxes[0].max[1], 2);
    EXPECT_EQ(boxes[0].max[2], 4) << "z of the file stays z";
}

}  // namespace
}  // namespace octopair::test
