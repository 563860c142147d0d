// Tests that AMF files are read as the format says, wherever Assimp alone reads them wrongly.
#include <gtest/gtest.h>

#include "io/imported_scene.hpp"

namespace octopair::test {
namespace {

using Texts = std::vector<std::string>;

std::string amf_vertex(const std::string& x, const std::string& y, const std::string& z) {
    return "<vertex><coordinates><x>" + x + "</x><y>" + y + "</y><z>" + z + "</z></coordinates></vertex>";
}

std::string amf_triangle(int a, int b, int c) {
    return fmt::format("<triangle><v1>{}</v1><v2>{}</v2><v3>{}</v3></triangle>", a, b, c);
}

const std::string amf_vertices = "<vertices>" + amf_vertex("0", "0", "0") + amf_vertex("1", "0", "0") +
                                 amf_vertex("0", "2", "0") + amf_vertex("0", "0", "4") + "</vertices>";

std::string amf_object(const std::string& id, const std::string& volumes) {
    return "<object" + (id.empty() ? "" : " id='" + id + "'") + "><mesh>" + amf_vertices + volumes + "</mesh></object>";
}

std::string amf_of(const std::string& objects) { return "<amf unit='millimeter'>\n" + objects + "\n</amf>"; }

const std::string first_volume = "<volume materialid='7'>" + amf_triangle(0, 1, 2) + "</volume>";

TEST(AmfContent, AllVolumesOfAnObjectAreRead) {
    const std::string volumes = first_volume + "<volume>" + amf_triangle(0, 1, 3) + "</volume>";
    const ImportedScene scene = import_text(".amf", amf_of(amf_object("1", volumes) + amf_object("2", first_volume)));
    EXPECT_EQ(boxes_named(scene, "1"), Texts{"0 0 0 1 2 4"});
    EXPECT_EQ(boxes_named(scene, "2"), Texts{"0 0 0 1 2 0"});
}

TEST(AmfContent, AllMeshesOfAnObjectAreRead) {
    const std::string second = "</mesh><mesh><vertices>" + amf_vertex("5", "5", "5") + amf_vertex("6", "5", "5") +
                               amf_vertex("5", "8", "5") + "</vertices>" + first_volume;
    EXPECT_EQ(boxes_named(import_text(".amf", amf_of(amf_object("1", first_volume + second))), "1"),
              Texts{"0 0 0 6 8 5"});
}

TEST(AmfContent, InstancesAreMoved) {
    const std::string constellation =
        "<constellation id='9'><instance objectid='1'><deltax>10</deltax><rz>0</rz></instance>"
        "<instance objectid='1'><deltay>-2.5</deltay></instance></constellation>";
    const ImportedScene scene = import_text(".amf", amf_of(amf_object("1", first_volume) + constellation));
    EXPECT_EQ(boxes_named(scene, "1"), (Texts{"10 0 0 11 2 0", "0 -2.5 0 1 -0.5 0"}));
}

TEST(AmfContent, FaultsAreRefusedWithTheirLines) {
    const auto refusal = [](const std::string& objects) { return refusal_of_text(".amf", amf_of(objects)); };
    std::string comma = amf_object("1", first_volume);
    comma.replace(comma.find("<x>1</x>"), 8, "<x>0,5</x>");
    EXPECT_EQ(refusal(comma), "line 2: <x> is '0,5', which is no number; decimals are written with a point");
    EXPECT_EQ(refusal(amf_object("1", "<volume>" + amf_triangle(0, 1, 4) + "</volume>")),
              "line 2: <v3> is 4, but the object has 4 vertices");
    EXPECT_EQ(refusal(amf_object("1", "") + "\n" + amf_object("1", "")),
              "line 3: the id '1' is that of line 2, too; give each object an id");
    EXPECT_EQ(refusal(amf_object("", "") + "\n" + amf_object("", "")),
              "line 3: has no id, as in line 2; give each object an id");
    EXPECT_EQ(refusal("<object id='1'><mesh><vertices>\n<vertex/></vertices></mesh></object>"),
              "line 3: has no <coordinates>");
    EXPECT_EQ(refusal(amf_object("1", first_volume) + "<constellation id='2'><instance objectid='3'/></constellation>"),
              "line 2: the object '3' is not in the file");
    EXPECT_EQ(refusal(amf_object("1", first_volume) +
                      "<constellation id='2'><instance objectid='1'><rx>45</rx></instance></constellation>"),
              "line 2: an instance is rotated (<rx>), which Assimp reads wrongly; export it as STL, OBJ or 3MF");
    const auto placed = [&](const std::string& how) {
        return amf_object("1", first_volume) + "<constellation id='2'><instance objectid='1'>" + how +
               "</instance></constellation>";
    };
    EXPECT_EQ(refusal(placed("<scalex>1</scalex><scale>2</scale>")),
              "line 2: an instance is scaled (<scale>), which Assimp does not read; export it as STL, OBJ or 3MF");
    EXPECT_EQ(refusal(placed("<mirrory>0</mirrory><mirrorx>1</mirrorx>")),
              "line 2: an instance is mirrored (<mirrorx>), which Assimp does not read; export it as STL, OBJ or 3MF");
    EXPECT_EQ(refusal_of_text(".amf", "<amf>\n<object></amf>"),
              "line 2: is not well-formed XML (mismatched tag); export the file again");
}

TEST(AmfContent, OneObjectNeedsNoId) {
    EXPECT_EQ(import_text(".amf", amf_of(amf_object("", first_volume))).objects.size(), 1u);
}

TEST(AmfContent, UncommonFaultsAreRefused) {
    EXPECT_EQ(refusal_of_text(".amf", "<object/>"), "has no element <amf>, which AMF files have");
    EXPECT_EQ(refusal_of_text(".amf", amf_of(amf_object("1", "<volume><triangle><v1>0</v1></triangle></volume>"))),
              "line 2: has no <v2>");
}

TEST(AmfContent, CurvesAreCounted) {
    std::string curved = amf_object("1", first_volume);
    curved.replace(curved.find("</coordinates>"), 14, "</coordinates><normal/>");
    curved.replace(curved.find("</vertices>"), 11, "<edge/></vertices>");
    EXPECT_EQ(import_text(".amf", amf_of(curved)).not_read,
              (Texts{"edges, which curve triangles (1)", "normals, which curve triangles (1)"}));
}

}  // namespace
}  // namespace octopair::test
