// Tests the reader of OFF with random files, in all spellings of the format, whose content is known.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "io/spelling.hpp"

namespace octopair::test {
namespace {

/// A random OFF file: its text, and what it says.
struct OffFile {
    Spelling spelling;
    std::string text;
    io::PlainMesh mesh;
    std::uint64_t warnings = 0;

    explicit OffFile(std::uint64_t seed) : spelling(seed) {
        text = spelling.byte_order_mark();
        const std::uint64_t vertices = spelling.below(8), faces = vertices == 0 ? 0 : spelling.below(8);
        const std::string keyword =
            spelling.pick({"OFF", "COFF", "NOFF", "STOFF", "CNOFF", "NCOFF", "STCNOFF", "NCSTOFF", "off", "coff", ""});
        text += keyword;
        if (!keyword.empty()) write_break();
        text += fmt::format("{}{}{}", vertices, spelling.blank(), faces) + spelling.pick({"", " 0", "\t7"});
        end_line();
        for (std::uint64_t i = 0; i < vertices; ++i) write_vertex();
        for (std::uint64_t i = 0; i < faces; ++i) write_face();
        if (spelling.one_in(4)) text.resize(text.size() - spelling.line_end().size());
        if (!spelling.one_in(8)) return;
        text += spelling.line_end() + "3 0 1 2";
        warnings = 1;
    }

    /// Writes what is between the keyword and the counts: nothing, a blank, or the end of the line.
    void write_break() {
        if (spelling.one_in(3)) return;
        if (spelling.one_in(2)) {
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
            text += number.text + spelling.blank();
            at = number.value;
        }
        text +=
            spelling.pick({"", "", "0 0 1", "255 0 0 255", "0.5 0.5"});  // a normal, a colour, or a place in a texture
        end_line();
    }

    void write_face() {
        const std::uint64_t corners = spelling.below(6);
        text += std::to_string(corners);
        for (std::uint64_t i = 0; i < corners; ++i) {
            const std::uint64_t vertex = spelling.below(mesh.vertices.size());
            text += spelling.blank() + std::to_string(vertex);
            mesh.corners.push_back(std::uint32_t(vertex));
        }
        mesh.end_face();
        text += spelling.pick({"", "", " 255 0 0", " 0.5 0.5 0.5 1", " 7"});  // a colour
        end_line();
    }
};

TEST(GeneratedFiles, OfOffAreReadAsTheyAreWritten) {
    const std::stop_token without_stop;
    for (std::uint64_t i = 0; i < generated_files(); ++i) {
        const std::uint64_t seed = case_seed("off", i);
        OffFile file(seed);
        std::vector<std::string> warnings;
        const io::PlainMesh mesh = io::parse_off({file.text, "m.off", without_stop, {}, &warnings});
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
