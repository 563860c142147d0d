// Tests the package of 3MF files: archives that are damaged, that lie, or that unpack to too much, and the relationships.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "io/meshes/three_mf/package.hpp"
#include "io/meshes/xml/xml_parser.hpp"
#include "io/three_mf_reading.hpp"

namespace octopair::test {
namespace {

using Names = std::vector<std::string>;

std::string simple_model() {
    return model_text("<object id='1' name='a'>" + tetrahedron() + "</object>", "<item objectid='1'/>");
}

/// Returns a package whose parts are written in one form.
ZipWriter package_writer(const ZipForm& form = {}) {
    ZipWriter zip;
    zip.add("_rels/.rels", relationships_to("/3D/3dmodel.model"), form);
    zip.add("3D/3dmodel.model", simple_model(), form);
    return zip;
}

void expect_archive_refusal(const std::string& file, const std::string& part) {
    const std::string message = three_mf_refusal(file);
    EXPECT_TRUE(has_text(message, part));
}

/// Returns the file with other bytes at each place of a text.
std::string replaced(std::string file, const std::string& text, const std::string& other) {
    for (std::size_t at = file.find(text); at != std::string::npos; at = file.find(text, at + text.size()))
        file.replace(at, other.size(), other);
    return file;
}

TEST(ThreeMfPackage, AllFormsOfArchivesAreRead) {
    for (const bool deflate : {false, true}) {
        for (const bool sizes_follow : {false, true}) {
            for (const bool zip64 : {false, true}) {
                const ZipWriter zip = package_writer({deflate, sizes_follow, zip64, "a comment"});
                EXPECT_EQ(three_mf_scene(zip.bytes(zip64, "PK\x05\x06 comment")).names, Names{"a"});
            }
        }
    }
}

TEST(ThreeMfPackage, OtherFilesAreRefused) {
    expect_archive_refusal("", "f.3mf: is empty");
    expect_archive_refusal("<model/>", "is not a ZIP archive, which a 3MF file is");
    expect_archive_refusal(ZipWriter().bytes(), "has no part _rels/.rels");
    ZipWriter other;
    other.add("word/document.xml", "<w/>");
    expect_archive_refusal(other.bytes(), "has no part _rels/.rels, which a 3MF file needs");
    ZipWriter without_model;
    without_model.add("_rels/.rels", "<Relationships/>");
    expect_archive_refusal(without_model.bytes(), "_rels/.rels: names no model; this ZIP archive is no 3MF file");
}

TEST(ThreeMfPackage, RelationshipsNameTheModel) {
    const auto package = [](const std::string& relationships) {
        ZipWriter zip;
        zip.add("_rels/.rels", relationships);
        zip.add("a/b.model", simple_model());
        return zip.bytes();
    };
    for (const std::string target : {"/a/b.model", "a/b.model", "/A/B.MODEL", "./x/../a/b.model", "/a/%62.model"})
        EXPECT_EQ(three_mf_scene(package(relationships_to(target))).names, Names{"a"}) << target;
    expect_archive_refusal(package(relationships_to("/c.model")), "has no part c.model, which the package needs");
    expect_archive_refusal(package(replaced(relationships_to("/a/b.model"), "Target=", "Tarzan=")), "has no Target");
    std::string text = relationships_to("/a/b.model");
    expect_archive_refusal(
        package(replaced(text, "Id=\"r\"", "Id='r' ").insert(text.find("/>"), " TargetMode='External'")),
        "the model is in another file");
    text.insert(text.find("<Relationship "), "<other:x xmlns:other='urn:x'/>");
    const std::string twice = text.insert(
        text.find("</"), text.substr(text.find("<Relationship "), text.find("</") - text.find("<Relationship ")));
    EXPECT_EQ(three_mf_scene(package(twice)).warnings, Names{"f.3mf: has several models; only a/b.model is read"});
}

TEST(ThreeMfPackage, CutFilesAreRefused) {
    const std::string file = package_writer().bytes();
    for (std::size_t size = 0; size < file.size(); ++size)
        EXPECT_FALSE(three_mf_refusal(file.substr(0, size)).empty()) << size;
    expect_archive_refusal(file.substr(0, file.size() / 2), "is cut: a ZIP archive ends with its directory");
}

TEST(ThreeMfPackage, DirectoriesThatLieAreRefused) {
    const std::string file = package_writer({.deflate = false}).bytes();
    const std::size_t directory = file.find("PK\x01\x02"), end = file.rfind("PK\x05\x06");
    const auto with = [&](std::size_t at, char byte) {
        std::string changed = file;
        changed[at] = char(changed[at] + byte);
        return changed;
    };
    expect_archive_refusal(with(end + 10, 1), "has a directory that is damaged");   // one entry more
    expect_archive_refusal(with(end + 10, -1), "has a directory that is damaged");  // one entry less
    expect_archive_refusal(with(end + 12, 1), "is not inside the archive");         // size of the directory
    expect_archive_refusal(with(end + 16, 1), "is not inside the archive");         // its offset
    expect_archive_refusal(with(end + 4, 1), "is one part of an archive of several parts");
    expect_archive_refusal(with(directory + 16, 1), "is described in two ways");  // checksum
    expect_archive_refusal(with(directory + 24, 1), "is described in two ways");  // size
    expect_archive_refusal(with(directory + 10, 8), "is described in two ways");  // method
    expect_archive_refusal(with(directory + 8, 1), "_rels/.rels: is encrypted; write the file without a password");
    expect_archive_refusal(with(directory + 42, 1), "overlaps another entry");           // offset of the entry
    expect_archive_refusal(with(directory + 20, 1), "overlaps another entry");           // size of the data
    expect_archive_refusal(with(directory + 28, 1), "has a directory that is damaged");  // length of the name
    expect_archive_refusal(with(directory + 46, 1), "has no part _rels/.rels");          // name
}

TEST(ThreeMfPackage, HeadersOfEntriesThatLieAreRefused) {
    const std::string file = package_writer({.deflate = false}).bytes();
    const std::size_t header = file.find("PK\x03\x04", 4);
    // The mark, method, checksum, sizes, lengths of the name and of further fields, and the name.
    for (const std::size_t at : {2, 8, 14, 18, 22, 26, 28, 30}) {
        std::string changed = file;
        changed[header + at] = char(changed[header + at] + 1);
        expect_archive_refusal(changed, "3D/3dmodel.model: is described in two ways in the archive");
    }
    // Further fields that move the data of the first entry into the second one.
    std::string changed = file;
    changed[29] = 1;
    expect_archive_refusal(changed, "_rels/.rels: is described in two ways in the archive");
}

TEST(ThreeMfPackage, Zip64DirectoriesThatLieAreRefused) {
    const std::string file = package_writer({.zip64 = true}).bytes(true);
    const std::size_t locator = file.rfind("PK\x06\x07"), directory = file.find("PK\x01\x02");
    std::string changed = file;
    changed[locator + 8] = char(changed[locator + 8] + 1);
    expect_archive_refusal(changed, "has no ZIP64 directory where it should be");
    changed = file;
    changed[directory + 46 + 11 + 4] = 9;  // kind of the field with the sizes
    changed[directory + 46 + 11 + 5] = 9;
    expect_archive_refusal(changed, "has a directory that is damaged");
}

TEST(ThreeMfPackage, DamagedDataAreRefused) {
    for (const bool deflate : {false, true}) {
        const std::string file = package_writer({.deflate = deflate, .sizes_follow = true}).bytes();
        const std::size_t data = file.find("_rels/.rels") + 11;
        std::string changed = file;
        changed[data + 40] = char(changed[data + 40] ^ 4);
        expect_archive_refusal(changed, "_rels/.rels: is damaged");
    }
    ZipWriter short_data;
    const std::string packed = deflated("<Relationships/>");
    short_data.add_packed("_rels/.rels", packed.substr(0, packed.size() - 2), {0, 16}, {});
    expect_archive_refusal(short_data.bytes(), "_rels/.rels: is damaged, or cut");
    ZipWriter more_data;
    more_data.add_packed("_rels/.rels", packed, {0, 3}, {});
    expect_archive_refusal(more_data.bytes(), "its size or its checksum is wrong");
    ZipWriter garbage_after;
    garbage_after.add_packed("_rels/.rels", packed + "x", {0, 16}, {});
    expect_archive_refusal(garbage_after.bytes(), "its size or its checksum is wrong");
}

TEST(ThreeMfPackage, UnknownMethodsAndRepeatedPartsAreRefused) {
    const std::string file = replaced(
        replaced(package_writer().bytes(), std::string("\x08\0\0\0\x21\0", 6), std::string("\x09\0", 2)), "never", "");
    expect_archive_refusal(file, "_rels/.rels: is packed by method 9 of ZIP; pack the file with Deflate");
    ZipWriter twice = package_writer();
    twice.add("3d/3DModel.model", simple_model());
    expect_archive_refusal(twice.bytes(), "has several parts 3D/3dmodel.model");
}

TEST(ThreeMfPackage, OverlappingEntriesAreRefused) {
    const std::string file = package_writer({.deflate = false}).bytes();
    const std::size_t first = file.find("PK\x01\x02"), second = file.find("PK\x01\x02", first + 4);
    std::string changed = file;
    changed.replace(second + 42, 4, file.substr(first + 42, 4));
    expect_archive_refusal(changed, "overlaps another entry of the archive");
}

TEST(ThreeMfPackage, ABombIsRefusedBeforeItIsUnpacked) {
    ZipWriter zip;
    zip.add("_rels/.rels", relationships_to("/3D/3dmodel.model"));
    const std::string few = deflated("<model/>");
    zip.add_packed("3D/3dmodel.model", few, {0, std::uint64_t(1) << 40}, {.zip64 = true});
    const std::string message = three_mf_refusal(zip.bytes(), ErrorCode::resource_limit);
    EXPECT_TRUE(has_text(message, "f.3mf: its parts unpack to more than 42949"));
}

/// Ignores what it gets.
class NoHandler final : public io::XmlHandler {
public:
    void begin(const io::XmlTag&) override {}
    void end() override {}
};

TEST(ThreeMfXml, ALongTagIsParsedInLinearTime) {
    NoHandler handler;
    io::XmlParser parser("f", handler, io::XmlParser::Mode::strict);
    parser.parse("<a b='");
    const std::string piece(65536, 'x');
    for (int i = 0; i < 64; ++i) parser.parse(piece);
    parser.parse("'/>");
    parser.finish();
    EXPECT_EQ(parser.line(), 1u);
}

}  // namespace
}  // namespace octopair::test
