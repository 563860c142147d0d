// Tests that DXF files are read as the format says, wherever Assimp alone reads them wrongly.
#include <gtest/gtest.h>

#include <algorithm>

#include "io/imported_scene.hpp"

namespace octopair::test {
namespace {

using Texts = std::vector<std::string>;

/// A triangle with the corners 0 0 0, 1 0 0 and 0 2 4.
const std::string one_face =
    "0\n3DFACE\n8\nL\n10\n0\n20\n0\n30\n0\n11\n1\n21\n0\n31\n0\n12\n0\n22\n2\n32\n4\n13\n0\n23\n2\n33\n4\n";

std::string dxf_section(const std::string& name, const std::string& content) {
    return "0\nSECTION\n2\n" + name + "\n" + content + "0\nENDSEC\n";
}

std::string dxf_block(const std::string& name, const std::string& content, const std::string& base = "0") {
    return "0\nBLOCK\n8\n0\n2\n" + name + "\n70\n0\n10\n" + base + "\n20\n" + base + "\n30\n" + base + "\n" + content +
           "0\nENDBLK\n8\n0\n";
}

std::string dxf_insert(const std::string& block, const std::string& groups) {
    return "0\nINSERT\n8\nL\n2\n" + block + "\n" + groups;
}

ImportedScene read_dxf(const std::string& entities, const std::string& blocks = "") {
    return import_text(".dxf", dxf_section("BLOCKS", blocks) + dxf_section("ENTITIES", entities) + "0\nEOF\n");
}

std::string box_in_dxf(const std::string& entities, const std::string& blocks = "") {
    return boxes_named(read_dxf(entities, blocks), "<DXF_ROOT>").at(0);
}

const std::string at_10_20_30 = "10\n10\n20\n20\n30\n30\n";

/// Returns the box of a block with one face that is inserted at 10 20 30.
std::string inserted(const std::string& groups, const std::string& base = "0") {
    return box_in_dxf(dxf_insert("A", at_10_20_30 + groups), dxf_block("A", one_face, base));
}

TEST(DxfContent, BlocksAreInserted) {
    EXPECT_EQ(inserted(""), "10 20 30 11 22 34");
    EXPECT_EQ(inserted("41\n+1\n50\n360.0\n70\n1\n71\n1\n210\n0\n220\n0\n230\n1\n"), "10 20 30 11 22 34");
    EXPECT_EQ(inserted("", "1"), "9 19 29 10 21 33") << "a base";
    EXPECT_EQ(inserted("41\n2\n42\n3\n43\n-1\n", "1"), "8 17 27 10 23 31") << "a base and scales";
    EXPECT_EQ(inserted("50\n90\n"), "8 20 30 10 21 34") << "a quarter turn";
    EXPECT_EQ(inserted("50\n+90\n41\n1,5\n"), "8 20 30 10 21.5 34") << "a sign, and a comma as decimal point";
    EXPECT_EQ(inserted("70\n3\n44\n5\n71\n2\n45\n7\n"), "10 20 30 21 29 34") << "columns and rows";
    EXPECT_EQ(inserted("210\n0\n220\n0\n230\n-1\n"), "-11 20 -34 -10 22 -30") << "a direction of extrusion";
}

TEST(DxfContent, BlocksInBlocksAreInserted) {
    const std::string blocks = dxf_block("A", one_face) + dxf_block("B", dxf_insert("A", "10\n1\n50\n90\n") +
                                                                             "0\nCIRCLE\n10\n5\n40\n2\n" + one_face);
    EXPECT_EQ(box_in_dxf(dxf_insert("B", at_10_20_30), blocks), "9 20 30 11 22 34");
    EXPECT_EQ(refusal_of_text(".dxf", dxf_section("BLOCKS", dxf_block("A", dxf_insert("A", "10\n0\n"))) +
                                          dxf_section("ENTITIES", dxf_insert("A", "10\n0\n"))),
              "line 20: the block 'A' is inserted in itself");
}

TEST(DxfContent, AllLineEndsAreUnderstood) {
    std::string text = dxf_section("ENTITIES", one_face) + "0\nEOF\n";
    std::replace(text.begin(), text.end(), '\n', '\r');
    EXPECT_EQ(boxes_named(import_text(".dxf", text), "<DXF_ROOT>"), Texts{"0 0 0 1 2 4"});
}

TEST(DxfContent, PolylinesAreRead) {
    const auto vertex = [](int x, int y, int z, const std::string& groups = "") {
        return fmt::format("0\nVERTEX\n8\nL\n10\n{}\n20\n{}\n30\n{}\n{}", x, y, z, groups);
    };
    const std::string three = vertex(0, 0, 0) + vertex(5, 0, 0) + vertex(5, 7, 0) + "0\nSEQEND\n";
    EXPECT_EQ(box_in_dxf("0\nPOLYLINE\n8\nL\n70\n8\n" + three), "0 0 0 5 7 0") << "the last vertex of three";
    EXPECT_EQ(box_in_dxf("0\nPOLYLINE\n8\nL\n70\n0\n210\n0\n220\n0\n230\n-1\n" + three), "-5 0 0 0 7 0");
    EXPECT_EQ(box_in_dxf("0\nPOLYLINE\n8\nL\n70\n0\n39\n2.5\n" + three), "0 0 0 5 7 2.5") << "a thickness";
    EXPECT_EQ(box_in_dxf("0\nPOLYLINE\n8\nM\n70\n0\n0\nSEQEND\n" + one_face), "0 0 0 1 2 4") << "no vertex";
    const std::string grid = "0\nPOLYLINE\n8\nL\n70\n16\n71\n2\n72\n2\n" + vertex(0, 0, 0) + vertex(1, 0, 0) +
                             vertex(0, 2, 0) + vertex(1, 2, 3) + "0\nSEQEND\n";
    EXPECT_EQ(box_in_dxf(grid), "0 0 0 1 2 3");
    const std::string corners =
        vertex(0, 0, 0, "70\n192\n") + vertex(1, 0, 0, "70\n192\n") + vertex(0, 2, 4, "70\n192\n");
    const auto mesh = [&](int last) {
        return "0\nPOLYLINE\n8\nL\n70\n64\n71\n3\n72\n1\n" + corners +
               fmt::format("0\nVERTEX\n8\nL\n10\n0\n70\n128\n71\n1\n72\n-2\n73\n{}\n0\nSEQEND\n", last);
    };
    EXPECT_EQ(box_in_dxf(mesh(3)), "0 0 0 1 2 4") << "a corner after an invisible edge";
    EXPECT_EQ(refusal_of_text(".dxf", dxf_section("ENTITIES", mesh(4))),
              "line 52: a face refers to vertex 4, but the mesh has 3 vertices");
}

TEST(DxfContent, TextsWithBracesDoNotSwallowTheModel) {
    EXPECT_EQ(box_in_dxf("0\nMTEXT\n1\n{\\fArial;text\n" + one_face), "0 0 0 1 2 4");
    EXPECT_EQ(box_in_dxf("0\nCIRCLE\n102\n{ACAD_REACTORS\n330\n1\n102\n}\n" + one_face), "0 0 0 1 2 4");
}

TEST(DxfContent, ThePaperIsLeftOut) {
    std::string on_paper = one_face;
    on_paper.replace(on_paper.find("8\nL\n"), 4, "67\n1\n8\nP\n");
    const ImportedScene scene =
        read_dxf(on_paper + one_face + dxf_insert("A", "67\n1\n10\n50\n"), dxf_block("A", one_face));
    EXPECT_EQ(scene.objects.size(), 1u);
    EXPECT_EQ(scene.not_read, Texts{"entities of the paper space (2)"});
}

TEST(DxfContent, WhatIsLostIsCounted) {
    EXPECT_TRUE(read_dxf(one_face).not_read.empty());
    const std::string solids = "0\n3DSOLID\n8\n0\n0\n3DSOLID\n8\n0\n0\nMESH\n8\n0\n";
    const ImportedScene scene = read_dxf(one_face + solids + dxf_insert("none", "10\n0\n"));
    EXPECT_EQ(scene.not_read, (Texts{"entities of type 3DSOLID (2)", "entities of type MESH (1)",
                                     "inserts of block 'none', which the file does not have (1)"}));
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_TRUE(has_text(scene.warnings[0], ": Assimp does not read entities of type 3DSOLID (2), "));
    // A circle is a curve, but with a thickness it is the wall of a cylinder.
    const std::string circle = "0\nCIRCLE\n8\n0\n10\n0\n20\n0\n30\n0\n40\n50\n";
    EXPECT_TRUE(read_dxf(one_face + circle).not_read.empty());
    EXPECT_EQ(read_dxf(one_face + circle + "39\n3\n").not_read, Texts{"entities of type CIRCLE (1)"});
    EXPECT_EQ(import_text(".dxf", dxf_section("ENTITIES", one_face)).not_read,
              Texts{"what may follow the last section: the file has no EOF (1)"});
}

TEST(DxfContent, FaultsAreRefused) {
    EXPECT_EQ(refusal_of_text(".dxf", "0\nSECTION\n2\nENTITIES\n" + one_face),
              "is cut: the section ENTITIES has no ENDSEC; export the file again");
    std::string wrong = one_face;
    wrong.replace(wrong.find("10\n0\n"), 5, "10\nx\n");
    EXPECT_EQ(refusal_of_text(".dxf", dxf_section("ENTITIES", wrong)),
              "line 6: 3DFACE has 'x' as group 10, which is no number");
    for (const std::string text :
         {"\n", "0", "0\nSECTION\n2\nBLOCKS\n10\n1\n", "0\nSECTION\n2\nENTITIES\n0\nINSERT", "x\ny\nz\n"})
        EXPECT_NE(refusal_of_text(".dxf", text), "") << text;
}

TEST(DxfContent, LayersAreObjects) {
    std::string other = one_face;
    other.replace(other.find("8\nL\n"), 4, "8\n{M\n");
    const ImportedScene scene = read_dxf(one_face + other + one_face);
    EXPECT_EQ(boxes_named(scene, "L"), Texts{"0 0 0 1 2 4"});
    EXPECT_EQ(boxes_named(scene, "(M"), Texts{"0 0 0 1 2 4"});
}

TEST(DxfContent, UncommonFaultsAreRefused) {
    const auto refusal = [](const std::string& entities, const std::string& blocks = "") {
        return refusal_of_text(".dxf", dxf_section("BLOCKS", blocks) + dxf_section("ENTITIES", entities) + "0\nEOF\n");
    };
    EXPECT_EQ(refusal("0\nPOLYLINE\n70\n16\n71\n2\n72\n2\n0\nVERTEX\n10\n0\n0\nSEQEND\n"),
              "line 12: the mesh has 1 points in place of 2 times 2");
    EXPECT_EQ(refusal(dxf_insert("A", "70\n1e10\n"), dxf_block("A", one_face)),
              "line 58: INSERT has '1e10' as group 70, which is too large");
    EXPECT_EQ(refusal(dxf_insert("A", "70\n4000\n71\n4000\n"), dxf_block("A", "")),
              "line 30: more than 10000000 blocks are inserted");
}

TEST(DxfContent, ArcsAndReferencesAreCounted) {
    const std::string arc =
        "0\nPOLYLINE\n8\nL\n70\n8\n0\nVERTEX\n10\n0\n20\n0\n42\n1\n0\nVERTEX\n10\n4\n20\n0\n0\nSEQEND\n";
    std::string external = dxf_block("A", "");
    external.replace(external.find("70\n0\n"), 5, "70\n4\n");
    EXPECT_EQ(
        read_dxf(arc + dxf_insert("A", "10\n0\n"), external).not_read,
        (Texts{"arcs of lines, which are read as straight (1)", "blocks in other files (external references) (1)"}));
}

}  // namespace
}  // namespace octopair::test
