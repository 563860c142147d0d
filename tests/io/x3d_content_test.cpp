// Tests that X3D files are read as the format says, wherever Assimp alone reads them wrongly.
#include <gtest/gtest.h>

#include "io/imported_scene.hpp"

namespace octopair::test {
namespace {

using Texts = std::vector<std::string>;

std::string x3d_of(const std::string& nodes) {
    return "<?xml version=\"1.0\"?>\n<X3D version=\"3.2\"><Scene>\n" + nodes + "\n</Scene></X3D>\n";
}

const std::string box_shape = "<Shape><Box size='2 4 6'/></Shape>";

std::string at_x(int x, const std::string& name, const std::string& children = box_shape) {
    return fmt::format("<Transform DEF='{}' translation='{} 0 0'>{}</Transform>", name, x, children);
}

ImportedScene read_x3d(const std::string& nodes) { return import_text(".x3d", x3d_of(nodes)); }

TEST(X3dContent, NodesAfterEmptyAndUsedGroupsKeepTheirPlaces) {
    const ImportedScene scene =
        read_x3d(at_x(10, "A") + "<Group DEF='E'/>" + at_x(20, "B") + "<Transform DEF='P' translation='0 100 0'>" +
                 "<Transform USE='A'/>" + at_x(30, "C") + "</Transform>" + at_x(40, "D"));
    EXPECT_EQ(scene.objects.size(), 5u);
    EXPECT_EQ(boxes_named(scene, "A"), (Texts{"9 -2 -3 11 2 3", "9 98 -3 11 102 3"}));
    EXPECT_EQ(boxes_named(scene, "B"), Texts{"19 -2 -3 21 2 3"});
    EXPECT_EQ(boxes_named(scene, "C"), Texts{"29 98 -3 31 102 3"});
    EXPECT_EQ(boxes_named(scene, "D"), Texts{"39 -2 -3 41 2 3"});
}

TEST(X3dContent, OnlyTheChosenChildOfASwitchIsRead) {
    const std::string children = "<MetadataString name='m'/>" + at_x(10, "A") + at_x(20, "B");
    const auto choose = [&](const std::string& attribute) {
        return read_x3d("<Switch" + attribute + ">" + children + "</Switch>" + at_x(30, "C"));
    };
    EXPECT_EQ(boxes_named(choose(" whichChoice='1'"), "B"), Texts{"19 -2 -3 21 2 3"});
    EXPECT_EQ(choose(" whichChoice='0'").objects.count("A"), 1u);
    for (const std::string none : {"", " whichChoice='-1'", " whichChoice='2'"}) {
        EXPECT_EQ(choose(none).objects.size(), 1u) << none;
        EXPECT_EQ(boxes_named(choose(none), "C"), Texts{"29 -2 -3 31 2 3"}) << none;
    }
}

TEST(X3dContent, TransformsAreThoseOfTheFormat) {
    const auto pose = [](const std::string& attributes) {
        return boxes_named(read_x3d("<Transform DEF='T' " + attributes + ">" + box_shape + "</Transform>"), "T").at(0);
    };
    EXPECT_EQ(pose("rotation='0 0 2 1.5707963267948966'"), "-2 -1 -3 2 1 3");
    EXPECT_EQ(pose("rotation='0,0,1,1.5707963267948966' translation='1,2,3'"), "-1 1 0 3 3 6");
    EXPECT_EQ(pose("rotation='0 0 0 0'"), "-1 -2 -3 1 2 3");
    EXPECT_EQ(pose("scale='2 1 1' center='1 0 0'"), "-3 -2 -3 1 2 3");
    EXPECT_EQ(pose("scale='2 1 1' scaleOrientation='0 0 3 1.5707963267948966'"), "-1 -4 -3 1 4 3");
    EXPECT_EQ(pose("center='1 0 0' rotation='0 0 1 3.141592653589793'"), "1 -2 -3 3 2 3");
}

TEST(X3dContent, ShapesAreThoseOfTheFormat) {
    const auto shape = [](const std::string& geometry) {
        return boxes_named(read_x3d("<Group DEF='G'><Shape>" + geometry + "</Shape></Group>"), "G").at(0);
    };
    const std::string points = "<Coordinate point='0 0 0, 1 0 0,0 2 0, 3 3 3'/>";
    EXPECT_EQ(shape("<IndexedFaceSet coordIndex='0,1,2,-1,-1'>" + points + "</IndexedFaceSet>"), "0 0 0 1 2 0");
    EXPECT_EQ(shape("<IndexedFaceSet coordIndex='0 3 2'>" + points + "</IndexedFaceSet>"), "0 0 0 3 3 3");
    EXPECT_EQ(shape("<TriangleStripSet stripCount='4'>" + points + "</TriangleStripSet>"), "0 0 0 3 3 3");
    EXPECT_EQ(shape("<QuadSet>" + points + "</QuadSet>"), "0 0 0 3 3 3");
    EXPECT_EQ(shape("<IndexedTriangleFanSet index='0 1 2 -1 0 1 2'>" + points + "</IndexedTriangleFanSet>"),
              "0 0 0 1 2 0");
    EXPECT_EQ(shape("<ElevationGrid xDimension='2' zDimension='3' xSpacing='4' zSpacing='5' height='0 1 2 3 4 5'/>"),
              "0 0 0 4 5 10");
    EXPECT_EQ(shape("<Cylinder height='4' radius='1'/>"), "-1 -2 -1 1 2 1");
    EXPECT_EQ(shape("<Sphere radius='3'/>"), "-3 -3 -3 3 3 3");
    EXPECT_EQ(shape("<Extrusion spine='0 0 0 0 5 0' scale='2 2'/>"), "-2 0 -2 2 5 2");
}

TEST(X3dContent, ConesStandOnTheirBases) {
    const TemporaryDirectory directory;
    const std::string path = directory.file("cone.x3d");
    write_file(path, x3d_of("<Shape><Cone height='4' bottomRadius='1'/></Shape>"));
    const auto triangles = io::read_scene(path, {io::MeshObjects::triangle, true}).triangles;
    ASSERT_TRUE(triangles);
    std::size_t tips = 0, others = 0;
    for (const Triangle3d& triangle : triangles->triangles) {
        for (const Point3d& corner : triangle) {
            if (corner[1] == 2 && corner[0] == 0) ++tips;
            if (corner[1] == 2 && corner[0] != 0) ++others;
        }
    }
    EXPECT_EQ(tips, 32u);
    EXPECT_EQ(others, 0u);
    EXPECT_EQ(triangles->triangles.size(), 62u) << "32 sides, and 30 triangles of the base";
}

TEST(X3dContent, FilesOfInlineNodesAreRead) {
    const TemporaryDirectory directory;
    const std::string path = directory.file("scene.x3d");
    write_file(
        path,
        x3d_of(
            "<Transform translation='5 0 0'><Inline url='\"http://x.invalid/part.x3d\" \"part.x3d\"'/></Transform>"));
    const auto read = [&] { return io::read_scene(path, {io::MeshObjects::node}); };
    expect_error(ErrorCode::bad_input, "line 3: no file that the Inline node names", read);
    write_file(directory.file("part.x3d"), x3d_of("<Group/>" + at_x(10, "A")));
    const io::LoadedScene scene = read();
    ASSERT_EQ(scene.objects, 1u);
    EXPECT_EQ(text_of_box(std::get<Buffer<Box3d>>(scene.boxes)[0]), "14 -2 -3 16 2 3");
}

TEST(X3dContent, AnglesHaveTheUnitOfTheFile) {
    const auto turned = [](const std::string& head, const std::string& angle) {
        return import_text(".x3d",
                           "<X3D><head>" + head + "</head><Scene><Transform DEF='t' rotation='0 0 1 " + angle +
                               "' translation='5 0 0'><Shape><Box size='2 4 6'/></Shape></Transform></Scene></X3D>");
    };
    const std::string degrees = "<unit category='angle' name='degree' conversionFactor='0.017453292519943295'/>";
    EXPECT_EQ(boxes_named(turned(degrees, "180"), "t"), boxes_named(turned("", "3.141592653589793"), "t"));
    EXPECT_EQ(turned("<unit category='length' name='mm' conversionFactor='0.001'/>", "0").not_read,
              Texts{"the unit of lengths, which are read as they are (1)"});
    EXPECT_EQ(refusal_of_text(".x3d", "<X3D><head><unit category='angle'/></head><Scene/></X3D>"),
              "line 1: conversionFactor is no number above 0");
}

TEST(X3dContent, WhatIsNotReadIsCounted) {
    const ImportedScene scene =
        read_x3d("<LOD>" + box_shape + "</LOD><Shape><Text string='a'/></Shape><ProtoInstance name='p'/>" + box_shape +
                 "<Anchor DEF='A'>" + box_shape +
                 "</Anchor><Collision><Shape containerField='proxy'><Box/></Shape></Collision>");
    EXPECT_EQ(scene.not_read,
              (Texts{"geometry of type Text (1)", "nodes of type LOD (1)", "nodes of type ProtoInstance (1)"}));
    EXPECT_EQ(scene.warnings.size(), 1u);
    EXPECT_EQ(scene.objects.size(), 2u);
}

TEST(X3dContent, FaultsAreRefusedWithTheirLines) {
    const auto refusal = [](const std::string& nodes) { return refusal_of_text(".x3d", x3d_of(nodes)); };
    EXPECT_EQ(refusal("<Group><Shape></Group></Shape>"),
              "line 3: is not well-formed XML (mismatched tag); export the file again");
    EXPECT_EQ(refusal("\n<Shape USE='a'/>"), "line 4: USE=\"a\": no node before it has this name as DEF");
    EXPECT_EQ(refusal("<Group DEF='a'><Group USE='a'/></Group>"), "line 3: <Group> uses a node that contains it");
    EXPECT_EQ(refusal("<Transform translation='1 b 2'/>"), "line 3: translation has 'b', which is no number");
    EXPECT_EQ(refusal("<Transform scale='1 2'/>"), "line 3: scale has 2 numbers in place of 3");
    EXPECT_EQ(refusal("<Transform rotation='0 0 0 1'/>"), "line 3: rotation has no axis");
    const auto geometry = [&](const std::string& node) { return refusal("<Shape>" + node + "</Shape>"); };
    EXPECT_EQ(geometry("<IndexedFaceSet coordIndex='0 1 4'><Coordinate point='0 0 0 1 1 1'/></IndexedFaceSet>"),
              "line 3: coordIndex has the index 4, but there are 2 points");
    EXPECT_EQ(geometry("<IndexedFaceSet coordIndex='0'><Coordinate point='0 0'/></IndexedFaceSet>"),
              "line 3: point has 2 numbers, which is no multiple of 3");
    EXPECT_EQ(geometry("<ElevationGrid xDimension='2' zDimension='2' height='1 2 3'/>"),
              "line 3: has 3 heights in place of 2 times 2");
    EXPECT_EQ(
        geometry("<Extrusion spine='0 0 0 1 0 0'/>"),
        "line 3: an Extrusion along a straight spine other than y is read wrongly; export it as an IndexedFaceSet");
    EXPECT_EQ(refusal_of_text(".x3d", "<html/>").substr(0, 6), "is an ");
    EXPECT_EQ(refusal_of_text(".x3d", "<scene/>"), "has no element <X3D>, which X3D files have");
}

TEST(X3dContent, AllEncodingsAreRead) {
    const std::string text = x3d_of("<Group DEF='\xfc'>" + box_shape + "</Group>");
    EXPECT_EQ(import_text(".x3d", text).objects.count("\u00fc"), 1u) << "Latin-1 without a declaration";
    const std::string declared = "<?xml version=\"1.0\" encoding=\"windows-1252\"?>" + text.substr(text.find('\n'));
    EXPECT_EQ(import_text(".x3d", declared).objects.count("\u00fc"), 1u);
}

TEST(X3dContent, UncommonFaultsAreRefused) {
    const auto geometry = [](const std::string& node) {
        return refusal_of_text(".x3d", x3d_of("<Shape>" + node + "</Shape>"));
    };
    const std::string points = "<Coordinate point='0 0 0 1 0 0 0 2 0'/>";
    EXPECT_EQ(geometry("<IndexedFaceSet coordIndex='0'><GeoCoordinate/></IndexedFaceSet>"),
              "line 3: has its points in a GeoCoordinate, which octopair does not read; export a Coordinate");
    EXPECT_EQ(geometry("<TriangleFanSet fanCount='4'>" + points + "</TriangleFanSet>"),
              "line 3: fanCount needs more than 3 points");
    EXPECT_EQ(geometry("<IndexedTriangleSet index='0 1 -1'>" + points + "</IndexedTriangleSet>"),
              "line 3: index has a negative index");
    EXPECT_EQ(geometry("<Cylinder radius='1 2'/>"), "line 3: radius has 2 numbers in place of one");
    EXPECT_EQ(geometry("<Extrusion spine='0 0 0 0 1 0' orientation='0 1 0 1'/>"),
              "line 3: an Extrusion with orientations is read wrongly; export it as an IndexedFaceSet");
    EXPECT_EQ(geometry("<Extrusion spine='0 0 0 0 1 0 0 2 0' scale='1 1 2 2'/>"), "line 3: has 2 scales for 3 points");
    EXPECT_EQ(refusal_of_text(".x3d", x3d_of("<Transform rotation='0 0 1'/>")),
              "line 3: rotation has 3 numbers in place of 4");
    EXPECT_EQ(refusal_of_text(".x3d", x3d_of("<Inline url='scene.x3d'/>")),
              "line 3: the files that Inline nodes name are nested more than 16 times");
    std::string deep;
    for (int i = 0; i < 5000; ++i) deep += "<Group>";
    EXPECT_EQ(refusal_of_text(".x3d", x3d_of(deep)), "line 3: more than 5000 elements are nested");
}

TEST(X3dContent, OtherGeometryIsRead) {
    const auto shape = [](const std::string& geometry) {
        return boxes_named(read_x3d("<Group DEF='G'><Shape>" + geometry + "</Shape></Group>"), "G").at(0);
    };
    const std::string points = "<Coordinate DEF='c' point='0 0 0 1 0 0 0 2 0 3 3 3'/>";
    EXPECT_EQ(shape("<IndexedQuadSet index='0 1 3 2'>" + points + "</IndexedQuadSet>"), "0 0 0 3 3 3");
    EXPECT_EQ(shape("<TriangleSet>" + points + "</TriangleSet>"), "0 0 0 1 2 0") << "three of four points";
    EXPECT_EQ(shape("<IndexedTriangleStripSet index='0 1 2 3 -1'>" + points + "</IndexedTriangleStripSet>"),
              "0 0 0 3 3 3");
    EXPECT_EQ(shape("<IndexedLineSet coordIndex='0 1 2'>" + points + "</IndexedLineSet>"), "0 0 0 1 2 0");
    EXPECT_EQ(shape("<LineSet vertexCount='2'>" + points + "</LineSet>"), "0 0 0 1 0 0");
    EXPECT_EQ(shape("<PointSet>" + points + "</PointSet>"), "0 0 0 3 3 3");
    EXPECT_EQ(shape("<Rectangle2D size='4 6'/>"), "-2 -3 0 2 3 0");
    const ImportedScene used =
        read_x3d("<Group DEF='G'><Shape><PointSet>" + points + "</PointSet></Shape></Group><Group DEF='H'><Shape>" +
                 "<IndexedFaceSet coordIndex='0 1 2'><Coordinate USE='c'/></IndexedFaceSet></Shape></Group>");
    EXPECT_EQ(boxes_named(used, "H"), Texts{"0 0 0 1 2 0"});
}

}  // namespace
}  // namespace octopair::test
