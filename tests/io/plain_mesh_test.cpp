// Tests the readers of OBJ, OFF, STL and PLY: every number as in the file, all encodings alike, and clear errors.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstdio>
#include <cstring>
#include <stop_token>
#include <string>
#include <vector>

#include "io/meshes/plain/plain_mesh.hpp"
#include "io/scene_reader.hpp"
#include "io/temporary.hpp"
#include "octopair/error.hpp"
#include "support/calls.hpp"

namespace octopair::test {
namespace {

const std::stop_token never;

io::PlainMesh off(const std::string& text) { return io::parse_off({text, "m.off", never}); }
io::PlainMesh ply(const std::string& text) { return io::parse_ply({text, "m.ply", never}); }
std::vector<io::PlainMesh> stl(const std::string& text) { return io::parse_stl({text, "m.stl", never}); }

/// Appends the bytes of a value, in either order.
template <typename Value>
void append(std::string& bytes, Value value, bool big = false) {
    char raw[sizeof(Value)];
    std::memcpy(raw, &value, sizeof(Value));
    if (big) std::reverse(raw, raw + sizeof(Value));
    bytes.append(raw, sizeof(Value));
}

TEST(PlainMesh, CornersOfObjBeyondAllNumbersAreRefused) {
    for (const std::string word : {"-9223372036854775808", "-4", "0", "99999999999999999999", "1.0", "1,2"}) {
        const std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 " + word + "\n";
        EXPECT_THROW((void)io::parse_obj({text, "a.obj", never}), Error) << word;
    }
}

TEST(PlainMesh, ACommentOfObjEndsWithItsLine) {
    const std::string text = "v 0 0 0 # C:\\a\\\nv 1 0 0\nv 0 1 0\nf 1 2 \\\n 3\n";
    const std::vector<io::PlainMesh> meshes = io::parse_obj({text, "a.obj", never});
    ASSERT_EQ(meshes.size(), 1u);
    EXPECT_EQ(meshes[0].vertices.size(), 3u);
}

TEST(PlainMesh, SurplusValuesOfPlyAreTold) {
    const std::string head =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    std::vector<std::string> warnings;
    const std::string text = head + "0 0 0 7\n1 0 0\n0 1 0\n3 0 1 2\n";
    EXPECT_EQ(io::parse_ply({text, "a.ply", never, {}, &warnings}).vertices.size(), 3u);
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_TRUE(has_text(warnings[0], "line 10 has more values"));
}

TEST(PlainMesh, LinesAndPointsOfObjAreNoSurface) {
    const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
    for (const std::string text : {"l 1 2 3 4\n", "p 1 2 3 4\n", "l 1 2 3 1\n", "p 1\np 1 2 3\n"}) {
        const std::string whole = vertices + text;
        const std::vector<io::PlainMesh> meshes = io::parse_obj({whole, "a.obj", never});
        ASSERT_EQ(meshes.size(), 1u) << text;
        EXPECT_EQ(meshes[0].triangles(), 0u) << text;
        EXPECT_GT(meshes[0].ends.size(), 1u) << text;
    }
}

TEST(PlainMesh, TextIsReadAsFloat64) {
    const io::PlainMesh mesh = off(
        "# made by hand\nOFF\n\n3 1 0 # counts\n.1 +0.2 -1e-30\r\n450000.44 5410000.10 1e36\n1e-400 7. -0 0.5 0.5 0.5\n"
        "3 0 1 2 255 0 0\n");
    ASSERT_EQ(mesh.vertices.size(), 3u);
    EXPECT_EQ(mesh.vertices[0], (Point3d{0.1, 0.2, -1e-30}));
    EXPECT_EQ(mesh.vertices[1], (Point3d{450000.44, 5410000.10, 1e36}));
    EXPECT_EQ(mesh.vertices[2], (Point3d{0, 7, 0}));
    EXPECT_EQ(mesh.corners, (std::vector<std::uint32_t>{0, 1, 2}));
}

TEST(PlainMesh, ErrorsNameTheLine) {
    const auto refused = [](const std::string& text) {
        return error_of(ErrorCode::bad_input, [&] { (void)off(text); });
    };
    EXPECT_EQ(refused("OFF\n1 0 0\n1 2 x\n"), "m.off: line 3: a coordinate is 'x', not a number");
    EXPECT_EQ(refused("OFF\n1 0 0\n1 2\n"), "m.off: line 3: the line ends where a coordinate should follow");
    EXPECT_EQ(refused("OFF\n1 0 0\n1 2 inf\n"), "m.off: line 3: a coordinate is inf, not a finite number");
    EXPECT_EQ(refused("OFF\n1 0 0\n1 2 1e999\n"), "m.off: line 3: a coordinate is 1e999, not a finite number");
    EXPECT_EQ(refused("OFF\n2 1 0\n0 0 0\n1 1 1\n3 0 1 2\n"),
              "m.off: line 5: a corner is 2, but at most 1 is possible; save the file again");
    EXPECT_EQ(refused("OFF\n2 0 0\n0 0 0\n"),
              "m.off: the file ends after line 3, where a vertex should follow; copy or save it again");
    EXPECT_EQ(refused("OFF\n4000000000 0 0\n"),
              "m.off: line 2: the number of vertices is 4000000000, but at most 4 is possible; save the file again");
    EXPECT_EQ(
        refused("4OFF\n"),
        "m.off: line 1: the header is '4OFF'; octopair reads OFF with any of ST, C and N before it, that is with three "
        "coordinates");
    EXPECT_EQ(refused("OFF\n0 1 0\n3 0 0 0\n"), "m.off: line 3: a face has corners, but there are no vertices");
    EXPECT_EQ(refused("OFF\n-1 0 0\n"), "m.off: line 2: the number of vertices is '-1', not a number without sign");
    EXPECT_EQ(refused("OFF\n1\n"), "m.off: line 2: the line ends where the number of faces should follow");
    EXPECT_EQ(refused("OFF BINARY\n"), "m.off: line 1: octopair reads OFF files as text only; save it as text");
    EXPECT_EQ(refused(""), "m.off: has no text, but the header is needed");
}

/// A tetrahedron as PLY, in every encoding. Its first coordinate has the bytes 0x0A at both ends.
std::string tetrahedron_ply(bool binary, bool big, bool wide) {
    const double places[4][3] = {
        {std::bit_cast<double>(std::uint64_t(0x0A0000000000000A)), 0, 0}, {1, 0, 0}, {0, 1.5, 0}, {0, 0, 2}};
    const std::uint32_t faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    std::string text = "ply\nformat " +
                       std::string(!binary ? "ascii"
                                   : big   ? "binary_big_endian"
                                           : "binary_little_endian") +
                       " 1.0\ncomment a tetrahedron\nelement vertex 4\n";
    for (const char* axis : {"x", "y", "z"})
        text += std::string("property ") + (wide ? "double " : "float ") + axis + "\n";
    text += "property uchar red\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n";
    for (const auto& place : places) {
        for (const double at : place) {
            if (!binary) {
                char number[40];
                std::snprintf(number, sizeof(number), "%.17g ", wide ? at : double(float(at)));
                text += number;
            } else if (wide) {
                append(text, at, big);
            } else {
                append(text, float(at), big);
            }
        }
        text += binary ? std::string("\x0A") : std::string("10\n");
    }
    for (const auto& face : faces) {
        if (!binary) {
            text += "3";
            for (const std::uint32_t corner : face) text += " " + std::to_string(corner);
            text += "\n";
            continue;
        }
        text += "\x03";
        for (const std::uint32_t corner : face) append(text, corner, big);
    }
    return text;
}

TEST(PlainMesh, AllEncodingsOfPlyAreAlike) {
    for (const bool wide : {false, true}) {
        const io::PlainMesh text = ply(tetrahedron_ply(false, false, wide));
        EXPECT_EQ(text.ends, (std::vector<std::uint64_t>{3, 6, 9, 12}));
        EXPECT_EQ(text.vertices[2], (Point3d{0, 1.5, 0}));
        for (const bool big : {false, true}) {
            const io::PlainMesh binary = ply(tetrahedron_ply(true, big, wide));
            EXPECT_EQ(binary.vertices, text.vertices);
            EXPECT_EQ(binary.corners, text.corners);
            EXPECT_EQ(binary.rounded, !wide);
        }
    }
}

TEST(PlainMesh, PlyOfOtherProgramsIsRead) {
    // A header line without a keyword, an element of no interest, a line that ends early, and an unused vertex without a place.
    const io::PlainMesh mesh =
        ply("ply\nformat ascii 1.0\nMade by hand\nelement vertex 4\nproperty float x\nproperty float y\n"
            "property float z\nproperty list uchar int more\nelement edge 1\nproperty int a\nelement face 1\n"
            "property uchar red\nproperty list uchar int vertex_index\nend_header\n"
            "0 0 0\n1 0 0 2 7 8\n0 1 0 0\n5\n9\n255 3 0 1 2\n");
    EXPECT_EQ(mesh.vertices.size(), 4u);
    EXPECT_EQ(mesh.corners, (std::vector<std::uint32_t>{0, 1, 2}));
}

TEST(PlainMesh, PlySaysWhatIsWrong) {
    const auto refused = [](const std::string& text) {
        return error_of(ErrorCode::bad_input, [&] { (void)ply(text); });
    };
    const std::string whole = tetrahedron_ply(true, false, true);
    EXPECT_EQ(refused(whole.substr(0, whole.size() - 1)),
              "m.ply: ends at byte 361, in the middle of its elements; copy or save it again");
    EXPECT_EQ(refused("ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\nend_header\n"),
              "m.ply: its header says that it has 4000000000 elements 'vertex', but it is too short for them; copy or "
              "save it again");
    EXPECT_EQ(refused("ply\nformat binary 1.0\n"),
              "m.ply: line 2: the format is 'binary', not ascii, binary_little_endian or binary_big_endian");
    EXPECT_EQ(refused("ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nend_header\n"),
              "m.ply: its header gives vertices no property x, y or z; save it with all three");
    const std::string vertices =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
    const std::string places = "end_header\n0 0 0\n1 0 0\n0 1 0\n";
    const std::string faces = "element face 1\nproperty list uchar int vertex_indices\n";
    for (const auto& [text, why] : std::vector<std::pair<std::string, std::string>>{
             {"plx\n", "line 1: a PLY file begins with 'ply', not 'plx'"},
             {"ply\nproperty float x\n", "line 2: a property comes before the first element"},
             {"ply\nelement vertex 1\nproperty real x\n",
              "line 3: a property has the type 'real', not one of PLY: char, uchar, short, ushort, int, uint, float or "
              "double"},
             {"ply\nelement vertex 1\nproperty list float int x\n", "line 3: the length of a list is not an integer"},
             {vertices + "element face 1\nproperty int a\n" + places + "1\n",
              "its header gives faces no list 'vertex_indices'; save it with this name for the corners"},
             {vertices + faces + places + "3 0 1 3\n", "line 13: face 0 has the corner 3, but there are 3 vertices"},
             {vertices + faces + places + "-3 0 1 2\n", "line 13: a list has the impossible length -3"},
             {vertices + "element tristrips 1\nproperty list int int vertex_indices\n" + places + "3 0 1 2\n",
              "has triangle strips, which octopair does not read; save it with faces"}}) {
        EXPECT_EQ(refused(text), "m.ply: " + why);
    }
}

TEST(PlainMesh, CoordinatesBeyondTheirRangeAreRefused) {
    const std::string head =
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    const auto refused = [&](const std::string& rest) {
        return error_of(ErrorCode::bad_input, [&] { (void)ply(head + rest); });
    };
    EXPECT_EQ(refused("0 0 0\n1 0 0\n0 1\n5 5 5\n3 0 1 2\n"),
              "m.ply: vertex 2, which a face uses, has a coordinate that is not finite; repair the mesh");
    EXPECT_EQ(refused("0 0 0\n1 0 0\n0 1 0\n5 5 nan\n3 0 1 2\n"),
              "m.ply: line 13: a number is nan, not a finite number");
    const TemporaryDirectory directory;
    const std::string path = directory.file("m.obj");
    write_file(path, "v 0 0 0\nv 1e39 0 0\nv 0 1 0\nf 1 2 3\n");
    EXPECT_EQ(io::read_scene(path, {}).objects, 1u);
    for (const bool shapes : {false, true}) {
        EXPECT_EQ(error_of(ErrorCode::bad_input,
                           [&] {
                               (void)io::read_scene(path, {io::MeshObjects::triangle, shapes});
                           }),
                  path +
                      ": the coordinate 1e+39 is beyond the range of float32, which boxes of triangles have; use "
                      "--objects node");
    }
}

/// A triangle as a binary STL file.
std::string binary_stl(const std::string& header) {
    std::string bytes = header;
    bytes.resize(80, ' ');
    append(bytes, std::uint32_t(1));
    for (const float at : {0.F, 0.F, 1.F, 0.25F, 0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F, 0.F}) append(bytes, at);
    append(bytes, std::uint16_t(0));
    return bytes;
}

TEST(PlainMesh, StlIsTextOrBinary) {
    const std::string text =
        "solid a name\n facet normal 0 0 1\n  outer loop\n   vertex 0.25 0 0\n   vertex 1 0 0\n   vertex 0 1 0\n"
        "  endloop\n endfacet\nendsolid a name\nsolid\nendsolid\n";
    const auto solids = stl(text);
    ASSERT_EQ(solids.size(), 2u);
    EXPECT_EQ(solids[0].name, "a name");
    EXPECT_EQ(solids[0].triangles(), 1u);
    EXPECT_EQ(solids[1].triangles(), 0u);
    for (const std::string header : {"", "solid but binary"}) {
        const auto binary = stl(binary_stl(header));
        ASSERT_EQ(binary.size(), 1u);
        EXPECT_EQ(binary[0].vertices, solids[0].vertices);
    }
    const auto refused = [](const std::string& bytes) {
        return error_of(ErrorCode::bad_input, [&] { (void)stl(bytes); });
    };
    EXPECT_EQ(refused(binary_stl("").substr(0, 100)),
              "m.stl: says that it has 1 triangles, but 16 bytes (50 each) follow its header; save it again");
    EXPECT_EQ(refused("solid\nfacet normal 0 0 1\nvertex 1 2 3\n"),
              "m.stl: line 3: 'outer loop' is expected, not 'vertex'");
    EXPECT_EQ(refused("solid\nfacette\n"), "m.stl: line 2: 'facet' or 'endsolid' is expected, not 'facette'");
    EXPECT_EQ(refused("solid\nendsolid\nsolyd\n"), "m.stl: line 3: 'solid' is expected, not 'solyd'");
    std::string infinite = binary_stl("");
    infinite.replace(84 + 12, 4, "\x00\x00\x80\x7F", 4);
    EXPECT_EQ(refused(infinite), "m.stl: triangle 0 (at byte 84) has a coordinate that is not finite; repair the mesh");
    EXPECT_EQ(refused(""), "m.stl: has no solid: it is neither a text that begins with 'solid' nor a binary STL file");
}

TEST(PlainMesh, ObjHasObjectsAndGroups) {
    const std::string text =
        "# by hand\nmtllib a.mtl\nv .1 .1 .1\nv 1 0 0 1.0\nv 0 1 0 0.5 0.5 0.5\nvn 0 0 1\nvt 0 0\n"
        "o first part\nusemtl red\nf 1 2 3\no second\nv 0 0 1\nf 1/1/1 2//1 \\\n -1/1\n"
        "o first part\nusemtl blue\nf 4 3 2 1\ng lid\nl 1 2\ng lid\nf 2 3 4\n";
    const auto meshes = io::parse_obj({text, "m.obj", never});
    ASSERT_EQ(meshes.size(), 3u);
    EXPECT_EQ(meshes[0].name, "first part");
    EXPECT_EQ(meshes[0].triangles(), 3u);
    EXPECT_EQ(meshes[0].vertices[0], (Point3d{0.1, 0.1, 0.1}));
    EXPECT_EQ(meshes[1].name, "second");
    EXPECT_EQ(meshes[1].vertices, (std::vector<Point3d>{{0.1, 0.1, 0.1}, {1, 0, 0}, {0, 0, 1}}));
    EXPECT_EQ(meshes[2].name, "lid");
    EXPECT_EQ(meshes[2].ends, (std::vector<std::uint64_t>{2, 5}));  // a line and a triangle
    EXPECT_EQ(meshes[2].triangles(), 1u);
    EXPECT_EQ(io::parse_obj({"v 1 2 3\nv 4 5 6\n", "m.obj", never})[0].vertices.size(), 2u);
    const auto refused = [](const std::string& lines) {
        return error_of(ErrorCode::bad_input, [&] { (void)io::parse_obj({lines, "m.obj", never}); });
    };
    EXPECT_EQ(refused("v 0 0 0\nf 1 2 3\n"), "m.obj: line 2: a corner of a face is vertex 3, but the file has 1");
    EXPECT_EQ(refused("v 0 0 0\nf -2\n"), "m.obj: line 2: a corner of a face is vertex -2, but there are 1 before it");
    EXPECT_EQ(refused("v 0 0 0\nf 1 0\n"),
              "m.obj: line 2: a corner of a face is '0', not the number of a vertex; the first vertex is 1");
    EXPECT_EQ(refused("v 0 0\n"), "m.obj: line 1: the line ends where a coordinate should follow");
}

double area_of(const shape::Mesh& mesh) {
    double area = 0;
    for (const auto& [a, b, c] : mesh.triangles) {
        const Point3d &from = mesh.vertices[a], &second = mesh.vertices[b], &third = mesh.vertices[c];
        area += ((second[0] - from[0]) * (third[1] - from[1]) - (second[1] - from[1]) * (third[0] - from[0])) / 2;
    }
    return area;
}

TEST(PlainMesh, FacesAreCutWithinTheirOutline) {
    // A square, an L and a comb, either way round. All triangles turn like the face, and their areas sum up.
    const std::vector<std::pair<std::vector<Point3d>, double>> faces = {
        {{{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}}, 4},
        {{{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}}, 3},
        {{{0, 0, 0},
          {5, 0, 0},
          {5, 3, 0},
          {4, 3, 0},
          {4, 1, 0},
          {3, 1, 0},
          {3, 3, 0},
          {2, 3, 0},
          {2, 1, 0},
          {1, 1, 0},
          {1, 3, 0},
          {0, 3, 0}},
         11}};
    io::CrossingFaces crossing;
    for (const auto& [outline, area] : faces) {
        for (const bool turned : {false, true}) {
            for (std::size_t first = 0; first < outline.size(); ++first) {
                io::PlainMesh mesh;
                mesh.vertices = outline;
                for (std::size_t i = 0; i < outline.size(); ++i) {
                    const std::size_t at = (first + i) % outline.size();
                    mesh.corners.push_back(std::uint32_t(turned ? outline.size() - 1 - at : at));
                }
                mesh.end_face();
                const shape::Mesh cut = io::cut_into_triangles(mesh, crossing, never);
                EXPECT_EQ(cut.triangles.size(), outline.size() - 2);
                EXPECT_NEAR(area_of(cut), turned ? -area : area, 1e-12);
                for (const auto& triangle : cut.triangles) {
                    EXPECT_GE((turned ? -1 : 1) * area_of({cut.vertices, {triangle}}), 0);
                }
            }
        }
    }
    // A face that crosses itself, or lies in a line, is cut somehow.
    for (const std::vector<Point3d>& odd :
         {std::vector<Point3d>{{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}},
          std::vector<Point3d>{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}, {0.5, 0.5, 0.5}}}) {
        io::PlainMesh mesh;
        mesh.vertices = odd;
        for (std::size_t i = 0; i < odd.size(); ++i) mesh.corners.push_back(std::uint32_t(i));
        mesh.end_face();
        EXPECT_EQ(io::cut_into_triangles(mesh, crossing, never).triangles.size(), odd.size() - 2);
    }
}

TEST(PlainMesh, CuttingCanBeStopped) {
    io::CrossingFaces crossing;
    const io::PlainMesh mesh = off("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    (void)error_of(ErrorCode::cancelled, [&] { (void)io::cut_into_triangles(mesh, crossing, requested_stop()); });
}

TEST(PlainMesh, WorkAfterTheTextCanBeStopped) {
    const TemporaryDirectory directory;
    std::string solid = "solid", groups = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    for (int i = 0; i < 4096; ++i) {
        solid += " facet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop endfacet";
        groups += "g " + std::to_string(i) + "\nf 1 2 3\n";
    }
    write_file(directory.file("m.stl"), solid + " endsolid");
    write_file(directory.file("m.obj"), groups);
    for (const auto& [name, last] : std::vector<std::pair<std::string, double>>{{"m.stl", 0.9}, {"m.obj", 1}}) {
        // The stop comes when the text is read, and before the meshes are named.
        std::stop_source source;
        const auto progress = [&, last = last](double part) {
            if (part >= last) source.request_stop();
        };
        (void)error_of(ErrorCode::cancelled, [&] {
            (void)io::read_scene(directory.file(name), {io::MeshObjects::node, false, progress}, source.get_token());
        });
        EXPECT_TRUE(source.stop_requested()) << name;
    }
}

TEST(PlainMesh, CrossingFacesAreTold) {
    const TemporaryDirectory directory;
    const std::string vertices = "v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 1 0\n";
    const std::string path = directory.file("faces.obj");
    const auto warnings = [&](const std::string& faces, io::MeshObjects objects) {
        write_file(path, vertices + faces);
        return io::read_scene(path, {objects, true}).warnings;
    };
    const std::vector<std::string> one = {
        path +
        ": 1 face crosses itself or folds (the first: face 1 of 'faces.obj/part'); its triangles may be wrong, "
        "so divide it in the file"};
    for (const io::MeshObjects objects : {io::MeshObjects::node, io::MeshObjects::triangle}) {
        EXPECT_EQ(warnings("o part\nf 1 3 2 4\nf 1 2 3\nf 1 3 1 2 4\n", objects), std::vector<std::string>{});
        EXPECT_EQ(warnings("o part\nf 1 3 2 4\nf 1 2 3 4\n", objects), one);
        const std::vector<std::string> several = warnings("f 1 2 3 4\nf 4 3 2 1\n", objects);
        ASSERT_EQ(several.size(), 1u);
        EXPECT_EQ(several[0],
                  path +
                      ": 2 faces cross themselves or fold (the first: face 0 of 'faces.obj'); their triangles "
                      "may be wrong, so divide them in the file");
    }
    write_file(directory.file("scene.json"), R"({"shapes": {"mesh": {"type": "mesh", "file": "faces.obj"}},
        "objects": [{"name": "a", "shape": "mesh"}]})");
    EXPECT_EQ(io::read_scene(directory.file("scene.json"), {io::MeshObjects::node, true}).warnings.size(), 1u);
}

TEST(PlainMesh, ScenesHaveTheBoxesOfUsedVertices) {
    const TemporaryDirectory directory;
    write_file(directory.file("far.off"),
               "OFF\n4 1 0\n450000.1 5410000.2 0\n450001.1 5410000.2 0\n450000.1 5410001.2 0\n9 9 9\n3 0 1 2\n");
    const io::LoadedScene scene = io::read_scene(directory.file("far.off"), {io::MeshObjects::node, true});
    const auto& boxes = std::get<Buffer<Box3d>>(scene.boxes);
    ASSERT_EQ(boxes.size(), 1u);
    EXPECT_EQ(boxes.data()[0].min[0], 450000.1);
    EXPECT_EQ(boxes.data()[0].max[1], 5410001.2);
    EXPECT_EQ(scene.names, std::vector<std::string>{"far.off"});
    EXPECT_EQ(scene.largest_rounded, 0);
    ASSERT_TRUE(scene.shapes.has_value());
    EXPECT_EQ(std::get<shape::Mesh>(scene.shapes->shapes[0]).triangles.size(), 1u);
    const io::LoadedScene triangles = io::read_scene(directory.file("far.off"), {io::MeshObjects::triangle, false});
    EXPECT_EQ(std::get<Buffer<Box3f>>(triangles.boxes).data()[0].min[0], 450000.1F);
}

TEST(PlainMesh, ReadersTellTheirProgress) {
    constexpr int points = 10'000;
    std::string text = "OFF\n" + std::to_string(points) + " 0 0\n";
    for (int i = 0; i < points; ++i) text += std::to_string(i) + " 0 0\n";
    const TemporaryDirectory directory;
    write_file(directory.file("p.off"), text);
    std::vector<double> parts;
    (void)io::read_scene(directory.file("p.off"),
                         {io::MeshObjects::node, false, [&](double part) { parts.push_back(part); }});
    ASSERT_GE(parts.size(), 2u);
    EXPECT_TRUE(std::is_sorted(parts.begin(), parts.end()));
    EXPECT_GT(parts.front(), 0);
    EXPECT_LT(parts.front(), 0.5);
    EXPECT_LE(parts.back(), 1);
}

TEST(PlainMesh, JointScenesHaveTheAxisOfAllAndTheUnitOfTheFirst) {
    const io::SceneSpace metres{io::UpAxis::y, "m"};
    const auto joint = [&](const io::SceneSpace& other) {
        std::vector<io::LoadedScene> scenes(2);
        scenes[0].space = metres;
        scenes[0].largest_rounded = 3;
        scenes[1].space = other;
        const io::LoadedScene joined = io::join_scenes(scenes, std::vector<std::string>{"a", "b"});
        EXPECT_EQ(joined.largest_rounded, 3);
        return joined.space;
    };
    EXPECT_EQ(joint(metres), metres);
    EXPECT_EQ(joint({io::UpAxis::z, "m"}), (io::SceneSpace{io::UpAxis::unknown, "m"}));
    EXPECT_EQ(joint({}), (io::SceneSpace{io::UpAxis::unknown, "m"}));
}

}  // namespace
}  // namespace octopair::test
