// Tests the reader of JSON scenes: every shape, the properties of objects, and the exact messages of refusals.
#include "io/json/json_scene.hpp"

#include <gtest/gtest.h>

#include "io/scene_reader.hpp"
#include "io/temporary.hpp"

namespace octopair::test {
namespace {

using io::LoadedScene;
using io::LoadedShapes;

LoadedScene parsed_scene(const std::string& text) {
    return io::parse_json_scene(text, "f.json", [](const std::string& name) -> shape::Mesh {
        if (name != "part.obj") throw Error(ErrorCode::io_failed, name + ": cannot open");
        return {{{1, 2, 3}}, {{0, 0, 0}}};
    });
}

std::string with_shape(const std::string& shape) { return R"({"objects":[{"shape":)" + shape + "}]}"; }

template <typename Shape>
Shape shape_of(const std::string& shape) {
    const LoadedScene scene = parsed_scene(with_shape(shape));
    return std::get<Shape>(scene.shapes->shapes.at(scene.shapes->geometry.at(0)));
}

TEST(JsonScene, EveryShape) {
    EXPECT_EQ(shape_of<shape::Sphere>(R"({"type":"sphere","radius":0.1})").radius, 0.1);
    EXPECT_EQ(shape_of<shape::Box>(R"({"type":"box","half_extents":[1,2,3]})").half_extents, (Point3d{1, 2, 3}));
    EXPECT_EQ(shape_of<shape::Capsule>(R"({"type":"capsule","radius":2,"length":0})").radius, 2);
    EXPECT_EQ(shape_of<shape::Cylinder>(R"({"type":"cylinder","radius":2,"length":3})").length, 3);
    EXPECT_EQ(shape_of<shape::Cone>(R"({"type":"cone","radius":2,"length":3})").length, 3);
    EXPECT_EQ(shape_of<shape::Ellipsoid>(R"({"type":"ellipsoid","radii":[1,2,3]})").radii[2], 3);
    EXPECT_EQ(shape_of<shape::Plane>(R"({"type":"plane","normal":[0,0,2],"offset":-1})").offset, -1);
    EXPECT_EQ(shape_of<shape::ConvexHull>(R"({"type":"convex_hull","points":[[0,0,0],[4,5,6]]})").points.size(), 2u);
    const auto mesh =
        shape_of<shape::Mesh>(R"({"type":"mesh","vertices":[[0,0,0],[1,0,0],[0,1,0]],"triangles":[[0,1,2],[2,2,1]]})");
    EXPECT_EQ(mesh.vertices[2], (Point3d{0, 1, 0}));
    EXPECT_EQ(mesh.triangles[1], (std::array<std::uint32_t, 3>{2, 2, 1}));
    EXPECT_EQ(shape_of<shape::Mesh>(R"({"type":"mesh","file":"part.obj"})").vertices[0], (Point3d{1, 2, 3}));
}

TEST(JsonScene, ObjectsHaveDefaults) {
    const LoadedScene scene = parsed_scene(with_shape(R"({"type":"sphere","radius":1})"));
    EXPECT_EQ(scene.objects, 1u);
    EXPECT_TRUE(scene.lacks_boxes());
    EXPECT_EQ(scene.names, std::vector<std::string>{""});
    const LoadedShapes& loaded = *scene.shapes;
    EXPECT_EQ(loaded.poses[0].rows, Pose{}.rows);
    EXPECT_TRUE(loaded.end_poses.empty() && loaded.padding.empty() && loaded.groups.empty() && loaded.masks.empty());
}

TEST(JsonScene, ObjectsShareShapesAndSayWhatTheyAre) {
    const LoadedScene scene = parsed_scene(R"({
        "shapes": {"ball": {"type": "sphere", "radius": 1}, "unused": {"type": "sphere", "radius": 2}},
        "objects": [
            {"name": "still", "shape": "ball", "position": [0.1, 1e300, -3], "parent": "car"},
            {"name": "moved", "shape": "ball", "end_position": [1, 0, 0], "padding": 0.5},
            {"name": "turned", "shape": "ball", "rotation": [0, 0, 0, 2], "end_rotation": [1, 0, 0, 0], "parent": "car"},
            {"name": "last", "shape": {"type": "sphere", "radius": 3}, "group": 4, "mask": 4294967295}]})");
    EXPECT_EQ(scene.names, (std::vector<std::string>{"still", "moved", "turned", "last"}));
    const LoadedShapes& loaded = *scene.shapes;
    EXPECT_EQ(loaded.geometry[0], loaded.geometry[1]);
    EXPECT_EQ(std::get<shape::Sphere>(loaded.shapes[loaded.geometry[0]]).radius, 1);
    EXPECT_EQ(std::get<shape::Sphere>(loaded.shapes[loaded.geometry[3]]).radius, 3);
    EXPECT_EQ(loaded.poses[0].rows[0][3], 0.1);
    EXPECT_EQ(loaded.poses[0].rows[1][3], 1e300);
    EXPECT_EQ(loaded.poses[2].rows[0][0], -1);  // half a turn about z
    ASSERT_EQ(loaded.end_poses.size(), 4u);
    EXPECT_EQ(loaded.end_poses[0].rows, loaded.poses[0].rows);
    EXPECT_EQ(loaded.end_poses[1].rows[0][3], 1);
    EXPECT_EQ(loaded.end_poses[2].rows[0][0], 1);
    EXPECT_EQ(loaded.end_poses[3].rows, loaded.poses[3].rows);
    EXPECT_EQ(loaded.padding, (std::vector<double>{0, 0.5, 0, 0}));
    EXPECT_EQ(loaded.groups, (std::vector<std::uint32_t>{1, 1, 1, 4}));
    EXPECT_EQ(loaded.masks, std::vector<std::uint32_t>(4, 0xFFFFFFFF));
    EXPECT_EQ(loaded.parents[0], loaded.parents[2]);
    EXPECT_NE(loaded.parents[1], loaded.parents[0]);
    EXPECT_NE(loaded.parents[3], loaded.parents[1]);
}

TEST(JsonScene, AcceptsAnEmptyScene) { EXPECT_EQ(parsed_scene(R"({"objects": []})").objects, 0u); }

TEST(JsonScene, RefusesWithAClearMessage) {
    const std::string ball = R"("shape":{"type":"sphere","radius":1})";
    const std::pair<std::string, std::string> cases[] = {
        {"[]", "f.json: an array, not an object"},
        {"{}", "f.json: the key 'objects' is missing"},
        {R"({"objects":{}})", "f.json: objects: an object, not an array"},
        {R"({"objects":[],"units":"m"})", "f.json: unknown key 'units'; known keys: objects, shapes"},
        {R"({"objects":[],"objects":[]})", "f.json: the key 'objects' occurs twice in one object"},
        {R"({"objects":[{},{"shape":{"radius":1,"radius":2}}]})",
         "f.json: objects[1].shape: the key 'radius' occurs twice in one object"},
        {R"({"objects":[{},{"position":[0,1e999,0]}]})",
         "f.json: objects[1].position[1]: number overflow parsing '1e999'"},
        {R"({"objects":[{)" + ball + R"(,"rotation":[1.7e308,0,0,1.7e308]}]})",
         "f.json: object 0: rotation: the length of the quaternion is outside the range of float64"},
        {with_shape(R"({"type":"mesh","file":"a.obj","vertices":[]})"),
         "f.json: object 0: shape: vertices: not allowed together with 'file'"},
        {R"({"objects":[7]})", "f.json: object 0: a number, not an object"},
        {R"({"objects":[{"name":"x"}]})", "f.json: object 0 ('x'): the key 'shape' is missing"},
        {R"({"objects":[{"name":7}]})", "f.json: object 0: name: a number, not a string"},
        {R"({"objects":[{"shape":"x"}]})",
         "f.json: object 0: shape: no shape has the name 'x'; add it to 'shapes' at the root"},
        {R"({"objects":[{)" + ball + R"(,"place":[0,0,0]}]})",
         "f.json: object 0: unknown key 'place'; known keys: name, shape, position, rotation, "
         "end_position, end_rotation, group, mask, padding, parent"},
        {R"({"objects":[{)" + ball + R"(,"position":[0,0]}]})",
         "f.json: object 0: position: an array of 2, not an array of 3 numbers"},
        {R"({"objects":[{)" + ball + R"(,"position":[0,null,0]}]})",
         "f.json: object 0: position: null, not a number in an array of 3 numbers"},
        {R"({"objects":[{)" + ball + R"(,"rotation":[0,0,0,0]}]})",
         "f.json: object 0: rotation: the quaternion has length 0"},
        {R"({"objects":[{)" + ball + R"(,"end_rotation":[1,0,0]}]})",
         "f.json: object 0: end_rotation: an array of 3, not a quaternion w, x, y, z"},
        {R"({"objects":[{)" + ball + R"(,"padding":-1}]})", "f.json: object 0: padding: -1 is not a number >= 0"},
        {R"({"objects":[{)" + ball + R"(,"group":-1}]})",
         "f.json: object 0: group: -1 is not a whole number from 0 to 4294967295"},
        {R"({"objects":[{)" + ball + R"(,"mask":1.5}]})",
         "f.json: object 0: mask: 1.5 is not a whole number from 0 to 4294967295"},
        {R"({"shapes":{"s":{"type":"ball"}},"objects":[]})",
         "f.json: shape 's': type: 'ball' is not a type of shape; types: sphere, box, capsule, cylinder, cone, "
         "ellipsoid, plane, convex_hull, mesh"},
        {with_shape(R"({"type":"sphere","radius":0})"), "f.json: object 0: shape: radius: 0 is not a number > 0"},
        {with_shape(R"({"type":"sphere","radius":"1"})"),
         "f.json: object 0: shape: radius: a string, not a number > 0"},
        {with_shape(R"({"type":"sphere","radius":1,"length":1})"),
         "f.json: object 0: shape: unknown key 'length'; known keys: type, radius"},
        {with_shape(R"({"type":"box","half_extents":[1,1,-1]})"),
         "f.json: object 0: shape: half_extents: -1 is not a number > 0"},
        {with_shape(R"({"type":"capsule","radius":1,"length":-1})"),
         "f.json: object 0: shape: length: -1 is not a number >= 0"},
        {with_shape(R"({"type":"plane","normal":[0,0,0],"offset":1})"),
         "f.json: object 0: shape: normal: 0, 0, 0 is not a direction"},
        {with_shape(R"({"type":"convex_hull","points":[]})"),
         "f.json: object 0: shape: points: the list is empty; a hull needs at least one point"},
        {with_shape(R"({"type":"mesh","vertices":[[0,0,0]],"triangles":[[0,0,0],[0,0,1]]})"),
         "f.json: object 0: shape: triangle 1: vertex 1 does not exist; the mesh has 1 vertices"},
        {with_shape(R"({"type":"mesh","vertices":[[0,0,0]],"triangles":[[0,0]]})"),
         "f.json: object 0: shape: triangle 0: 2 vertices, not 3"},
    };
    for (const auto& [text, words] : cases) {
        EXPECT_EQ(error_of(ErrorCode::bad_input, [&, &json = text] { (void)parsed_scene(json); }), words) << text;
    }
    EXPECT_EQ(
        error_of(ErrorCode::io_failed, [&] { (void)parsed_scene(with_shape(R"({"type":"mesh","file":"none.obj"})")); }),
        "f.json: object 0: shape: none.obj: cannot open");
}

TEST(JsonScene, RefusesWhatIsNoJson) {
    for (const std::string& text :
         {std::string(), std::string("{"), std::string("{\"objects\":[NaN]}"), std::string("{\"objects\":[1e999]}"),
          std::string("{\"objects\":[\"\xFF\"]}"), std::string("{\"objects\":[]} x"),
          "{\"objects\":" + std::string(100000, '['), "{\"a\n\x01\":" + std::string(300, '7') + "x}"}) {
        const std::string words = error_of(ErrorCode::bad_input, [&] { (void)parsed_scene(text); });
        EXPECT_TRUE(words.starts_with("f.json: ")) << words;
        EXPECT_LT(words.size(), 300u);
        EXPECT_EQ(words.find('\n'), std::string::npos);
    }
    EXPECT_EQ(error_of(ErrorCode::bad_input, [&] { (void)parsed_scene("{\"objects\":" + std::string(100000, '[')); }),
              "f.json: objects[0][0][0][0][0][0][0][0][0][0][0][0][0][0][0]: more than 16 levels of nesting");
}

/// The parser of the library takes a byte 0 as the end of the text.
TEST(JsonScene, RefusesAByteZero) {
    for (const std::string rest : {"", "{", "\n{\"objects\": [7]}"}) {
        const std::string text = "{\"objects\": []}" + std::string(1, '\0') + rest;
        EXPECT_EQ(error_of(ErrorCode::bad_input, [&] { (void)parsed_scene(text); }),
                  "f.json: byte 15 is 0; a JSON file is text");
    }
}

#if defined(OCTOPAIR_WITH_PIPELINE) && defined(OCTOPAIR_WITH_MESHES)
TEST(JsonScene, MeshesAreInFilesBesideIt) {
    const TemporaryDirectory directory;
    write_file(directory.file("part.off"), "OFF\n3 1 0\n0 0 0\n1 0 0\n0 0.1 0\n3 0 1 2\n");
    write_file(directory.file("s.json"), with_shape(R"({"type":"mesh","file":"part.off"})"));
    EXPECT_TRUE(io::is_json_file(directory.file("s.json")));
    EXPECT_FALSE(io::is_mesh_file(directory.file("s.json")));
    const LoadedScene scene = io::read_scene(directory.file("s.json"), {});
    const auto& mesh = std::get<shape::Mesh>(scene.shapes->shapes[0]);
    EXPECT_EQ(mesh.vertices, (std::vector<Point3d>{{0, 0, 0}, {1, 0, 0}, {0, 0.1, 0}}));
    EXPECT_NE(error_of(ErrorCode::bad_input,
                       [&] { (void)io::read_scene(directory.file("s.json"), {io::MeshObjects::triangle}); }),
              "");
}
#endif

}  // namespace
}  // namespace octopair::test
