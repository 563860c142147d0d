// Tests `octopair generate`: complete files of every kind, identical on every run.
#include "cli/program.hpp"
#include "samples/scenes.hpp"
#include "support/compare.hpp"

namespace octopair::test {
namespace {

class Generate : public ProgramTest {};

TEST_F(Generate, EveryKindIsAFileThatDetectReads) {
    for (const std::string_view kind : samples::scene_kinds()) {
        const std::string arguments = "generate " + std::string(kind) + " --objects 300 --seed 5 --quiet --output ";
        EXPECT_EQ(run(arguments + "a.npy").status, 0) << kind;
        EXPECT_EQ(run(arguments + "b.npy").status, 0) << kind;
        EXPECT_TRUE(same_sequence(content("a.npy"), content("b.npy"))) << kind;
        EXPECT_EQ(content("a.npy").size(), 128u + 300u * 24u) << kind;
        EXPECT_EQ(run("detect a.npy --count-only --quiet").status, 0) << kind;
    }
}

TEST_F(Generate, WritesWhatTheLibraryMakes) {
    ASSERT_EQ(run("generate uniform --objects 1000 --seed 3 --output a.npy --quiet").status, 0);
    const auto boxes = samples::make_scene("uniform", 1000, 3);
    EXPECT_TRUE(same_sequence(content("a.npy").substr(128), bytes_of(boxes)));
}

TEST_F(Generate, FramesGiveAMovingScene) {
    const Outcome outcome = run("generate brownian --objects 50 --seed 1 --frames 4 --output m.npy");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.err, "m.npy: 50 objects in each of 4 frames, brownian, seed 1\n");
    EXPECT_EQ(content("m.npy").size(), 128u + 4u * 50u * 24u);
    EXPECT_TRUE(has_text(content("m.npy"), "'shape': (4, 50, 6)"));
}

TEST_F(Generate, NoObjects) {
    ASSERT_EQ(run("generate uniform --objects 0 --output a.npy --quiet").status, 0);
    EXPECT_EQ(run("detect a.npy --count-only --quiet").out, "0\n");
}

}  // namespace
}  // namespace octopair::test
