// Tests the reader of OFF with random files, in all spellings of the format, whose content is known.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "io/spelling.hpp"

namespace octopair::test {
namespace {

/// How a file is divided into lines.
enum class OffLines : std::uint8_t {
    own,     ///< each vertex and face has its own
    broken,  ///< anywhere, but faces end with a line
    one,     ///< the faces are on one line, the vertices are broken anywhere
};

/// A random OFF file: its text, and what it says.
struct OffFile {
    Spelling spelling;
    OffLines lines;
    std::string text;
    io::PlainMesh mesh;
    std::uint64_t warnings = 0;

    explicit OffFile(std::uint64_t seed) : spelling(seed) {
        lines = OffLines(spelling.one_in(2) ? 0 : 1 + spelling.below(2));
        text = spelling.byte_order_mark();
        const std::uint64_t vertices = spelling.below(8), faces = vertices == 0 ? 0 : spelling.below(8);
        keyword =
            spelling.pick({"OFF", "COFF", "NOFF", "STOFF", "CNOFF", "NCOFF", "STCNOFF", "NCSTOFF", "off", "coff", ""});
        short_colours = faces == 0 && spelling.one_in(2);  // with faces, few numbers may suit colours of four, too
        without_stated = spelling.one_in(4);
        text += keyword;
        if (!keyword.empty()) write_break();
        text += std::to_string(vertices);
        write_space();
        text += std::to_string(faces);
        if (lines == OffLines::own) {
            const std::string edges = spelling.pick({"", " 0", "\t7"});
            has_edges = !edges.empty();
            text += edges;
            end_line();
        } else {
            if (short_colours)
                text += spelling.blank();  // on the next line, it could be a coordinate before a colour of four
            if (!short_colours) write_space();
            text += "7";
            separate();
        }
        for (std::uint64_t i = 0; i < vertices; ++i) write_vertex();
        for (std::uint64_t i = 0; i < faces; ++i) write_face();
        if (lines == OffLines::own) write_end();
    }

    void write_end() {
        if (spelling.one_in(4)) text.resize(text.size() - spelling.line_end().size());
        // Without the number of edges, or what the keyword says, such a file may be valid with other numbers.
        if (without_stated || short_colours || !has_edges || !spelling.one_in(8)) return;
        text += spelling.line_end() + "3 0 1 2";
        warnings = 1;
    }

    /// Writes what is between the keyword and the counts: nothing, a blank, or the end of the line.
    void write_break() {
        if (spelling.one_in(3)) return;
        separate();
    }
    void separate() {
        if (spelling.one_in(2)) {
            text += spelling.blank();
        } else {
            end_line();
        }
    }
    /// Writes what separates the numbers of a vertex or face.
    void write_space() {
        if (lines == OffLines::own || !spelling.one_in(3)) {
            text += spelling.blank();
        } else {
            end_line();
        }
    }

    void end_line() {
        text += spelling.pick({"", "", "", " # 1 2", "#"}) + spelling.indent() + spelling.line_end();
        while (spelling.one_in(6)) text += spelling.pick({"", " ", "# OFF", "\t#"}) + spelling.line_end();
        text += spelling.indent();
    }

    void write_vertex() {
        Point3d& place = mesh.vertices.emplace_back();
        for (double& at : place) {
            const SpelledNumber number = spelling.spelled();
            text += number.text;
            write_space();
            at = number.value;
        }
        if (lines == OffLines::own) {
            // A normal, a colour, or a place in a texture, although the keyword does not say so.
            if (keyword.size() <= 3) text += spelling.pick({"", "", "0 0 1", "255 0 0 255", "0.5 0.5"});
            if (keyword.size() <= 3 || without_stated) return end_line();
        }
        const auto has = [&](char c) { return keyword.find(c) != std::string::npos; };
        const bool has_colours = has('C') || has('c');
        std::uint64_t numbers = (has('N') ? 3 : 0) + (has('T') ? 2 : 0) + (!has_colours ? 0 : short_colours ? 3 : 4);
        for (; numbers > 0; --numbers) {
            text += spelling.pick({"0", "1", "0.5", "-1.e0", "255"});
            write_space();
        }
        if (lines == OffLines::own) end_line();
    }

    void write_face() {
        const std::uint64_t corners = spelling.below(6);
        text += std::to_string(corners);
        for (std::uint64_t i = 0; i < corners; ++i) {
            const std::uint64_t vertex = spelling.below(mesh.vertices.size());
            if (lines == OffLines::one) {
                text += spelling.blank();
            } else {
                write_space();
            }
            text += std::to_string(vertex);
            mesh.corners.push_back(std::uint32_t(vertex));
        }
        mesh.end_face();
        if (lines == OffLines::one) {
            text += spelling.blank();
            return;
        }
        text += spelling.pick({"", "", " 255 0 0", " 0.5 0.5 0.5 1", " 7"});  // a colour
        end_line();
    }

    std::string keyword;
    bool short_colours = false, has_edges = false;
    bool without_stated = false;  ///< vertices lack what the keyword says
};

TEST(GeneratedFiles, OfOffAreReadAsTheyAreWritten) {
    const std::stop_token without_stop;
    for (std::uint64_t i = 0; i < generated_files(); ++i) {
        const std::uint64_t seed = case_seed("off", i);
        OffFile file(seed);
        std::vector<std::string> warnings;
        const auto mesh = read_of_valid(seed, file.text, [&] {
            return io::parse_off({file.text, "m.off", without_stop, {}, &warnings});
        });
        ASSERT_EQ(difference(mesh, file.mesh), "") << repetition(seed, file.text);
        ASSERT_EQ(warnings.size(), file.warnings) << repetition(seed, file.text);

        const std::string mutated = file.spelling.mutated(file.text);
        const std::string fault = fault_of_reading("m.off: ", [&] {
            return fault_of_mesh(io::parse_off({mutated, "m.off", without_stop}));
        });
        ASSERT_EQ(fault, "") << repetition(seed, mutated);
    }
}

}  // namespace
}  // namespace octopair::test
