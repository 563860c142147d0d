// Tests which format a file has, by its content and its name, and what is refused with a remedy.
#include "io/formats/format_choice.hpp"

#include <gtest/gtest.h>

#include <map>

#include "io/formats/content_marks.hpp"
#include "io/formats/format_table.hpp"
#include "io/scene_reader.hpp"
#include "io/temporary.hpp"

namespace octopair::test {
namespace {

using io::SceneFormat;
using namespace std::string_literals;

const std::string off_content = "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2\n3 0 1 3\n3 0 2 3\n3 1 2 3\n";
const std::string obj_content = "# block\nmtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
const std::string ply_content =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
    "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
const std::string stl_content =
    "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid "
    "a\n";
const std::string gltf_content = R"({"asset": {"version": "2.0"}, "scenes": []})";
const std::string json_content = R"({"objects": [{"shape": {"type": "sphere", "radius": 1}}]})";
const std::string ifc_content = "ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('IFC4'));\nENDSEC;\n";
const std::string step_content = "ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('CONFIG_CONTROL_DESIGN'));\nENDSEC;\n";

/// Returns a text in UTF-16, little endian, with a byte order mark.
std::string in_utf16(const std::string& text) {
    std::string wide = "\xff\xfe";
    for (const char c : text) wide += {c, '\0'};
    return wide;
}

class Formats : public ::testing::Test {
protected:
    std::string write(const std::string& name, const std::string& content) const {
        write_file(directory_.file(name), content);
        return directory_.file(name);
    }
    /// Returns the refusal of a scene file, without the file's name.
    std::string refusal(const std::string& name, const std::string& content) const {
        const std::string path = write(name, content);
        const std::string message =
            error_of(ErrorCode::bad_input, [&] { (void)io::read_scene(path, {io::MeshObjects::node}); });
        return message.starts_with(path + ": ") ? message.substr(path.size() + 2) : message;
    }

    TemporaryDirectory directory_;
};

TEST_F(Formats, OfResults) {
    EXPECT_EQ(io::result_format("a.b/c.npy"), io::ResultFormat::npy);
    EXPECT_EQ(io::result_format("c.csv"), io::ResultFormat::csv);
    EXPECT_EQ(io::result_format("c.JSONL"), io::ResultFormat::jsonl);
    for (const std::string path : {"c", "c.json", "npy", "c.npy.gz", ""}) {
        EXPECT_NE(error_of(ErrorCode::usage, [&] { (void)io::result_format(path); }), "") << path;
    }
    EXPECT_TRUE(io::is_array_file("c.npy"));
    EXPECT_FALSE(io::is_array_file("c.csv"));
    EXPECT_FALSE(io::is_array_file(""));
}

TEST_F(Formats, OfScenesByName) {
    EXPECT_EQ(io::scene_format("a.csv/b.NPY"), SceneFormat::npy);
    EXPECT_EQ(io::scene_format("a.csv"), SceneFormat::csv);
    EXPECT_EQ(io::scene_format("a.json"), SceneFormat::json);
    for (const std::string path : {"a", "a.txt", "a.npz", "a.", "npy"}) {
        EXPECT_EQ(io::scene_format(path), SceneFormat::unknown) << path;
    }
#ifdef OCTOPAIR_WITH_MESHES
    EXPECT_EQ(io::scene_format("a.glb"), SceneFormat::mesh);
#endif
}

TEST_F(Formats, SomeScenesHaveFurtherFiles) {
    EXPECT_TRUE(io::may_name_files("a.gltf"));
    EXPECT_TRUE(io::may_name_files("a.GLTF"));
    EXPECT_TRUE(io::may_name_files("a.json"));
    EXPECT_FALSE(io::may_name_files("a.glb"));
}

TEST_F(Formats, EachEndingHasOneFormat) {
    std::set<std::string_view> names;
    for (const io::FileFormat& format : io::file_formats()) {
        EXPECT_TRUE(names.insert(format.name).second) << format.name;
        const bool without = format.reader == io::FormatReader::nobody || format.reader == io::FormatReader::program;
        EXPECT_EQ(format.remedy.empty(), !without) << format.name;
        if (!format.endings.empty()) {
            EXPECT_EQ(io::format_with_ending(format.first_ending()), &format);
        }
    }
    EXPECT_EQ(io::format_with_ending(""), nullptr);
    EXPECT_EQ(io::format_with_ending(".prj")->name, "3DS");
}

/// A beginning of a file, and the ending of its format.
struct Beginning {
    std::string bytes, ending;
};

TEST_F(Formats, ContentDecidesAgainstTheName) {
    const std::string binary_stl = std::string(80, ' ') + bytes_of<std::uint32_t>({2}) + std::string(100, '\0');
    const std::vector<Beginning> beginnings = {
        {"\x93NUMPY\x01\0"s, ".npy"},
        {off_content, ".off"},
        {"NOFF 3 1 0\n", ".off"},
        {obj_content, ".obj"},
        {ply_content, ".ply"},
        {stl_content, ".stl"},
        {binary_stl, ".stl"},
        {gltf_content, ".gltf"},
        {"glTF\x02\0\0\0"s, ".glb"},
        {"\xef\xbb\xbf<?xml version=\"1.0\"?>\n<COLLADA version=\"1.4.1\">", ".dae"},
        {in_utf16("<?xml version=\"1.0\"?><COLLADA>"), ".dae"},
        {"  0\r\nSECTION\r\n", ".dxf"},
        {"999\na comment\n0\nSECTION\n", ".dxf"},
        {ifc_content, ".ifc"},
        {step_content, ".step"},
        {"Kaydara FBX Binary  \0"s, ".fbx"},
        {"xof 0303txt 0032\n", ".x"},
        {"MM\x0a\0\0\0    "s, ".3ds"},
    };
    for (const auto& [bytes, ending] : beginnings) {
        for (const std::string name : {"file", "file.txt", "file.csv", "file.ac"}) {
            const io::KnownFormat known = io::known_format(write(name, bytes));
            EXPECT_EQ(known.ending, ending) << name << ": " << bytes.substr(0, 20);
            EXPECT_TRUE(known.by_content) << name;
            EXPECT_EQ(known.misnamed, name == "file.csv"s || name == "file.ac"s) << name;
        }
        const io::KnownFormat known = io::known_format(write("right" + ending, bytes));
        EXPECT_EQ(known.ending, ending);
        EXPECT_FALSE(known.misnamed) << ending;
    }
}

TEST_F(Formats, TheNameDecidesWithoutAMark) {
    for (const std::string content : {"0,0,0,1,1,1\n", "v\nfrom 1 2 3\n", "objects", "<svg>", "v 1 x 2\n", ""}) {
        for (const std::string ending : {".obj", ".stl", ".nff", ".raw"}) {
            const io::KnownFormat known = io::known_format(write("file" + ending, content));
            EXPECT_EQ(known.ending, ending) << content;
            EXPECT_FALSE(known.by_content);
        }
    }
    EXPECT_EQ(io::scene_format(write("boxes.txt", "a,b,c,d,e,f\n0,0,0,1,1,1\n")), SceneFormat::csv);
    EXPECT_EQ(io::scene_format(write("scene.txt", json_content)), SceneFormat::json);
    EXPECT_EQ(io::format_ending(write("a.gltf", json_content)), ".gltf") << "these keys may occur in glTF, too";
    EXPECT_EQ(io::scene_format(write("words.txt", "some words\n")), SceneFormat::unknown);
}

TEST_F(Formats, AWrongNameIsAWarning) {
    const std::string path = write("a.csv", npy_of(io::NpyType::float32, {1, 6}, std::vector<float>(6, 0)));
    const io::LoadedScene scene = io::read_scene(path, {io::MeshObjects::node});
    EXPECT_EQ(scene.objects, 1u);
    EXPECT_EQ(scene.warnings, std::vector{path + ": is NumPy, not CSV as its name says; it is read as NumPy"});
    const io::LoadedScene named = io::read_scene(write("boxes", "0,0,0,1,1,1\n"), {io::MeshObjects::node});
    EXPECT_EQ(named.objects, 1u);
    EXPECT_TRUE(named.warnings.empty());
#ifdef OCTOPAIR_WITH_MESHES
    const std::string stl = write("a.stl", ply_content);
    EXPECT_EQ(io::read_scene(stl, {io::MeshObjects::triangle}).objects, 1u);
    EXPECT_EQ(io::read_scene(stl, {io::MeshObjects::node}).warnings,
              std::vector{stl + ": is PLY, not STL as its name says; it is read as PLY"});
    const std::string dae =
        write("b.obj",
              "0\nSECTION\n2\nENTITIES\n0\n3DFACE\n8\n0\n10\n0\n20\n0\n30\n0\n11\n1\n21\n0\n31\n0\n12\n"
              "0\n22\n1\n32\n0\n13\n0\n23\n1\n33\n0\n0\nENDSEC\n0\nEOF\n");
    EXPECT_EQ(io::read_scene(dae, {io::MeshObjects::triangle}).objects, 1u) << "Assimp reads it from memory";
#endif
}

TEST_F(Formats, WrappedFilesAreRefusedWithARemedy) {
    const std::string pointer = "version https://git-lfs.github.com/spec/v1\noid sha256:5e\nsize 48213\n";
    const std::string tar = std::string(257, 'a') + "ustar\0"s;
    std::vector<std::string> endings = {".npy", ".csv", ".json"};
#ifdef OCTOPAIR_WITH_MESHES
    for (const char* ending :
         {".obj", ".stl", ".ply", ".off", ".gltf", ".glb", ".ifc", ".dxf", ".dae", ".3ds", ".txt", ""})
        endings.emplace_back(ending);
#endif
    for (const std::string& ending : endings) {
        const std::string name = "a" + ending;
        EXPECT_EQ(refusal(name, pointer), "is a Git LFS pointer, not the file itself; run `git lfs pull`") << ending;
        const std::string page = "is an HTML page, not a model; download the file itself";
        EXPECT_EQ(refusal(name, "\n<!DOCTYPE HTML>\n<html>"), page) << ending;
        EXPECT_EQ(refusal(name, "<html><body>404"), page) << ending;
        const auto packed = [&](const std::string& what, const std::string& command) {
            return "is " + what + "; unpack it first, for example with `" + command + "`";
        };
        EXPECT_EQ(refusal(name, "\x1f\x8b\x08\0"s), packed("compressed with gzip", "gzip -dc")) << ending;
        EXPECT_EQ(refusal(name,
                          "\xfd"
                          "7zXZ\0"s),
                  packed("compressed with xz", "xz -dc"))
            << ending;
        EXPECT_EQ(refusal(name, "BZh91AY"), packed("compressed with bzip2", "bzip2 -dc")) << ending;
        EXPECT_EQ(refusal(name, "\x28\xb5\x2f\xfd"), packed("compressed with zstd", "zstd -dc")) << ending;
        EXPECT_EQ(refusal(name, "7z\xbc\xaf\x27\x1c"), packed("a 7z archive", "7z x")) << ending;
        EXPECT_EQ(refusal(name, "PK\x03\x04" + std::string(40, '\0')), packed("a ZIP archive", "unzip")) << ending;
        EXPECT_EQ(refusal(name, tar), packed("a tar archive", "tar -xf")) << ending;
        if (ending != ".csv") {
            EXPECT_EQ(refusal(name, ""), "is empty") << ending;
        }
    }
}

TEST_F(Formats, WideTextIsRefusedWhereItsReaderDoesNotKnowIt) {
    for (const std::string name : {"a.csv", "a.json"}) {
        EXPECT_EQ(refusal(name, in_utf16(json_content)), "is text in UTF-16; save it as UTF-8");
        EXPECT_EQ(refusal(name, "\xff\xfe\0\0{\0\0\0"s), "is text in UTF-32; save it as UTF-8");
    }
#ifdef OCTOPAIR_WITH_MESHES
    for (const std::string name : {"a.obj", "a.stl", "a.off", "a.ply", "a.dae", "a"})
        EXPECT_EQ(refusal(name, in_utf16(obj_content)), "is text in UTF-16; save it as UTF-8") << name;
    EXPECT_EQ(io::wrapping_of({in_utf16("<COLLADA>"), 20}, ".dae"), "");
#endif
}

TEST_F(Formats, KeysOfGltfWithinAJsonSceneAreNoMark) {
    const std::string scene =
        R"({"shapes": {"accessors": {"type": "sphere", "radius": 1}, "asset": 1}, "objects": []})";
    EXPECT_EQ(io::marked_format({scene, scene.size()}), "");
    const std::string gltf = R"({"a\"b": [{"asset": 1}], "asset": {"version": "2.0"}})";
    EXPECT_EQ(io::marked_format({gltf, gltf.size()}), ".gltf");
}

#ifdef OCTOPAIR_WITH_MESHES
TEST_F(Formats, TextWithoutTheMarkOfItsFormatIsRefused) {
    EXPECT_TRUE(has_text(refusal("a.ase", "hello\nthis is no model\n"), "*3DSMAX_ASCIIEXPORT"));
    EXPECT_TRUE(has_text(refusal("a.x3d", "hello world\n"), "has no <"));
    const std::string amf =
        "<?xml version=\"1.0\"?><amf unit=\"millimeter\"><constellation id=\"1\"><instance "
        "objectid=\"0\"><rz>90</rz></instance></constellation></amf>";
    EXPECT_TRUE(has_text(refusal("a.amf", amf), "an instance is rotated (<rz>)"));
    EXPECT_TRUE(has_text(refusal("a.ifczip", "PK\x03\x04"), "unpack"));
}
#endif

TEST_F(Formats, ContentThatIsNoModelIsNamed) {
    const std::string to_do = "give octopair a model, or boxes as .npy or .csv";
    const std::map<std::string, std::string> foreign = {
        {"<?xml version='1.0'?>\n<!-- a -->\n<!DOCTYPE html PUBLIC 'x'>\n<html xmlns='h'>\n",
         "is an HTML page, not a model; download the file itself"},
        {"\x5d\0\0\x80\0"s + std::string(8, '\xff') + "\0b"s,
         "is compressed with LZMA; unpack it first, for example with `xz --format=lzma -dc`"},
        {"LZIP\x01\x0c", "is compressed with lzip; unpack it first, for example with `lzip -dc`"},
        {"\x1f\x9d\x90", "is compressed with compress; unpack it first, for example with `gzip -dc`"},
        {"\x7f\x45LF\x02", "is a program (ELF), not a model; " + to_do},
        {"MZ"s + std::string(58, '\0') + "\x40\0\0\0PE\0\0"s, "is a program (Windows), not a model; " + to_do},
        {"SQLite format 3\0"s, "is a database (SQLite), not a model; export the model from the program that wrote it"},
        {"{\\rtf1\\ansi", "is a document (RTF), not a model; save it as plain text"},
        {"GIF89a", "is a picture (GIF), not a model; " + to_do},
        {"BM\x0e\0\0\0"s + std::string(8, '\0'), "is a picture (BMP), not a model; " + to_do},
        {"RIFFxxxxWEBP", "is a picture (WebP), not a model; " + to_do},
        {"L\0\0\0\x01\x14\x02\0"s, "is a shortcut of Windows, not the file itself; give the file that it names"},
        {"\0\x05\x16\x07"s,
         "has only the attributes that macOS keeps of a file (AppleDouble); give the file without ._ in its name"},
        {"-----BEGIN PGP MESSAGE-----\n", "is encoded text (PGP MESSAGE), not a model; decode or decrypt it first"},
        {std::string(76, 'a') + "\n" + std::string(76, '/') + "\nab==\n",
         "is text in base64; decode it first, for example with `base64 -d`"},
        {"data:model/gltf-binary;base64,Z2xU",
         "is a data URI; decode what follows the comma, for example with `base64 -d`"},
        {"# a\n<<<<<<< HEAD\nv 0 0 0\n=======\nv 0 0 1\n>>>>>>> b\n",
         "line 2: has the conflict markers of git; resolve the conflict first"},
        {"/annex/objects/SHA256E-s1\n", "is a pointer of git-annex, not the file itself; run `git annex get`"},
        {"404: Not Found", "is the answer of a web server, not a model; download the file itself"},
        {"<?xml version='1.0'?>\n<Error><Code>AccessDenied</Code></Error>",
         "is XML with the element <Error>, which is no model that octopair knows; export glTF, OBJ or STL"},
        {std::string("h\0e\0l\0l\0o\0 \0w\0o\0r\0l\0d\0", 22), "is text in UTF-16; save it as UTF-8"},
    };
    for (const std::string name : {"a.obj", "a.csv", "a.npy", "a", "a.ply"}) {
        for (const auto& [content, message] : foreign) EXPECT_EQ(refusal(name, content), message) << name;
    }
}

TEST_F(Formats, DirectoriesAreNamed) {
    EXPECT_EQ(error_of(ErrorCode::bad_input, [&] { (void)io::read_scene(directory_.path(), {io::MeshObjects::node}); }),
              directory_.path() + ": is a directory; give the name of a file in it");
}

TEST_F(Formats, ModelsWithSuchBeginningsAreRead) {
    std::string stl(84 + 50, '\0');
    for (const std::string begin : {"GIF89a", "MZ", "-----BEGIN A-----", "<svg>", "404: Not Found", "{\\rtf"}) {
        stl.replace(0, begin.size(), begin);
        stl[80] = 1;
        EXPECT_EQ(io::wrapping_of({stl, stl.size()}, ".stl"), "") << begin;
    }
    EXPECT_EQ(io::wrapping_of({"<mesh>", 6}, ".xml"), "");
    EXPECT_EQ(io::wrapping_of({"data:x,y,z,a,b,c\n", 17}, ".csv"), "");
    EXPECT_EQ(io::wrapping_of({std::string(64, '0') + " 1 2\n", 69}, ".raw"), "");
}

TEST_F(Formats, SomeFormatsAreWrappedThemselves) {
    for (const std::string ending : {".3mf", ".zae", ".pk3"}) {
        EXPECT_EQ(io::wrapping_of({"PK\x03\x04", 4}, ending), "") << ending;
        EXPECT_NE(io::wrapping_of({"\x1f\x8b", 2}, ending), "") << ending;
    }
    EXPECT_EQ(io::wrapping_of({"\x1f\x8b", 2}, ".blend"), "");
    EXPECT_NE(io::wrapping_of({"PK\x03\x04", 4}, ".blend"), "");
    const std::string package = "PK\x03\x04" + std::string(60, '\0') + "3D/3dmodel.model";
    EXPECT_EQ(io::wrapping_of({package, package.size()}, ".obj"), "");
    EXPECT_EQ(io::marked_format({package, package.size()}), ".3mf");
}

TEST_F(Formats, FormatsThatNobodyReadsHaveARemedy) {
    const std::string cad = "install octopair-step, or export it as glTF, OBJ or STL from a CAD program";
    for (const std::string name : {"a.step", "a.stp", "a.obj", "a"})
        EXPECT_EQ(refusal(name, step_content), "is STEP, which another program must read; " + cad) << name;
    EXPECT_EQ(refusal("a.igs", "x"), "is IGES, which another program must read; " + cad);
    EXPECT_EQ(refusal("a.wrl", "#VRML V2.0 utf8\n"),
              "is VRML, which octopair does not read; convert it to X3D or glTF, for example with Blender");
    EXPECT_EQ(refusal("a.dxf", "AutoCAD Binary DXF\r\n\x1a"),
              "is binary DXF, which octopair does not read; save it as text (ASCII DXF), or export glTF, OBJ or STL");
    EXPECT_EQ(refusal("a.obj", "%PDF-1.7"),
              "is PDF, which octopair does not read; give octopair a model, or boxes as .npy or .csv");
    EXPECT_EQ(refusal("a.npz", "PK\x03\x04" + bytes_of<std::uint32_t>({0, 0, 0, 0, 0}) + "\0\0\x05\0\0\0a.npy"s),
              "is NPZ, which octopair does not read; save its array as .npy with numpy.save");
}

}  // namespace
}  // namespace octopair::test
