// Tests that the axes of formats that Assimp reads are those of the file. Each file has a block of 1 x 2 x 4 at the origin.
#include <gtest/gtest.h>

#include "io/formats/format_table.hpp"
#include "io/meshes/assimp/mesh_reader.hpp"
#include "io/temporary.hpp"

namespace octopair::test {
namespace {

using BlockTriangle = std::array<int, 3>;
using namespace std::string_literals;

std::array<int, 3> block_corner(int i) { return {i & 1, 2 * (i >> 1 & 1), 4 * (i >> 2 & 1)}; }

const std::array<BlockTriangle, 12> block_triangles = {{{0, 2, 3},
                                                        {0, 3, 1},
                                                        {4, 5, 7},
                                                        {4, 7, 6},
                                                        {0, 1, 5},
                                                        {0, 5, 4},
                                                        {2, 6, 7},
                                                        {2, 7, 3},
                                                        {0, 4, 6},
                                                        {0, 6, 2},
                                                        {1, 3, 7},
                                                        {1, 7, 5}}};

/// Joins the text of each of the 8 corners. `#` becomes the number, and `x`, `y` and `z` the coordinates.
std::string for_corners(const std::string& form) {
    std::string text;
    for (int i = 0; i < 8; ++i) {
        for (const char c : form) {
            const bool coordinate = c >= 'x' && c <= 'z';
            text += c == '#'     ? std::to_string(i)
                    : coordinate ? std::to_string(block_corner(i)[std::size_t(c - 'x')])
                                 : std::string(1, c);
        }
    }
    return text;
}

/// Joins the text of each of the 12 block_triangles. `#` becomes the number; 1, 2 and 3 in braces, as in {1}, become the corners.
std::string for_triangles(const std::string& form) {
    std::string text;
    for (std::size_t i = 0; i < block_triangles.size(); ++i) {
        for (std::size_t at = 0; at < form.size(); ++at) {
            const bool place = form[at] == '{' && at + 2 < form.size() && form[at + 2] == '}' && form[at + 1] >= '1' &&
                               form[at + 1] <= '3';
            if (place) text += std::to_string(block_triangles[i][std::size_t(form[at + 1] - '1')]);
            if (form[at] == '#') text += std::to_string(i);
            if (!place && form[at] != '#') text += form[at];
            if (place) at += 2;
        }
    }
    return text;
}

/// Joins a text for each corner of each triangle, with the coordinates as in for_corners().
std::string for_triangle_corners(const std::string& before, const std::string& form) {
    std::string text;
    for (const BlockTriangle& triangle : block_triangles) {
        text += before;
        for (const int i : triangle) {
            for (const char c : form)
                text +=
                    c >= 'x' && c <= 'z' ? std::to_string(block_corner(i)[std::size_t(c - 'x')]) : std::string(1, c);
        }
    }
    return text;
}

std::string dxf_block() {
    std::string text = "0\nSECTION\n2\nENTITIES\n";
    for (const BlockTriangle& triangle : block_triangles) {
        text += "0\n3DFACE\n8\n0\n";
        for (int k = 0; k < 4; ++k) {
            const auto place = block_corner(triangle[std::size_t(std::min(k, 2))]);
            for (int axis = 0; axis < 3; ++axis)
                text += std::to_string(10 * (axis + 1) + k) + '\n' + std::to_string(place[std::size_t(axis)]) + '\n';
        }
    }
    return text + "0\nENDSEC\n0\nEOF\n";
}

std::string ase_block() {
    return "*3DSMAX_ASCIIEXPORT 200\n*GEOMOBJECT {\n*NODE_NAME \"a\"\n*NODE_TM {\n*NODE_NAME \"a\"\n*TM_ROW0 1 0 "
           "0\n*TM_ROW1 0 1 0\n"
           "*TM_ROW2 0 0 1\n*TM_ROW3 0 0 0\n}\n*MESH {\n*MESH_NUMVERTEX 8\n*MESH_NUMFACES 12\n*MESH_VERTEX_LIST {\n" +
           for_corners("*MESH_VERTEX # x y z\n") + "}\n*MESH_FACE_LIST {\n" +
           for_triangles("*MESH_FACE #: A: {1} B: {2} C: {3} AB: 1 BC: 1 CA: 1 *MESH_SMOOTHING 1 *MESH_MTLID 0\n") +
           "}\n}\n}\n";
}

std::string direct_x_block() {
    std::string text = "xof 0303txt 0032\nMesh m {\n8;\n" + for_corners("x;y;z;,\n") + ";\n12;\n" +
                       for_triangles("3;{1},{2},{3};,\n") + ";\n}\n";
    for (std::size_t at = text.find(",\n;"); at != std::string::npos; at = text.find(",\n;"))
        text.replace(at, 3, ";\n");
    return text;
}

std::string ac3d_block() {
    return "AC3Db\nMATERIAL \"\" rgb 1 1 1  amb 0 0 0  emis 0 0 0  spec 0 0 0  shi 0  trans 0\nOBJECT world\nkids "
           "1\nOBJECT poly\n"
           "name \"a\"\nnumvert 8\n" +
           for_corners("x y z\n") + "numsurf 12\n" +
           for_triangles("SURF 0x0\nmat 0\nrefs 3\n{1} 0 0\n{2} 0 0\n{3} 0 0\n") + "kids 0\n";
}

std::string xgl_block() {
    return R"(<WORLD><MESH ID="0">)" + for_corners(R"(<P ID="#">x, y, z</P>)") +
           R"(<MAT ID="0"><DIFF>1, 1, 1</DIFF></MAT>)" +
           for_triangles(
               "<F><MATREF>0</MATREF><FV1><PREF>{1}</PREF></FV1><FV2><PREF>{2}</PREF></FV2><FV3><PREF>{3}</PREF></"
               "FV3></F>") +
           "</MESH><OBJECT><MESHREF>0</MESHREF></OBJECT></WORLD>";
}

std::string amf_block() {
    return R"(<?xml version="1.0"?><amf unit="millimeter"><object id="1"><mesh><vertices>)" +
           [] {
               std::string text;
               for (int i = 0; i < 8; ++i) {
                   const auto [x, y, z] = block_corner(i);
                   text += "<vertex><coordinates><x>" + std::to_string(x) + "</x><y>" + std::to_string(y) + "</y><z>" +
                           std::to_string(z) + "</z></coordinates></vertex>";
               }
               return text;
           }() +
           "</vertices><volume>" + for_triangles("<triangle><v1>{1}</v1><v2>{2}</v2><v3>{3}</v3></triangle>") +
           "</volume></mesh></object></amf>";
}

std::string x3d_block() {
    return R"(<?xml version="1.0"?><X3D version="3.0"><Scene><Shape><IndexedFaceSet coordIndex=")" +
           for_triangles("{1} {2} {3} -1 ") + R"("><Coordinate point=")" + for_corners("x y z ") +
           R"("/></IndexedFaceSet></Shape></Scene></X3D>)";
}

std::string md5_block() {
    std::string text =
        "MD5Version 10\ncommandline \"\"\n\nnumJoints 1\nnumMeshes 1\n\njoints {\n\t\"origin\"\t-1 ( 0 0 0 ) ( 0 0 0 "
        ")\n}\n\n"
        "mesh {\n\tshader \"x\"\n\n\tnumverts 8\n";
    text += for_corners("\tvert # ( 0 0 ) # 1\n") + "\n\tnumtris 12\n" + for_triangles("\ttri # {1} {2} {3}\n") +
            "\n\tnumweights 8\n";
    return text + for_corners("\tweight # 0 1 ( x y z )\n") + "}\n";
}

std::string smd_block() {
    return "version 1\nnodes\n0 \"root\" -1\nend\nskeleton\ntime 0\n0 0 0 0 0 0 0\nend\ntriangles\n" +
           for_triangle_corners("m\n", "0 x y z 0 0 1 0 0\n") + "end\n";
}

std::string fbx_block(const std::string& up, const std::string& scale) {
    std::string indices;
    for (const auto& [a, b, c] : block_triangles)
        indices +=
            (indices.empty() ? "" : ",") + std::to_string(a) + ',' + std::to_string(b) + ',' + std::to_string(~c);
    std::string places = for_corners("x,y,z,");
    places.pop_back();
    return "; FBX 7.4.0 project file\nFBXHeaderExtension:  {\n\tFBXHeaderVersion: 1003\n\tFBXVersion: 7400\n}\n"
           "GlobalSettings:  {\n\tVersion: 1000\n\tProperties70:  {\n\t\tP: \"UpAxis\", \"int\", \"Integer\", \"\"," +
           up +
           "\n\t\tP: \"UpAxisSign\", \"int\", \"Integer\", \"\",1\n\t\tP: \"UnitScaleFactor\", \"double\", \"Number\", "
           "\"\"," +
           scale +
           "\n\t}\n}\nObjects:  {\n\tGeometry: 100, \"Geometry::g\", \"Mesh\" {\n\t\tVertices: *24 {\n\t\t\ta: " +
           places + "\n\t\t}\n\t\tPolygonVertexIndex: *36 {\n\t\t\ta: " + indices +
           "\n\t\t}\n\t}\n\tModel: 200, \"Model::a\", \"Mesh\" {\n\t\tVersion: 232\n\t}\n}\n"
           "Connections:  {\n\tC: \"OO\",200,0\n\tC: \"OO\",100,200\n}\n";
}

template <typename T>
std::string all_block_corners() {
    std::string bytes;
    for (int i = 0; i < 8; ++i) {
        const auto [x, y, z] = block_corner(i);
        bytes += bytes_of<T>({T(x), T(y), T(z)});
    }
    return bytes;
}

/// A chunk of 3DS: a number, the length of the chunk, and content.
std::string chunk_3ds(std::uint16_t number, const std::string& content) {
    return bytes_of<std::uint16_t>({number}) + bytes_of<std::uint32_t>({std::uint32_t(content.size() + 6)}) + content;
}

std::string three_ds_block() {
    std::string indices = bytes_of<std::uint16_t>({12});
    for (const auto& [a, b, c] : block_triangles)
        indices += bytes_of<std::uint16_t>({std::uint16_t(a), std::uint16_t(b), std::uint16_t(c), 7});
    const std::string mesh =
        chunk_3ds(0x4110, bytes_of<std::uint16_t>({8}) + all_block_corners<float>()) + chunk_3ds(0x4120, indices);
    return chunk_3ds(0x4D4D, chunk_3ds(0x3D3D, chunk_3ds(0x4000, "a\0"s + chunk_3ds(0x4100, mesh))));
}

/// Returns bytes in the other order, in units of `size`.
std::string byte_swapped(std::string bytes, std::size_t size) {
    for (std::size_t at = 0; at < bytes.size(); at += size)
        std::reverse(bytes.begin() + std::ptrdiff_t(at), bytes.begin() + std::ptrdiff_t(at + size));
    return bytes;
}

std::string chunk_lwo(const std::string& name, const std::string& content) {
    return name + byte_swapped(bytes_of<std::uint32_t>({std::uint32_t(content.size())}), 4) + content +
           (content.size() % 2 == 1 ? "\0"s : "");
}

std::string lwo_block() {
    std::string polygons = "FACE", tags = "SURF";
    for (std::size_t i = 0; i < block_triangles.size(); ++i) {
        const auto& [a, b, c] = block_triangles[i];
        polygons += byte_swapped(bytes_of<std::uint16_t>({3, std::uint16_t(a), std::uint16_t(b), std::uint16_t(c)}), 2);
        tags += byte_swapped(bytes_of<std::uint16_t>({std::uint16_t(i), 0}), 2);
    }
    return chunk_lwo("FORM", "LWO2" + chunk_lwo("TAGS", "Default\0"s) +
                                 chunk_lwo("LAYR", std::string(16, '\0') + "a\0"s) +
                                 chunk_lwo("PNTS", byte_swapped(all_block_corners<float>(), 4)) +
                                 chunk_lwo("POLS", polygons) + chunk_lwo("PTAG", tags));
}

std::string chunk_b3d(const std::string& name, const std::string& content) {
    return name + bytes_of<std::uint32_t>({std::uint32_t(content.size())}) + content;
}

std::string b3d_block() {
    std::string indices = bytes_of<std::int32_t>({-1});
    for (const auto& [a, b, c] : block_triangles) indices += bytes_of<std::int32_t>({a, b, c});
    const std::string mesh = bytes_of<std::int32_t>({-1}) +
                             chunk_b3d("VRTS", bytes_of<std::int32_t>({0, 0, 0}) + all_block_corners<float>()) +
                             chunk_b3d("TRIS", indices);
    const std::string node = "a\0"s + bytes_of<float>({0, 0, 0, 1, 1, 1, 1, 0, 0, 0}) + chunk_b3d("MESH", mesh);
    return chunk_b3d("BB3D", bytes_of<std::int32_t>({1}) + chunk_b3d("NODE", node));
}

/// A file, and the ending of its name.
struct BlockFile {
    std::string ending, content;
};

class AssimpAxes : public ::testing::TestWithParam<BlockFile> {};

TEST_P(AssimpAxes, AreThoseOfTheFile) {
    const TemporaryDirectory directory;
    const std::string path = directory.file("block" + GetParam().ending);
    write_file(path, GetParam().content);
    const io::LoadedScene scene = io::read_mesh_scene(path, {io::MeshObjects::node, true});
    ASSERT_EQ(scene.objects, 1u);
    const Box3d& box = std::get<Buffer<Box3d>>(scene.boxes)[0];
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_EQ(box.min[axis], 0) << axis;
        EXPECT_EQ(box.max[axis], block_corner(7)[std::size_t(axis)]) << axis;
    }
    EXPECT_EQ(std::get<shape::Mesh>(scene.shapes->shapes[0]).triangles.size(), 12u);
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_TRUE(
        has_text(scene.warnings[0], "octopair does not vouch for it: check the number of objects and the bounds"));
}

INSTANTIATE_TEST_SUITE_P(Of, AssimpAxes,
                         ::testing::Values(BlockFile{".dxf", dxf_block()}, BlockFile{".ase", ase_block()},
                                           BlockFile{".x", direct_x_block()}, BlockFile{".ac", ac3d_block()},
                                           BlockFile{".xgl", xgl_block()}, BlockFile{".amf", amf_block()},
                                           BlockFile{".x3d", x3d_block()}, BlockFile{".md5mesh", md5_block()},
                                           BlockFile{".smd", smd_block()},
                                           BlockFile{".nff", for_triangle_corners("p 3\n", "x y z\n")},
                                           BlockFile{".raw", "a\n" + for_triangle_corners("\n", "x y z ") + "\n"},
                                           BlockFile{".fbx", fbx_block("1", "1")}, BlockFile{".3ds", three_ds_block()},
                                           BlockFile{".lwo", lwo_block()}, BlockFile{".b3d", b3d_block()}),
                         [](const auto& file) { return file.param.ending.substr(1); });

TEST(AssimpSpace, OfFbxIsThatOfTheFile) {
    const TemporaryDirectory directory;
    const auto space = [&](const std::string& up, const std::string& scale) {
        write_file(directory.file("a.fbx"), fbx_block(up, scale));
        return io::read_mesh_scene(directory.file("a.fbx"), {io::MeshObjects::node}).space;
    };
    EXPECT_EQ(space("1", "1"), (io::SceneSpace{io::UpAxis::y, "cm"}));
    EXPECT_EQ(space("2", "100"), (io::SceneSpace{io::UpAxis::z, "m"}));
    EXPECT_EQ(space("0", "7"), (io::SceneSpace{io::UpAxis::unknown, ""}));
}

}  // namespace
}  // namespace octopair::test
