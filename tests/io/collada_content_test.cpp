// Tests that COLLADA files are read as the format says, wherever Assimp alone reads them wrongly.
#include <gtest/gtest.h>

#include "io/imported_scene.hpp"

namespace octopair::test {
namespace {

using Texts = std::vector<std::string>;

/// A mesh with the points 0 0 0, 1 0 0, 0 2 0 and 0 0 4.
std::string dae_geometry(const std::string& primitives, const std::string& id = "g",
                         const std::string& values = "0 0 0 1 0 0 0 2 0 0 0 4") {
    return fmt::format(
        "<geometry id='{0}'><mesh><source id='{0}-p'><float_array id='{0}-a' "
        "count='12'>{2}</float_array><technique_common>"
        "<accessor source='#{0}-a' count='4' stride='3'><param name='X' type='float'/><param name='Y' type='float'/>"
        "<param name='Z' type='float'/></accessor></technique_common></source><vertices id='{0}-v'>"
        "<input semantic='POSITION' source='#{0}-p'/></vertices>{1}</mesh></geometry>",
        id, primitives, values);
}

std::string dae_group(const std::string& type, const std::string& content,
                      const std::string& attributes = "count='1'") {
    return fmt::format("<{0} {2}><input semantic='VERTEX' source='#g-v' offset='0'/>{1}</{0}>", type, content,
                       attributes);
}

const std::string all_triangles = dae_group("triangles", "<p>0 1 2 0 1 3</p>", "count='2'");

/// A file of three lines: the head, the geometries and libraries, and the scene.
std::string dae_of(const std::string& nodes, const std::string& libraries = dae_geometry(all_triangles),
                   const std::string& asset = "") {
    return "<COLLADA version='1.4.1'><asset>" + asset + "</asset>\n<library_geometries>" + libraries +
           "</library_geometries>\n<library_visual_scenes><visual_scene id='s'>" + nodes +
           "</visual_scene></library_visual_scenes><scene><instance_visual_scene url='#s'/></scene></COLLADA>";
}

const std::string instance_g = "<instance_geometry url='#g'/>";

std::string node_a(const std::string& content) { return "<node id='a' name='a'>" + content + "</node>"; }

std::string pose_in_dae(const std::string& transforms) {
    return boxes_named(import_text(".dae", dae_of(node_a(transforms + instance_g))), "a").at(0);
}

std::string primitives_in_dae(const std::string& primitives) {
    return boxes_named(import_text(".dae", dae_of(node_a(instance_g), dae_geometry(primitives))), "a").at(0);
}

TEST(ColladaContent, TransformsAreThoseOfTheFormat) {
    EXPECT_EQ(pose_in_dae(""), "0 0 0 1 2 4");
    EXPECT_EQ(pose_in_dae("<rotate>0 0 3 90</rotate>"), "-2 0 0 0 1 4");
    EXPECT_EQ(pose_in_dae("<translate>10 0 0</translate><scale>2 1 1</scale>"), "10 0 0 12 2 4");
    EXPECT_EQ(pose_in_dae("<lookat>0 0 10 0 0 0 0 1 5</lookat>"), "0 0 10 1 2 14") << "an up that is not perpendicular";
    EXPECT_EQ(pose_in_dae("<lookat>5 0 0 0 0 0 0 0 1</lookat>"), "5 0 0 9 1 2");
    EXPECT_EQ(pose_in_dae("<skew>0 1 0 0 0 1 0</skew>"), "0 0 0 1 2 4");
    EXPECT_EQ(pose_in_dae("<translate>0,5 0 <!-- z --> 0</translate>"), "0.5 0 0 1.5 2 4");
}

TEST(ColladaContent, UnitAndAxisAreConverted) {
    const auto read = [](const std::string& asset) {
        return boxes_named(import_text(".dae", dae_of(node_a(instance_g), dae_geometry(all_triangles), asset)), "a")
            .at(0);
    };
    EXPECT_EQ(read("<up_axis>Y_UP</up_axis>"), "0 0 0 1 2 4");
    EXPECT_EQ(read("<up_axis> Z_UP\n</up_axis>"), "0 0 -2 1 4 0");
    EXPECT_EQ(read("<unit meter='0.01' name='cm'/>"), "0 0 0 0.01 0.02 0.04");
    EXPECT_EQ(read("<unit meter='0,01'/>"), "0 0 0 0.01 0.02 0.04");
}

TEST(ColladaContent, AllPrimitivesAreRead) {
    EXPECT_EQ(primitives_in_dae(dae_group("polygons", "<p>0 1 2</p><p>0 1 3</p>", "count='2'")), "0 0 0 1 2 4");
    EXPECT_EQ(primitives_in_dae(dae_group("tristrips", "<p>0 1 2 3</p><p>0 1</p>")), "0 0 0 1 2 4");
    EXPECT_EQ(primitives_in_dae(dae_group("polylist", "<vcount>3</vcount><p>0 1 3</p>")), "0 0 0 1 0 4");
    EXPECT_EQ(primitives_in_dae(dae_group("triangles", "<p>0 1 <!-- c --> 2</p>")), "0 0 0 1 2 0");
    EXPECT_EQ(primitives_in_dae(dae_group("triangles", "<p>0 1 3</p>", "")), "0 0 0 1 0 4") << "without a count";
    EXPECT_EQ(primitives_in_dae(dae_group("triangles", "<p>0 1 2</p><p>0 1 3</p>", "count='2'")), "0 0 0 1 2 4");
    EXPECT_EQ(primitives_in_dae(dae_group("triangles", "<p>0 1 2</p><extra><technique profile='x'/></extra>")),
              "0 0 0 1 2 0");
    const std::string two_inputs =
        "<input semantic='NORMAL' source='#none' offset='0'/><input semantic='VERTEX' source='#g-v' offset='1'/>";
    EXPECT_EQ(primitives_in_dae("<triangles count='1'>" + two_inputs + "<p>7 0 8 1 9 3</p></triangles>"),
              "0 0 0 1 0 4");
}

TEST(ColladaContent, FansAreTriangles) {
    const TemporaryDirectory directory;
    const std::string path = directory.file("fan.dae");
    write_file(path, dae_of(node_a(instance_g), dae_geometry(dae_group("trifans", "<p>3 0 1 2</p>"))));
    const auto triangles = io::read_scene(path, {io::MeshObjects::triangle, true}).triangles->triangles;
    ASSERT_EQ(triangles.size(), 2u);
    EXPECT_EQ(triangles[0], (Triangle3d{Point3d{0, 0, 4}, Point3d{0, 0, 0}, Point3d{1, 0, 0}}));
    EXPECT_EQ(triangles[1], (Triangle3d{Point3d{0, 0, 4}, Point3d{1, 0, 0}, Point3d{0, 2, 0}}));
}

TEST(ColladaContent, ParamsWithOtherNamesAreInOrder) {
    std::string geometry = dae_geometry(all_triangles);
    for (const std::string axis : {"X", "Y", "Z"})
        geometry.replace(geometry.find("name='" + axis), 7, "name='P" + axis);
    EXPECT_EQ(boxes_named(import_text(".dae", dae_of(node_a(instance_g), geometry)), "a"), Texts{"0 0 0 1 2 4"});
}

TEST(ColladaContent, InstancesOfNodesAreRead) {
    const std::string library =
        dae_geometry(all_triangles) +
        "</library_geometries><library_nodes><node id='o'><node id='i' name='i'><translate>0 0 100</translate>" +
        instance_g + "</node></node></library_nodes><library_geometries>";
    const ImportedScene scene =
        import_text(".dae", dae_of(node_a("<instance_node url='#i'/>") +
                                       "<node><instance_node url='#o'/><instance_node url='#none'/>" +
                                       "<instance_node url='b.dae#n'/><instance_geometry "
                                       "url='#none'/><instance_geometry url='b.dae#g'/></node>",
                                   library));
    EXPECT_EQ(boxes_named(scene, "i"), (Texts{"0 0 100 1 2 104", "0 0 100 1 2 104"}));
    EXPECT_EQ(
        scene.not_read,
        (Texts{"instances of geometry in other files (1)", "instances of geometry that the file does not have (1)",
               "instances of nodes in other files (1)", "instances of nodes that the file does not have (1)"}));
}

TEST(ColladaContent, GeometryWithOtherMaterialsKeepsItsVertices) {
    const std::string groups = dae_group("triangles", "<p>0 1 2</p>", "count='1' material='m'") +
                               dae_group("triangles", "<p>0 1 3</p>", "count='1' material='n'");
    const auto bound = [](const std::string& m, const std::string& n) {
        return "<instance_geometry url='#g'><bind_material><technique_common><instance_material symbol='m' target='#" +
               m + "'/><instance_material symbol='n' target='#" + n +
               "'/></technique_common></bind_material></instance_geometry>";
    };
    const ImportedScene scene = import_text(
        ".dae",
        dae_of(node_a(bound("p", "q")) + "<node id='b' name='b'>" + bound("p", "r") + "</node>", dae_geometry(groups)));
    EXPECT_EQ(boxes_named(scene, "a"), Texts{"0 0 0 1 2 4"});
    EXPECT_EQ(boxes_named(scene, "b"), Texts{"0 0 0 1 2 4"});
}

TEST(ColladaContent, FaultsAreRefusedWithTheirLines) {
    const auto node = [](const std::string& content) {
        return refusal_of_text(".dae", dae_of(node_a(content + instance_g)));
    };
    EXPECT_EQ(node("<skew>45 1 0 0 0 1 0</skew>"),
              "line 3: <skew> is not read; export the node with a <matrix>, or its vertices in their places");
    EXPECT_EQ(node("<translate>1 2</translate>"), "line 3: <translate> has 2 numbers in place of 3");
    EXPECT_EQ(node("<rotate>0 0 0 90</rotate>"), "line 3: <rotate> has an axis without a direction");
    EXPECT_EQ(node("<scale>1 1 1,0,0</scale>"), "line 3: <scale> has '1,0,0', which is no number");
    EXPECT_EQ(node("<matrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 1 1</matrix>"),
              "line 3: <matrix> is no affine transform: its last row must be 0 0 0 1");
    EXPECT_EQ(node("<instance_node url='#a'/>"), "line 3: the node has an instance of itself");
    const auto mesh = [](const std::string& primitives) {
        return refusal_of_text(".dae", dae_of(node_a(instance_g), dae_geometry(primitives)));
    };
    EXPECT_EQ(mesh(dae_group("polygons", "<ph><p>0 1 2</p><h>0 1 2</h></ph>")),
              "line 2: a polygon with holes is not read; triangulate the model before the export");
    EXPECT_EQ(mesh(dae_group("triangles", "<p>0 1 9</p>")), "line 2: <p> has the index 9, but there are 4 positions");
    EXPECT_EQ(mesh(dae_group("triangles", "<p>0 1 -2</p>")), "line 2: <p> has the index -2, but there are 4 positions");
    EXPECT_EQ(mesh(dae_group("triangles", "<p>0,1,2</p>")), "line 2: <p> has '0,1,2', which is no number");
    EXPECT_EQ(mesh(dae_group("triangles", "<p>0 1</p>")), "line 2: <p> has 2 corners, but <triangles> needs 0");
    EXPECT_EQ(mesh("<triangles count='1'><p>0 1 2</p></triangles>"), "line 2: has no input with the semantic VERTEX");
    EXPECT_EQ(refusal_of_text(".dae", dae_of(node_a(instance_g), dae_geometry(all_triangles, "g", "1 2 3"))),
              "line 2: 4 positions with a stride of 3 do not fit to 3 values");
    EXPECT_EQ(refusal_of_text(".dae", dae_of("", dae_geometry("") + dae_geometry(""))),
              "line 2: a second geometry has the id 'g'");
    EXPECT_EQ(refusal_of_text(".dae", dae_of("").substr(0, 100)),
              "line 2: is not well-formed XML (unclosed token); export the file again");
    EXPECT_EQ(refusal_of_text(".dae", dae_of("", "", "<up_axis>UP</up_axis>")),
              "line 1: the up axis is 'UP', not X_UP, Y_UP or Z_UP");
}

TEST(ColladaContent, UncommonFaultsAreRefused) {
    const auto changed = [](const std::string& from, const std::string& to) {
        std::string text = dae_of(node_a(instance_g));
        text.replace(text.find(from), from.size(), to);
        return refusal_of_text(".dae", text);
    };
    EXPECT_EQ(changed("<COLLADA", "<model></model><COLLADA").substr(0, 32), "line 1: is not well-formed XML (");
    EXPECT_EQ(refusal_of_text(".dae", "<model/>"), "has no element <COLLADA>, which COLLADA files have");
    EXPECT_EQ(changed("<instance_visual_scene url='#s'/>", ""), "has no scene (<instance_visual_scene>)");
    EXPECT_EQ(changed("<instance_visual_scene url='#s'", "<instance_visual_scene url='#t'"),
              "line 3: the scene is not in the file");
    EXPECT_EQ(changed("<asset></asset>", "<asset><unit meter='x'/></asset>"), "line 1: meter=\"x\" is no length");
    EXPECT_EQ(changed("<mesh>", "<asset><unit meter='2'/></asset><mesh>"),
              "line 2: a part of the model has another unit or up axis than the whole; export it with one");
    EXPECT_EQ(changed("stride='3'", "stride='-3'"), "line 2: stride=\"-3\" is no whole number");
    EXPECT_EQ(changed("<param name='X' type='float'/>", "<param type='float'/>"),
              "line 2: positions need three params with names");
    EXPECT_EQ(changed("source='#g-p'", "source='#g-q'"), "line 2: source=\"#g-q\" is not in the same mesh");
    EXPECT_EQ(changed("source='#g-a'", "source='#g-b'"), "line 2: source=\"#g-b\" is not in the same <source>");
    EXPECT_EQ(changed("accessor", "assessor").substr(0, 32), "line 2: is not well-formed XML (");
    EXPECT_EQ(changed("'POSITION'", "'NORMAL'"), "line 2: has no input with the semantic POSITION");
    EXPECT_EQ(changed("offset='0'", "offset='3'"), "line 2: <p> has 6 indices, which is no multiple of 4");
    const std::string second = dae_geometry(all_triangles, "h");
    const std::size_t begin = second.find("<mesh>") + 6;
    std::string two = dae_geometry(all_triangles);
    two.replace(two.find("</mesh>"), 0, second.substr(begin, second.find("</mesh>") - begin));
    two.replace(two.rfind("#g-v"), 4, "#h-v");
    EXPECT_EQ(refusal_of_text(".dae", dae_of(node_a(instance_g), two)),
              "line 2: the primitives of a mesh have positions of several sources");
}

TEST(ColladaContent, OtherGeometryIsCounted) {
    const ImportedScene scene =
        import_text(".dae", dae_of(node_a(instance_g) + "<node><instance_geometry url='#s1'/></node>",
                                   dae_geometry(all_triangles) + "<geometry id='s1'><spline/></geometry>"));
    EXPECT_EQ(scene.not_read, Texts{"geometry of type spline (1)"});
    EXPECT_EQ(scene.objects.size(), 1u);
}

}  // namespace
}  // namespace octopair::test
