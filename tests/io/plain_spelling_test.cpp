// Tests that the readers of OBJ, OFF, STL and PLY read what programs write: names, line ends, spellings of keywords, headers that are
// wrong. What is not read is told in a warning.
#include <gtest/gtest.h>

#include <bit>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "io/meshes/plain/plain_mesh.hpp"
#include "io/scene_reader.hpp"
#include "io/temporary.hpp"

namespace octopair::test {
namespace {

/// Result of a reader for a text.
struct ReadMeshes {
    std::vector<io::PlainMesh> meshes;
    std::vector<std::string> warnings;

    std::vector<std::string> names() const {
        std::vector<std::string> names;
        for (const io::PlainMesh& mesh : meshes) names.push_back(mesh.name);
        return names;
    }
    std::uint64_t triangles() const {
        std::uint64_t count = 0;
        for (const io::PlainMesh& mesh : meshes) count += mesh.triangles();
        return count;
    }
};

const std::stop_token never_stopped;
using Texts = std::vector<std::string>;

ReadMeshes read_obj(const std::string& text) {
    ReadMeshes read;
    read.meshes = io::parse_obj({text, "m.obj", never_stopped, {}, &read.warnings});
    return read;
}
ReadMeshes read_stl(const std::string& bytes) {
    ReadMeshes read;
    read.meshes = io::parse_stl({bytes, "m.stl", never_stopped, {}, &read.warnings});
    return read;
}
ReadMeshes read_off(const std::string& text) {
    ReadMeshes read;
    read.meshes = {io::parse_off({text, "m.off", never_stopped, {}, &read.warnings})};
    return read;
}
ReadMeshes read_ply(const std::string& bytes) {
    ReadMeshes read;
    read.meshes = {io::parse_ply({bytes, "m.ply", never_stopped, {}, &read.warnings})};
    return read;
}
template <typename Read>
std::string refusal_of(const Read& read, const std::string& text) {
    return error_of(ErrorCode::bad_input, [&] { (void)read(text); });
}

std::string with_ends(std::string text, const std::string& end) {
    for (std::size_t at = text.find('\n'); at != std::string::npos; at = text.find('\n', at + end.size()))
        text.replace(at, 1, end);
    return text;
}

const std::string triangle_vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

TEST(PlainSpelling, ObjNamesKeepTheirHash) {
    const ReadMeshes read =
        read_obj(triangle_vertices +
                 "o bolt#1 # M8\nusemtl RAL#7035\nf 1 2 3# first\no bolt#2\nf 1 2 3 # 4 5\n#o nut\nf 3 2 1\n");
    EXPECT_EQ(read.names(), (Texts{"bolt#1 # M8", "bolt#2"}));
    EXPECT_EQ(read.meshes[0].materials, std::set<std::string>{"RAL#7035"});
    EXPECT_EQ(read.triangles(), 3u);
}

TEST(PlainSpelling, EqualObjGroupsAreOneMesh) {
    for (const std::string keyword : {"o", "g"}) {
        std::string text = triangle_vertices;
        for (const std::string name : {"tank", "pipe", "tank"}) text += keyword + " " + name + "\nf 1 2 3\n";
        const ReadMeshes read = read_obj(text);
        EXPECT_EQ(read.names(), (Texts{"tank", "pipe"}));
        EXPECT_EQ(read.meshes[0].triangles(), 2u);
    }
    // Without a name, a group is what comes before all groups. A group with several names is one of its own.
    const ReadMeshes read =
        read_obj(triangle_vertices + "f 1 2 3\ng a\nf 1 2 3\ng\nf 1 2 3\ng a b\nf 1 2 3\ng b a\nf 1 2 3\n");
    EXPECT_EQ(read.names(), (Texts{"", "a", "a b", "b a"}));
    EXPECT_EQ(read.meshes[0].triangles(), 2u);
}

TEST(PlainSpelling, ObjGroupsBelongToTheirObject) {
    const std::string face = "f 1 2 3\n";
    // Groups have their own names, unless several objects have a group of this name.
    EXPECT_EQ(read_obj(triangle_vertices + "o car\ng left\n" + face + "g right\n" + face).names(),
              (Texts{"left", "right"}));
    EXPECT_EQ(read_obj(triangle_vertices + "o A\ng x\n" + face + "o B\ng x\n" + face + "g y\n" + face).names(),
              (Texts{"A/x", "B/x", "y"}));
    // A new object ends the group, and faces before the first group are the object's own.
    const ReadMeshes read =
        read_obj(triangle_vertices + "g x\n" + face + "o A\n" + face + "g x\n" + face + "g\n" + face + "o A\n" + face);
    EXPECT_EQ(read.names(), (Texts{"x", "A", "A/x"}));
    EXPECT_EQ(read.meshes[1].triangles(), 3u);
    // A group with the name of its object is the object's own mesh, and so is a group before the object.
    EXPECT_EQ(read_obj(triangle_vertices + "g A\n" + face + "o A\n" + face + "g A\n" + face).names(), Texts{"A"});
}

TEST(PlainSpelling, ObjKeywordsMayBeCapitals) {
    const ReadMeshes read =
        read_obj("MTLLIB a.mtl\nO Part\nV 0 0 0\nV 1 0 0\nV 0 1 0\nVN 0 0 1\nFO 1//1 2//1 3//1\nF 1 2 3\n");
    EXPECT_EQ(read.names(), Texts{"Part"});
    EXPECT_EQ(read.triangles(), 2u);
    EXPECT_EQ(read.warnings, Texts());
    // In a file with small letters, capitals are unknown.
    EXPECT_EQ(read_obj(triangle_vertices + "V 9 9 9\nf -3 -2 -1\nF 1 2 3\n").warnings,
              Texts{"m.obj: has keywords that OBJ does not have: 2 lines are not read, the first is line 4 ('V')"});
}

TEST(PlainSpelling, ObjTellsWhatItDoesNotRead) {
    const std::string ignored =
        "vt 0 0\nvn 0 0 1\nvp 0\ns 1\nmg 0\nmtllib a\nusemap a\nlod 1\nbevel on\nc_interp off\nd_interp "
        "off\nshadow_obj a\n"
        "trace_obj a\nmaplib a\ncsh a\nctech a\nstech a\n";
    EXPECT_EQ(read_obj(triangle_vertices + ignored + "f 1 2 3\n").warnings, Texts());
    const ReadMeshes read = read_obj("# 1\n" + triangle_vertices +
                                     "f 1 2 3\ncall b.obj\ncstype bezier\ndeg 3\ncurv 0 1 1 2\nend\n"
                                     "ext\x01"
                                     "A 1\nnext_ext\n");
    EXPECT_EQ(read.triangles(), 1u);
    EXPECT_EQ(
        read.warnings,
        (Texts{
            "m.obj: has keywords that OBJ does not have: 2 lines are not read, the first is line 11 ('ext?A')",
            "m.obj: has free-form curves or surfaces; save them as polygons: 4 lines are not read, the first is line 7 "
            "('cstype')",
            "m.obj: calls other files: 1 line is not read, the first is line 6 ('call')"}));
}

TEST(PlainSpelling, TextThatIsNoObjIsRefused) {
    for (const auto& [text, line, word] : std::vector<std::tuple<std::string, int, std::string>>{
             {"Dear reader,\nthis is a letter.\n", 1, "Dear"},
             {"\n# A page\n\nWords.\n", 4, "Words."},
             {"\x7f"
              "ELF\x02\x01\x01",
              1, "?ELF???"},
             {"mtllib a.mtl\ng part\nvertex 0 0 0\n", 3, "vertex"}}) {
        EXPECT_EQ(
            refusal_of(read_obj, text),
            "m.obj: line " + std::to_string(line) + ": '" + word +
                "' is no keyword of OBJ, and the file has no vertices; if it is of another format, give it the ending "
                "of that format");
    }
    EXPECT_EQ(refusal_of(read_obj, "\n \r\n"), "m.obj: is empty");
    EXPECT_EQ(read_obj("# Nothing was chosen.\n").triangles(), 0u);
}

TEST(PlainSpelling, ObjLinesContinue) {
    // A comment does not; its backslash is often one of a path.
    const ReadMeshes read =
        read_obj("# C:\\parts\\\nv 0 0 0\nv 1 \\\n 0\\\n 0\nv 0 1 0\no a \\\nb\nf 1 2\\\n 3 # \\\n 9\n\\\n\n");
    EXPECT_EQ(read.names(), Texts{"a  b"});
    EXPECT_EQ(read.warnings, Texts());
    EXPECT_EQ(read.meshes[0].corners, (std::vector<std::uint32_t>{0, 1, 2}));
    EXPECT_EQ(read.meshes[0].vertices[1], (Point3d{1, 0, 0}));
    EXPECT_EQ(refusal_of(read_obj, "v 0 \\\n 0 \\\n 0\nv 1 2\n"),
              "m.obj: line 4: the line ends where a coordinate should follow");
    EXPECT_EQ(
        refusal_of(read_obj, "v 0 0 0\nv 0,5 0 0\n"),
        "m.obj: line 2: a coordinate is '0,5', not a number; write numbers with a point and separate them with spaces");
}

const std::string face_off = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
const std::string facet =
    "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
const std::string face_ply =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
    "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

TEST(PlainSpelling, TextsHaveAnyLineEndAndAByteOrderMark) {
    for (const std::string end : {"\n", "\r\n", "\r"}) {
        for (const std::string mark : {"", "\xef\xbb\xbf"}) {
            for (const ReadMeshes& read :
                 {read_obj(mark + with_ends(triangle_vertices + "f 1 2 3\n", end)),
                  read_off(mark + with_ends(face_off, end)), read_ply(mark + with_ends(face_ply, end)),
                  read_stl(mark + with_ends("solid\n" + facet + "endsolid\n", end))}) {
                ASSERT_EQ(read.triangles(), 1u);
                EXPECT_EQ(read.meshes[0].vertices, (std::vector<Point3d>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
                EXPECT_EQ(read.warnings, Texts());
            }
        }
    }
}

TEST(PlainSpelling, StlTextsAreReadInAllSpellings) {
    for (const std::string text : {"SOLID PART\nFACET NORMAL 0 0 1\nOUTER LOOP\nVERTEX 0 0 0\nVERTEX 1 0 0\nVERTEX 0 1 "
                                   "0\nENDLOOP\nENDFACET\nENDSOLID "
                                   "PART\n",
                                   "\n  Solid a\n facet normal 0 0 1\n  outer loop\n vertex 0 0 0\nvertex 1 0 "
                                   "0\nvertex 0 1 0\n end loop\n end  facet\n"
                                   "end solid a\n",
                                   "solid a facet\ncolor 1 0 0\nfacet normal -nan(ind) 0 0 outer loop vertex 0 0 0 "
                                   "vertex 1 0 0 red vertex 0 1 0\nendloop "
                                   "endfacet endsolid a\n",
                                   "solid a\nfacet\nCOLOUR 1 0 0\nouter loop of three\nvertex 0 0 0\nvertex 1 0 "
                                   "0\nvertex 0 1 0\nendloop\nendfacet\nendsolid"}) {
        const ReadMeshes read = read_stl(text);
        ASSERT_EQ(read.meshes.size(), 1u) << text;
        EXPECT_EQ(read.meshes[0].triangles(), 1u) << text;
        EXPECT_EQ(read.meshes[0].vertices[1], (Point3d{1, 0, 0}));
        EXPECT_EQ(read.warnings, Texts());
    }
    const std::string long_line(90, '-');
    EXPECT_EQ(refusal_of(read_stl, facet + facet), "m.stl: line 1: 'solid' is expected, not 'facet'");
    EXPECT_EQ(refusal_of(read_stl, long_line),
              "m.stl: line 1: 'solid' is expected, not '" + long_line.substr(0, 40) + "'");
    EXPECT_EQ(refusal_of(read_stl, "solid\nfacet normal 0 0 1\nouter lap\n"),
              "m.stl: line 3: 'outer loop' is expected, not 'lap'");
    EXPECT_EQ(refusal_of(read_stl, "solid\n" + facet),
              "m.stl: the file ends after line 8, where 'facet' or 'endsolid' should follow; copy or save it again");
    EXPECT_EQ(refusal_of(read_stl, "solid\nend facet\n"),
              "m.stl: line 2: 'facet' or 'endsolid' is expected, not 'facet'");
}

/// A binary STL file of two triangles that states another number of them.
std::string two_triangles(const std::string& header, std::uint32_t stated, const std::string& tail) {
    std::string bytes = header;
    bytes.resize(80, ' ');
    for (int i = 0; i < 4; ++i) bytes += char(stated >> (8 * i) & 0xFF);
    for (int triangle = 0; triangle < 2; ++triangle) {
        for (const float at : {0.F, 0.F, 1.F, 0.25F, 0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F, 0.F}) {
            for (int i = 0; i < 4; ++i) bytes += char(std::bit_cast<std::uint32_t>(at) >> (8 * i) & 0xFF);
        }
        bytes += std::string(2, '\0');
    }
    return bytes + tail;
}

TEST(PlainSpelling, TheSizeOfBinaryStlDecides) {
    for (const std::string header : {"binary", "solid part", "SOLID\n"}) {
        EXPECT_EQ(read_stl(two_triangles(header, 2, "")).triangles(), 2u);
        const ReadMeshes uncounted = read_stl(two_triangles(header, 0, ""));
        EXPECT_EQ(uncounted.triangles(), 2u);
        EXPECT_EQ(uncounted.warnings,
                  Texts{"m.stl: its header says that it has 0 triangles; the 2 that follow are read"});
        const ReadMeshes longer = read_stl(two_triangles(header, 2, "END"));
        EXPECT_EQ(longer.triangles(), 2u);
        EXPECT_EQ(longer.warnings, Texts{"m.stl: the 3 bytes after its 2 triangles are not read"});
        EXPECT_EQ(refusal_of(read_stl, two_triangles(header, 1, "")),
                  "m.stl: says that it has 1 triangles, but 2 follow its header; save it again");
        EXPECT_EQ(refusal_of(read_stl, two_triangles(header, 3, "")),
                  "m.stl: says that it has 3 triangles, but 2 follow its header; save it again");
        EXPECT_EQ(refusal_of(read_stl, two_triangles(header, 0, "END")),
                  "m.stl: says that it has 0 triangles, but 103 bytes (50 each) follow its header; save it again");
    }
    EXPECT_EQ(refusal_of(read_stl, std::string(80, '\0')),
              "m.stl: ends in its header; a binary STL file has one of 84 bytes. Copy or save the file again");
}

TEST(PlainSpelling, OffHeadersAreReadInAllSpellings) {
    const std::string rest = face_off.substr(4);
    for (const std::string header :
         {"OFF", "OFF ", "off\n", "# by hand\n\n OFF # keyword\n", "", "STCNOFF\n", "NCSTOFF ", "coff\n", "stoff\n"}) {
        EXPECT_EQ(read_off(header + rest).triangles(), 1u) << header;
    }
    for (const std::string header : {"4OFF", "nOFF", "noff", "4nOFF", "OFFX", "CC", "PLY", "OFF8x"}) {
        EXPECT_EQ(refusal_of(read_off, header + "\n" + rest),
                  "m.off: line 1: the header is '" + header +
                      "'; octopair reads OFF with any of ST, C and N before it, that is with three coordinates");
    }
    EXPECT_EQ(refusal_of(read_off, "off binary\n"),
              "m.off: line 1: octopair reads OFF files as text only; save it as text");
    EXPECT_EQ(
        read_off(face_off + "\n3 2 1 0\n").warnings,
        Texts{"m.off: from line 8 on it is not read, because the header says that it has 3 vertices and 1 faces"});
}

TEST(PlainSpelling, OffIsAStreamOfNumbers) {
    const std::vector<Point3d> places = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    for (const std::string text :
         {"OFF 3 2 0 0 0 0 1 0 0 0 1 0 3 0 1 2 3 2 1 0",
          "OFF\n3\n2\n0\n0\n0 0 1\n0 # c\n0 0\n1 0\n3\n0\n1 2\n3 2\n1 0\n",
          "OFF\n3 2\n0. 0 0 1 0 0\n0 1 0\n3 0 1 2 255 0 0\n3 2 1 0", "3 2 0\n0 0 0 1 0 0 0 1 0\n3 0 1 2\n3 2 1 0\n",
          "NOFF 3 2 0\n0 0 0\n0 0 1\n1 0 0\n0 0 1\n0 1 0\n0 0 1\n3 0 1 2\n3 2 1 0\n",
          "COFF 3 2 0\n0 0 0 255 255\n255 1 0 0 1 2 3\n0 1 0 7 8 9\n3 0 1 2\n3 2 1 0\n",
          "OFF 3 2 0 0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 2 1 0\n",
          "STCNOFF 3 2 0 0 0 0 0 0 1 .5 .5 .5 1 0 0\n1 0 0 0 0 1 .5 .5 .5 1 0 0 0 1 0 0 0 1 .5 .5 .5 1 0 0\n"
          "3 0 1\n2\n3 2 1 0\n"}) {
        const ReadMeshes read = read_off(text);
        EXPECT_EQ(read.meshes[0].vertices, places) << text;
        EXPECT_EQ(read.meshes[0].corners, (std::vector<std::uint32_t>{0, 1, 2, 2, 1, 0})) << text;
        EXPECT_EQ(read.warnings, Texts()) << text;
    }
    // Words that the keyword does not announce are skipped in a file that has a line for each vertex.
    EXPECT_EQ(read_off("OFF\n3 1 0\n0 0 0 9 9\n1 0 0 9 9\n0 1 0 9 9\n3 0 1 2\n").meshes[0].vertices, places);
    EXPECT_EQ(refusal_of(read_off, "OFF 3 1 0\n0 0 0 1\n0 0 0 x 0\n3 0 1 2\n"),
              "m.off: line 3: a coordinate is 'x', not a number");
    EXPECT_EQ(refusal_of(read_off, "OFF 3 1 0 0 0 0 1 0 0 0 1 0\n3 0\n1 3\n"),
              "m.off: line 3: a corner is 3, but at most 2 is possible; save the file again");
}

TEST(PlainSpelling, PlyTextIsAStreamOfNumbers) {
    const std::string head = face_ply.substr(0, face_ply.find("0 0 0"));
    for (const std::string rest :
         {"0 0 0 1 0 0 0 1 0 3 0 1 2", "0\n0\n0 1\n\n0 0\n0 1\n0\n3\n0 1\n2\n", "0 0 0 1 0 0\n0 1 0\n3 0\n1 2\n"}) {
        const ReadMeshes read = read_ply(head + rest);
        EXPECT_EQ(read.meshes[0].vertices, (std::vector<Point3d>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}})) << rest;
        EXPECT_EQ(read.meshes[0].corners, (std::vector<std::uint32_t>{0, 1, 2})) << rest;
        EXPECT_EQ(read.warnings, Texts()) << rest;
    }
    EXPECT_EQ(refusal_of(read_ply, head + "0 0 0 1 0 0\n0 1 0\n3 0\n1 9\n"),
              "m.ply: line 13: face 0 has the corner 9, but there are 3 vertices");
    EXPECT_EQ(refusal_of(read_ply, head + "0\n0\n0\n1\n0\n0\n0\n1\nnone\n"),
              "m.ply: line 18: a number is 'none', not a number");
    EXPECT_EQ(
        read_ply("ply\nformat ascii 1.0\nelement vertex 1\nproperty int64 x\nproperty uint64 y\nproperty int64 z\n"
                 "end_header\n-7 8 9\n")
            .meshes[0]
            .vertices,
        (std::vector<Point3d>{{-7, 8, 9}}));
}

TEST(PlainSpelling, StlTextIsAStreamOfWords) {
    const std::string facet_in_line =
        " facet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop endfacet";
    const std::string broken =
        "facet\nnormal\n0 0\n-nan(ind)\nouter\nloop\nvertex\n0 0\n0\nvertex 1\n0 0 vertex 0 1 0\nendloop\nendfacet\n";
    for (const auto& [text, names] : std::vector<std::pair<std::string, Texts>>{
             {"solid" + facet_in_line + " endsolid", {""}},
             {"solid a part" + facet_in_line + " endsolid a part solid b" + facet_in_line + " endsolid b\n",
              {"a part", "b"}},
             {"solid a" + facet_in_line + " endsolid solid b" + facet_in_line + " endsolid", {"a", "b"}},
             {"solid a" + facet_in_line + " endsolid other solid b" + facet_in_line + " endsolid", {"a", "b"}},
             {"solid a" + facet_in_line + " endsolid a  solid b end solid \t b\tsolid c endsolid c", {"a", "b", "c"}},
             {"solid solid a\n" + broken + "endsolid solid a\n", {"solid a"}},
             {"solid a facet\n" + broken + "end\nsolid a facet\n", {"a facet"}}}) {
        const ReadMeshes read = read_stl(text);
        EXPECT_EQ(read.names(), names) << text;
        EXPECT_GE(read.triangles(), 1u) << text;
        EXPECT_EQ(read.meshes[0].vertices, (std::vector<Point3d>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}})) << text;
    }
    EXPECT_EQ(read_stl("solid a endsolid a solid b endsolid\n").names(), (Texts{"a", "b"}));
    EXPECT_EQ(refusal_of(read_stl, "solid\nfacet\nnormal 0\n0 1\nouter lap\n"),
              "m.stl: line 5: 'outer loop' is expected, not 'lap'");
    EXPECT_EQ(refusal_of(read_stl, "solid\nfacet normal 0 0 1\nred\nouter loop\n"),
              "m.stl: line 3: 'outer loop' is expected, not 'red'");
    EXPECT_EQ(refusal_of(read_stl, "solid\nfacet normal 0 0 1 outer loop vertex 0 0\nvertex\n"),
              "m.stl: line 3: a coordinate is 'vertex', not a number");
}

TEST(PlainSpelling, NumbersOfFortranAreRead) {
    const std::string text = "OFF\n1 0 0\n1.D+02 -.5d-1 +1d0\n";
    EXPECT_EQ(read_off(text).meshes[0].vertices, (std::vector<Point3d>{{100, -0.05, 1}}));
    for (const std::string word : {"d", "d1", "1d", "1dd", "1.5d+", "x1d0", "1e5d3"}) {
        EXPECT_EQ(refusal_of(read_obj, "v 0 0 " + word + "\n"),
                  "m.obj: line 1: a coordinate is '" + word + "', not a number");
    }
}

TEST(PlainSpelling, NoTwoMeshesHaveTheSameName) {
    const TemporaryDirectory directory;
    const std::string obj = directory.file("m.obj"), stl = directory.file("m.stl"), face = "f 1 2 3\n";
    write_file(obj, triangle_vertices + "o A\ng x\n" + face + "o B\ng x\n" + face + "o A/x\n" + face);
    EXPECT_EQ(io::read_scene(obj, {}).names, (Texts{"m.obj/A/x", "m.obj/B/x", "m.obj/A/x#2"}));
    std::string solids;
    for (const std::string name : {"a", "", "a", "#1", "a#2"}) solids += "solid " + name + "\n" + facet + "endsolid\n";
    write_file(stl, solids);
    EXPECT_EQ(io::read_scene(stl, {}).names, (Texts{"m.stl/a", "m.stl/#1", "m.stl/a#2", "m.stl/#1#3", "m.stl/a#2#4"}));
    EXPECT_EQ(io::read_scene(stl, {io::MeshObjects::triangle, true}).triangles->owner_names[2], "m.stl/a#2");
}

TEST(PlainSpelling, PlyElementsComeInAnyOrder) {
    const ReadMeshes read = read_ply(
        "ply\nformat ascii 1.0\nobj_info a\nelement face 2\nproperty list uint8 double vertex_index\nproperty float x\n"
        "element nothing 3\nelement edge 1\nproperty list char short a\nproperty float b\nelement vertex 3\nproperty "
        "list int8 int c\n"
        "property short z\nproperty float32 x\nproperty float64 y\nend_header\n"
        "3 0 1 2.0 7\n3 2 1 0 7\n2 5 5 nan\n1 1 0 0 0\n0 0 1 0\n0 0 0 1\n");
    EXPECT_EQ(read.triangles(), 2u);
    EXPECT_EQ(read.meshes[0].vertices, (std::vector<Point3d>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
    const std::string faces_first =
        "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_indices\nelement vertex 3\n"
        "property float x\nproperty float y\nproperty float z\nend_header\n";
    EXPECT_EQ(refusal_of(read_ply, faces_first + "3 0 1 3\n0 0 0\n1 0 0\n0 1 0\n"),
              "m.ply: line 10: face 0 has the corner 3, but there are 3 vertices");
}

TEST(PlainSpelling, PlyTellsWhatIsLostOrMissing) {
    EXPECT_EQ(read_ply(face_ply + "3 2 1 0\n").warnings,
              Texts{"m.ply: from line 14 on it is not read, because its header says that it ends before"});
    const std::string points =
        "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty char x\nproperty char y\n"
        "property char z\nelement face 0\nend_header\n";
    EXPECT_EQ(read_ply(points + "\x01\x02\x03").meshes[0].vertices, (std::vector<Point3d>{{1, 2, 3}}));
    EXPECT_EQ(read_ply(points + "\x01\x02\x03\r\n").warnings, Texts());
    EXPECT_EQ(read_ply(points + "\x01\x02\x03\x04\x05").warnings,
              Texts{"m.ply: the last 2 bytes are not read, because its header says that it ends before"});
    const std::string colours_first =
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty char x\nproperty char y\nproperty char z\nelement face 1\n"
        "property uchar red\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n";
    EXPECT_EQ(refusal_of(read_ply, colours_first + "255\n"), "m.ply: line 12: face 0 ends before its corners");
    EXPECT_EQ(refusal_of(read_ply, colours_first.substr(0, colours_first.find("element face")) +
                                       "property list char char a\nend_header\n0 0 0 2 7\n"),
              "m.ply: line 9: the line ends where a number should follow");
}

TEST(PlainSpelling, WarningsReachTheScene) {
    const TemporaryDirectory directory;
    const std::string mesh = directory.file("m.obj"), scene = directory.file("s.json");
    write_file(mesh, triangle_vertices + "f 1 2 3\nvendor\n");
    const Texts warnings = {
        mesh + ": has keywords that OBJ does not have: 1 line is not read, the first is line 5 ('vendor')"};
    EXPECT_EQ(io::read_scene(mesh, {}).warnings, warnings);
    EXPECT_EQ(io::read_scene(mesh, {io::MeshObjects::triangle, false}).warnings, warnings);
    const std::string object = R"({"shape":{"type":"mesh","file":"m.obj"}})";
    write_file(scene, "\xef\xbb\xbf{\"objects\":[" + object + ",\r" + object + "]}");
    EXPECT_EQ(io::read_scene(scene, {}).warnings, warnings);
}

}  // namespace
}  // namespace octopair::test
