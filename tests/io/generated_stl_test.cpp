// Tests the reader of STL with random files, in all spellings of the format, whose content is known.
#include <gtest/gtest.h>

#include <bit>
#include <string>
#include <vector>

#include "io/spelling.hpp"

namespace octopair::test {
namespace {

void add_corner(io::PlainMesh& mesh, const Point3d& place) {
    mesh.corners.push_back(std::uint32_t(mesh.vertices.size()));
    mesh.vertices.push_back(place);
}

/// How a text is divided into lines.
enum class StlLines : std::uint8_t {
    own,     ///< each statement begins a line, or follows another
    broken,  ///< anywhere
    one,     ///< all is on one line
};

/// A random STL file: its text or bytes, and what it says.
struct StlFile {
    Spelling spelling;
    std::string bytes;
    std::vector<io::PlainMesh> meshes;
    std::uint64_t warnings = 0;

    explicit StlFile(std::uint64_t seed) : spelling(seed) {
        if (spelling.one_in(2)) {
            write_binary();
            return;
        }
        lines = StlLines(spelling.one_in(2) ? 0 : 1 + spelling.below(2));
        bytes = spelling.byte_order_mark() + (spelling.one_in(4) ? spelling.line_end() : "");
        for (std::uint64_t solids = 1 + spelling.below(3); solids > 0; --solids) write_solid();
        if (spelling.one_in(4) && bytes.ends_with(spelling.line_end()))
            bytes.resize(bytes.size() - spelling.line_end().size());
    }

    void write_solid() {
        capitals = spelling.one_in(4);
        io::PlainMesh& mesh = meshes.emplace_back();
        mesh.name = spelling.pick({"", "a part", "facet#1", "K\xc3\xb6rper"});
        bytes += spelling.indent() + word("solid") + (mesh.name.empty() ? "" : spelling.blank()) + mesh.name;
        std::uint64_t facets = spelling.below(4);
        if (lines == StlLines::one && mesh.name.empty()) ++facets;  // "solid endsolid" would be a solid with a name
        bytes += lines == StlLines::one ? spelling.blank() : spelling.line_end();
        for (; facets > 0; --facets) write_facet(mesh);
        end("solid");
        bytes += spelling.blank() + mesh.name;
        bytes += lines == StlLines::one ? spelling.blank() : spelling.line_end();
    }

    void write_facet(io::PlainMesh& mesh) {
        if (lines != StlLines::one && spelling.one_in(8)) bytes += word("color") + " 0.5 0.5 1" + spelling.line_end();
        bytes += word("facet");
        write_space();
        bytes += word("normal");
        const std::string number = spelling.pick({"0", "nan", "-1e0", "+.5", "-nan(ind)", "1.#QNAN"});
        for (int i = 0; i < 3; ++i) {
            write_space();
            bytes += number;
        }
        separate();
        bytes += word("outer");
        write_space();
        bytes += word("loop");
        separate();
        for (int corner = 0; corner < 3; ++corner) write_vertex(mesh);
        end("loop");
        separate();
        end("facet");
        if (lines == StlLines::own) {
            bytes += spelling.line_end();
        } else {
            separate();
        }
        mesh.end_face();
    }

    void write_vertex(io::PlainMesh& mesh) {
        bytes += word("vertex");
        Point3d place;
        for (double& at : place) {
            const SpelledNumber number = spelling.spelled();
            write_space();
            bytes += number.text;
            at = number.value;
        }
        add_corner(mesh, place);
        separate();
    }

    std::string word(const char* text) { return spelling.in_case(text, capitals); }
    void end(const char* what) { bytes += word("end") + (spelling.one_in(6) ? spelling.blank() : "") + word(what); }
    /// Writes what separates statements.
    void separate() {
        const bool in_line = lines == StlLines::one || spelling.one_in(6);
        bytes += in_line ? spelling.blank() : spelling.indent() + spelling.line_end() + spelling.indent();
    }
    /// Writes what separates the words of a statement.
    void write_space() {
        const bool in_line = lines != StlLines::broken || !spelling.one_in(3);
        bytes += in_line ? spelling.blank() : spelling.indent() + spelling.line_end() + spelling.indent();
    }

    void append(std::uint32_t value) {
        for (int i = 0; i < 4; ++i) bytes += char(value >> (8 * i) & 0xFF);
    }

    void write_binary() {
        const auto triangles = std::uint32_t(spelling.below(5));
        bytes = spelling.pick({"", "solid", "solid a part\n", "STLEXP Object01", "binary\r\n"});
        bytes.resize(80, spelling.one_in(2) ? ' ' : '\0');
        const bool uncounted = spelling.one_in(6);
        append(uncounted ? 0 : triangles);
        meshes.emplace_back().rounded = true;
        for (std::uint32_t i = 0; i < triangles; ++i) write_triangle(meshes[0]);
        warnings = uncounted && triangles > 0;
        if (uncounted || !spelling.one_in(4)) return;
        bytes += std::string(1 + spelling.below(49), '\x20');
        warnings = 1;
    }

    void write_triangle(io::PlainMesh& mesh) {
        for (int i = 0; i < 3; ++i) append(std::bit_cast<std::uint32_t>(float(spelling.below(2))));
        for (int corner = 0; corner < 3; ++corner) {
            Point3d place;
            for (double& at : place) {
                const double any = spelling.number();
                const float number = std::fabs(any) < 1e38 ? float(any) : -0.0F;
                append(std::bit_cast<std::uint32_t>(number));
                at = double(number);
            }
            add_corner(mesh, place);
        }
        bytes += char(spelling.below(256));
        bytes += char(spelling.below(256));
        mesh.end_face();
    }

    bool capitals = false;
    StlLines lines = StlLines::own;
};

TEST(GeneratedFiles, OfStlAreReadAsTheyAreWritten) {
    const std::stop_token without_stop;
    for (std::uint64_t i = 0; i < generated_files(); ++i) {
        const std::uint64_t seed = case_seed("stl", i);
        StlFile file(seed);
        std::vector<std::string> warnings;
        const auto meshes = read_of_valid(seed, file.bytes, [&] {
            return io::parse_stl({file.bytes, "m.stl", without_stop, {}, &warnings});
        });
        ASSERT_EQ(difference(meshes, file.meshes), "") << repetition(seed, file.bytes);
        ASSERT_EQ(warnings.size(), file.warnings) << repetition(seed, file.bytes);
        ASSERT_EQ(meshes[0].rounded, file.meshes[0].rounded);

        const std::string mutated = file.spelling.mutated(file.bytes);
        const std::string fault = fault_of_reading("m.stl: ", [&] {
            return fault_of_mesh(io::parse_stl({mutated, "m.stl", without_stop}));
        });
        ASSERT_EQ(fault, "") << repetition(seed, mutated);
    }
}

}  // namespace
}  // namespace octopair::test
