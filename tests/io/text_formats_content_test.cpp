// Tests that faults of Assimp in OpenGEX and AC3D files are refused or told.
#include <gtest/gtest.h>

#include "io/imported_scene.hpp"

namespace octopair::test {
namespace {

using Texts = std::vector<std::string>;

std::string ogex_mesh(const std::string& indices = "{0, 1, 2}",
                      const std::string& properties = "(primitive = \"triangles\")") {
    return "GeometryObject $g\n{\nMesh " + properties +
           "\n{\nVertexArray (attrib = \"position\")\n{float[3] {{0, 0, 0}, {1, 0, 0}, "
           "{0, 2, 4}}}\nIndexArray\n{unsigned_int32[3] {" +
           indices + "}}\n}\n}\n";
}

std::string ogex_node(const std::string& parts) {
    return "GeometryNode $n\n{\nName {string {\"n\"}}\nObjectRef {ref {$g}}\n" + parts + "}\n";
}

const std::string ogex_transform = "Transform\n{float[16] {{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 10, 20, 30, 1}}}\n";

TEST(OpengexContent, WhatAssimpReadsRightlyIsAccepted) {
    const ImportedScene scene = import_text(".ogex", ogex_node(ogex_transform) + "/* a\n{ */\n" + ogex_mesh());
    EXPECT_EQ(boxes_named(scene, "n"), Texts{"10 20 30 11 22 34"});
    EXPECT_TRUE(scene.not_read.empty());
}

TEST(OpengexContent, NodesThatAreLeftOutAreCounted) {
    const ImportedScene scene = import_text(
        ".ogex", "Node $a\n{\n" + ogex_node("") + "}\n" + ogex_node(ogex_node("") + ogex_node("")) + ogex_mesh());
    EXPECT_EQ(scene.not_read, Texts{"geometry within other nodes (3)"});
}

TEST(OpengexContent, FaultsAreRefusedWithTheirLines) {
    const auto refusal = [](const std::string& text) { return refusal_of_text(".ogex", text); };
    EXPECT_EQ(refusal(ogex_node("Translation {float[3] {{1, 2, 3}}}\n") + ogex_mesh()),
              "line 5: Translation is not read; export the node with a Transform of 16 numbers");
    EXPECT_EQ(refusal(ogex_node(ogex_transform + ogex_transform) + ogex_mesh()),
              "line 7: a node with several transforms is read wrongly; export it with one");
    EXPECT_EQ(refusal(ogex_node("") + ogex_mesh("{0, 1, 3}")),
              "line 13: a face refers to vertex 3, but the mesh has 3 vertices");
    EXPECT_EQ(refusal(ogex_mesh("{0, 1, 2}}}\nIndexArray\n{unsigned_int32[3] {{0, 1, 2}")),
              "line 9: a mesh with several index arrays is read wrongly; export a mesh for each material");
    EXPECT_EQ(refusal(ogex_mesh("{0, 1, 2}", "(primitive = \"quads\")")),
              "line 3: only meshes of triangles are read; triangulate the model before the export");
    EXPECT_EQ(refusal(ogex_mesh("{0, 1, 0x02}")), "line 8: the index 0x02 is read wrongly; export decimal numbers");
    std::string quads = ogex_mesh("{0, 1, 2, 2}");
    quads.replace(quads.find("int32[3]"), 8, "int32[4]");
    EXPECT_EQ(refusal(quads),
              "line 8: only faces with three corners are read; triangulate the model before the export");
}

std::string ac_of(const std::string& head,
                  const std::string& surface = "SURF 0x20\nmat 0\nrefs 3\n0 0 0\n1 0 0\n2 0 0\n",
                  const std::string& kids = "kids 0\n") {
    return "AC3Db\nMATERIAL \"a\" rgb 1 1 1  amb 1 1 1  emis 0 0 0  spec 0 0 0  shi 0  trans 0\nOBJECT world\nkids "
           "1\nOBJECT poly\n"
           "name \"p\"\n" +
           head + "numvert 3\n0 0 0\n1 0 0\n0 2 4\nnumsurf 1\n" + surface + kids;
}

TEST(Ac3dContent, WhatAssimpReadsRightlyIsAccepted) {
    EXPECT_EQ(boxes_named(import_text(".ac", ac_of("loc 10 20 30\nrot 1 0 0 0 1 0 0 0 1\n")), "p"),
              Texts{"10 20 30 11 22 34"});
    EXPECT_EQ(boxes_named(import_text(".ac", ac_of("data 6\nab\ncd\n")), "p"), Texts{"0 0 0 1 2 4"});
}

TEST(Ac3dContent, LinesAreMovedToTheirPlaces) {
    const std::string lines = "SURF 0x22\nmat 0\nrefs 3\n0 0 0\n1 0 0\n2 0 0\n";
    EXPECT_EQ(import_text(".ac", ac_of("loc 10 20 30\n", lines, "kids 0\nkids 0\n")).objects.size(), 1u);
    EXPECT_EQ(boxes_named(
                  import_text(".ac", ac_of("loc 10 20 30\n", "SURF 0x22\nmat 0\nrefs 3\n0 0 0\n1 0 0\n2 0 0\n")), "p"),
              Texts{"10 20 30 11 22 34"});
}

TEST(Ac3dContent, FaultsAreRefusedWithTheirLines) {
    const auto refusal = [](const std::string& text) { return refusal_of_text(".ac", text); };
    EXPECT_EQ(refusal(ac_of("", "SURF 0x20\nmat 0\nrefs 3\n0 0 0\n1 0 0\n3 0 0\n")),
              "line 17: a surface refers to vertex 3, but the object has 3 vertices");
    EXPECT_EQ(refusal(ac_of("", "SURF 0x20\nmat 1\nrefs 0\n")),
              "line 13: a surface has material 1, but the file has 1 materials");
    EXPECT_EQ(refusal(ac_of("data 9\nkids 7\nxy\n")),
              "line 8: the data of an object begin with 'kids', which Assimp reads as the model; remove the data");
    EXPECT_EQ(
        refusal(ac_of("rot 0 1 0 -1 0 0 0 0 1\n")),
        "line 5: the place of an object with a rotation (rot) is read wrongly; export its vertices in their places");
    EXPECT_EQ(refusal(ac_of("loc 1 0 0\n", "SURF 0x20\nmat 0\nrefs 3\n0 0 0\n1 0 0\n2 0 0\n",
                            "kids 1\nOBJECT poly\nkids 0\n")),
              "line 5: the place of an object with children is read wrongly; export its vertices in their places");
}

TEST(IrrlichtContent, ScenesWithObjectsAreRefused) {
    const std::string scene =
        "<?xml version=\"1.0\"?>\n<irr_scene>\n<node type=\"empty\"/>\n<node type=\"cube\"/>\n<node "
        "type=\"mesh\"/></irr_scene>\n";
    EXPECT_EQ(refusal_of_text(".irr", scene),
              "line 4: Assimp reads none of the 2 objects of an Irrlicht scene; export glTF, OBJ or STL");
    EXPECT_EQ(refusal_of_text(".irr", "<irr_scene>\n<node></irr_scene>"),
              "line 2: is not well-formed XML (mismatched tag); export the file again");
    EXPECT_EQ(import_text(".irr", "<irr_scene><node type='empty'/></irr_scene>").objects.size(), 0u);
}

TEST(OpengexContent, UncommonFaultsAreRefused) {
    std::string object_only = ogex_transform;
    object_only.replace(0, 9, "Transform (object = true)");
    EXPECT_EQ(refusal_of_text(".ogex", ogex_node(object_only) + ogex_mesh()),
              "line 5: a transform of an object alone is read wrongly; apply it before the export");
    const std::string mesh = ogex_mesh();
    const std::size_t begin = mesh.find("IndexArray");
    EXPECT_EQ(refusal_of_text(".ogex", mesh.substr(0, begin) + "}\n}\n"),
              "line 3: a mesh without an index array is not read; export it with one");
}

TEST(Ac3dContent, NumbersAreNumbers) {
    EXPECT_EQ(refusal_of_text(".ac", ac_of("", "SURF 0x20\nmat x\n")),
              "line 13: 'x' is in the place of a whole number");
}

}  // namespace
}  // namespace octopair::test
