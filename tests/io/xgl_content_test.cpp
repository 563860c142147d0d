// Tests that XGL files are read as the format says, wherever Assimp alone reads them wrongly.
#include <gtest/gtest.h>

#include "io/imported_scene.hpp"

namespace octopair::test {
namespace {

using Texts = std::vector<std::string>;

/// A mesh with the corners 0 0 0, 1 0 0 and 0 2 4.
std::string xgl_mesh(const std::string& attributes = "", const std::string& last = "9") {
    return "<MESH" + attributes + "><MAT ID='1'/><P ID='7'>0,0,0</P><P ID='8'>1,0,0</P><P ID='9'>0,2,4</P>" +
           "<F><MATREF>1</MATREF><FV1><PREF>7</PREF></FV1><FV2><PREF>8</PREF></FV2><FV3><PREF>" + last +
           "</PREF></FV3></F></MESH>";
}

std::string xgl_transform(const std::string& forward, const std::string& up, const std::string& position,
                          const std::string& scale) {
    return "<TRANSFORM><FORWARD>" + forward + "</FORWARD><UP>" + up + "</UP><POSITION>" + position +
           "</POSITION><SCALE>" + scale + "</SCALE></TRANSFORM>";
}

std::string xgl_of(const std::string& content) { return "<?xml version='1.0'?>\n<WORLD>\n" + content + "\n</WORLD>"; }

/// Returns the boxes of all objects, in the order of their names.
Texts boxes_in_xgl(const std::string& content) {
    Texts texts;
    for (const auto& [name, box] : import_text(".xgl", xgl_of(content)).objects) texts.push_back(text_of_box(box));
    return texts;
}

TEST(XglContent, TransformsAreApplied) {
    const auto pose = [](const std::string& transform) {
        return boxes_in_xgl("<OBJECT>" + transform + xgl_mesh() + "</OBJECT>").at(0);
    };
    EXPECT_EQ(pose(""), "0 0 0 1 2 4");
    EXPECT_EQ(pose(xgl_transform("0,0,1", "0,1,0", "10,20,30", "1")), "10 20 30 11 22 34");
    EXPECT_EQ(pose(xgl_transform("0,0,5", "0,3,0", "0,0,0", "2")), "0 0 0 2 4 8");
    EXPECT_EQ(pose(xgl_transform("1,0,0", "0,1,0", "0,0,0", "1")), "0 0 -1 4 2 0") << "x is UP times FORWARD";
    EXPECT_EQ(pose(xgl_transform("0, 0, -1", "0, 1, 0", "0, 0, 0", "1")), "-1 0 -4 0 2 0");
}

TEST(XglContent, ReferencesArePlaced) {
    const std::string moved = xgl_transform("0,0,1", "0,1,0", "10,0,0", "1");
    EXPECT_EQ(boxes_in_xgl(xgl_mesh(" ID='5'") + "<OBJECT>" + moved + "<MESHREF>5</MESHREF><OBJECT>" + moved +
                           "<MESHREF>5</MESHREF></OBJECT></OBJECT>"),
              (Texts{"10 0 0 11 2 4", "20 0 0 21 2 4"}));
    EXPECT_EQ(boxes_in_xgl("<OBJECT ID='6'>" + xgl_mesh() + "</OBJECT><OBJECT>" + moved +
                           "<OBJECTREF>6</OBJECTREF></OBJECT>"),
              Texts{"10 0 0 11 2 4"});
}

TEST(XglContent, FaultsAreRefusedWithTheirLines) {
    const auto refusal = [](const std::string& content) { return refusal_of_text(".xgl", xgl_of(content)); };
    EXPECT_EQ(refusal(xgl_mesh("", "3")), "line 3: the point '3' is not in the mesh");
    EXPECT_EQ(refusal("<OBJECT><MESHREF>3</MESHREF></OBJECT>"),
              "line 3: <MESHREF> refers to '3', which is not in the file");
    EXPECT_EQ(refusal("<OBJECT ID='1'><OBJECT><OBJECTREF>1</OBJECTREF></OBJECT></OBJECT><OBJECTREF>1</OBJECTREF>"),
              "line 3: the object refers to itself");
    EXPECT_EQ(refusal("<OBJECT>" + xgl_transform("0,0,1", "0,1,1", "0,0,0", "1") + "</OBJECT>"),
              "line 3: the directions FORWARD and UP are not perpendicular");
    EXPECT_EQ(refusal("<OBJECT>" + xgl_transform("0,0,1", "0,1,0", "0,0", "1") + "</OBJECT>"),
              "line 3: <POSITION> has 2 numbers in place of 3");
    EXPECT_EQ(refusal("<OBJECT>"), "line 4: is not well-formed XML (mismatched tag); export the file again");
    EXPECT_EQ(refusal_of_text(".zgl", "x\x9cnot deflated"), "is damaged or cut: it cannot be unpacked");
}

TEST(XglContent, UncommonFaultsAreRefused) {
    EXPECT_EQ(refusal_of_text(".xgl", "<MESH/>"), "has no element <WORLD>, which XGL files have");
    EXPECT_EQ(refusal_of_text(".xgl", xgl_of("<MESH><P ID='1'>0,0,a</P></MESH>")),
              "line 3: <P> has 'a', which is no number");
    EXPECT_EQ(refusal_of_text(".xgl", xgl_of("<MESH><F><FV1><P>0,0,0</P></FV1></F></MESH>")), "line 3: has no <PREF>");
    EXPECT_EQ(refusal_of_text(".xgl", xgl_of("<MESH><F/></MESH>")), "line 3: has no <FV1>");
    EXPECT_EQ(refusal_of_text(".xgl", xgl_of("<OBJECT>" + xgl_transform("0,0,0", "0,1,0", "0,0,0", "1") + "</OBJECT>")),
              "line 3: <FORWARD> has no direction");
}

}  // namespace
}  // namespace octopair::test
