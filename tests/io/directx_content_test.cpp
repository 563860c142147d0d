// Tests that DirectX files are read as the format says, wherever Assimp alone reads them wrongly.
#include <gtest/gtest.h>

#include "io/imported_scene.hpp"

namespace octopair::test {
namespace {

using Texts = std::vector<std::string>;

std::string x_of(const std::string& objects) { return "xof 0303txt 0032\n" + objects; }

/// A tetrahedron with the points 0 0 0, 1 0 0, 0 2 0 and 0 0 4.
std::string x_mesh(const std::string& parts = "", const std::string& faces = "2;\n3;0,1,2;,\n3;0,1,3;;\n") {
    return "Mesh {\n4;\n0.0;0.0;0.0;,\n1.0;0.0;0.0;,\n0.0;2.0;0.0;,\n0.0;0.0;4.0;;\n" + faces + parts + "}\n";
}

std::string x_frame(const std::string& name, const std::string& content, int x = 0) {
    return fmt::format("Frame {} {{\nFrameTransformMatrix {{ 1,0,0,0, 0,1,0,0,0,0,1,0,{},0,0,1;; }}\n{}}}\n", name, x,
                       content);
}

ImportedScene read_x(const std::string& objects) { return import_text(".x", x_of(objects)); }
std::string refusal_of_x(const std::string& objects) { return refusal_of_text(".x", x_of(objects)); }

TEST(DirectxContent, MatricesOfWholeNumbersAreRead) {
    const ImportedScene scene = read_x(x_frame("A", x_mesh() + x_frame("B", x_mesh(), 100), 10));
    EXPECT_EQ(boxes_named(scene, "A"), Texts{"10 0 0 11 2 4"});
    EXPECT_EQ(boxes_named(scene, "B"), Texts{"110 0 0 111 2 4"});
}

TEST(DirectxContent, MeshesOutsideFramesStayWhereTheyAre) {
    const ImportedScene scene = read_x(x_frame("A", x_mesh(), 10) + x_mesh());
    EXPECT_EQ(boxes_named(scene, "A"), Texts{"10 0 0 11 2 4"});
    EXPECT_EQ(boxes_named(scene, "$dummy_root"), Texts{"0 0 0 1 2 4"});
}

TEST(DirectxContent, FramesInUnnamedFramesAreRead) {
    const ImportedScene scene = read_x(x_frame("A", x_frame("", x_mesh() + x_frame("B", x_mesh(), 5), 10)));
    EXPECT_EQ(scene.objects.size(), 2u);
    EXPECT_EQ(boxes_named(scene, "B"), Texts{"15 0 0 16 2 4"});
    EXPECT_EQ(boxes_named(read_x(x_frame("A", x_frame("", x_mesh(), 10), 20)), "A"), Texts{"30 0 0 31 2 4"});
}

TEST(DirectxContent, CommasOfDecimalsAndOfListsAreRead) {
    std::string mesh = x_mesh();
    mesh.replace(mesh.find("1.0;0.0;0.0"), 11, "1,5;0,0;0,0");
    EXPECT_EQ(boxes_named(read_x(x_frame("A", mesh)), "A"), Texts{"0 0 0 1.5 2 4"});
}

TEST(DirectxContent, WhatIsNotReadIsCounted) {
    const ImportedScene scene =
        read_x("template Mesh { <3D82AB44-62DA-11cf-AB39-0020AF71E433> DWORD nVertices; [...] }\n" +
               x_frame("A", x_mesh("XSkinMeshHeader { 1; 1; 1; }\n") + "Group { Frame B { " + x_mesh() + "} }\n"));
    EXPECT_EQ(scene.not_read, (Texts{"deformations of skins (1)", "objects of type Group (1)"}));
    EXPECT_EQ(scene.objects.size(), 1u);
}

TEST(DirectxContent, FaultsAreRefusedWithTheirLines) {
    EXPECT_EQ(refusal_of_x(x_mesh("", "1;\n3;0,1,4;;\n")),
              "line 9: a face refers to vertex 4, but the mesh has 4 vertices");
    EXPECT_EQ(refusal_of_x(x_frame("A", "{ B }\n")),
              "line 4: the reference to 'B' is not read; export the object in its place");
    EXPECT_EQ(refusal_of_x(x_mesh("{ B }\n")),
              "line 11: a reference in a mesh is not read; export the object in its place");
    const std::string list = "MeshMaterialList {\n2;\n2;\n0,1;;\nMaterial { 1;1;1;1;; 1; 0;0;0;; 0;0;0;; }\n}\n";
    EXPECT_EQ(refusal_of_x(x_mesh(list)),
              "line 14: a face has material 1, but the mesh has 1 materials; its faces would be lost");
    EXPECT_EQ(refusal_of_x("Frame A {\n" + x_mesh()), "line 2: the frame does not end: the file is cut");
    EXPECT_EQ(refusal_of_x("Mesh {\n4;\n0.0;0.0;0.0;\n}"), "line 5: '}' is in the place of a number");
    const std::string named = "Material M { 1;1;1;1;; 1; 0;0;0;; 0;0;0;; }\n";
    EXPECT_EQ(read_x(named + x_frame("A", x_mesh("MeshMaterialList { 1; 2; 0,0;; { M } }\n"))).objects.size(), 1u);
}

TEST(DirectxContent, UncommonFaultsAreRefused) {
    EXPECT_NE(refusal_of_text(".x", "xof 03"), "");
    EXPECT_EQ(refusal_of_x("Mesh a b {\n"), "line 2: 'Mesh' without a brace");
    EXPECT_EQ(refusal_of_x("Frame {\nFrameTransformMatrix {\n1,0"), "line 4: the matrix does not end");
    EXPECT_EQ(refusal_of_x(x_mesh().substr(0, x_mesh().size() - 2)), "line 11: the mesh does not end: the file is cut");
    EXPECT_EQ(refusal_of_x(x_mesh("MeshMaterialList {\n1;\n1;\n0;;\n").substr(0, 100)).substr(0, 5), "line ");
    EXPECT_EQ(refusal_of_x("Other {\n{"), "line 2: 'Other' does not end: the file is cut");
    EXPECT_EQ(refusal_of_x("Mesh {\n1.5;"), "line 3: 1.5 is in the place of a whole number");
    const std::string cut_list = x_mesh("MeshMaterialList { 1; 1; 0;;\n");
    EXPECT_EQ(refusal_of_x(cut_list.substr(0, cut_list.size() - 2)),
              "line 12: the list of materials does not end: the file is cut");
    std::string deep;
    for (int i = 0; i < 1001; ++i) deep += "Frame {";
    EXPECT_EQ(refusal_of_x(deep), "line 2: more than 1000 frames are nested");
}

}  // namespace
}  // namespace octopair::test
