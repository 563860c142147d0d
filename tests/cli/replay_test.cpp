// Tests `octopair replay`: its output for valid recordings, and the recordings that the program refuses.
#include "cli/program.hpp"
#include "octopair/octopair.hpp"

namespace octopair::test {
namespace {

class Replay : public ProgramTest {
protected:
    /// Records two boxes that touch, part, and touch again.
    void record(const std::string& name) const {
        const std::vector<Box3f> boxes = {{{0, 0, 0}, {1, 1, 1}}, {{0, 0, 0}, {1, 1, 1}}};
        const std::vector<Box3f> away = {{{5, 0, 0}, {6, 1, 1}}};
        Scene scene({1, Precision::float32, 0, file(name)});
        std::vector<ObjectId> ids(2);
        scene.add(Objects{boxes}, ids);
        (void)scene.step();
        scene.move(std::span(ids).first(1), std::span(away));
        (void)scene.step();
        scene.move(std::span(ids).first(1), std::span(boxes).first(1));
        (void)scene.step();
    }
};

TEST_F(Replay, SaysWhatHappened) {
    record("r.rec");
    const Outcome outcome = run("replay r.rec");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.out, "");
    EXPECT_TRUE(outcome.err.starts_with("steps       3, ")) << outcome.err;
    EXPECT_TRUE(has_text(outcome.err,
                         "\ncalls       3\n"
                         "objects     2 at the end\n"
                         "pairs       1 at the end\n"
                         "events      2 began, 1 ended\n"
                         "step time   median "));
    EXPECT_FALSE(has_text(outcome.err, "check"));
    EXPECT_FALSE(has_text(outcome.err, "ending"));
    EXPECT_EQ(run("replay r.rec --quiet --check").err, "");
}

TEST_F(Replay, ChecksEachStepOnAnyNumberOfThreads) {
    record("r.rec");
    for (const std::string threads : {"0", "1", "2", "3"}) {
        const Outcome outcome = run("replay r.rec --check --threads " + threads);
        EXPECT_EQ(outcome.status, 0);
        EXPECT_TRUE(outcome.err.ends_with("check       3 steps compared, all equal to the recording\n")) << outcome.err;
    }
}

TEST_F(Replay, ACutRecordingIsMadeAsFarAsItGoes) {
    record("r.rec");
    const std::string whole = content("r.rec");
    write_file(file("cut.rec"), whole.substr(0, whole.size() - 100));  // within the third step's move
    Outcome outcome = run("replay cut.rec --check");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_TRUE(outcome.err.starts_with("steps       2, ")) << outcome.err;
    EXPECT_TRUE(
        outcome.err.ends_with("check       2 steps compared, all equal to the recording\n"
                              "ending      within a call; the replay left this call out\n"))
        << outcome.err;
    write_file(file("died.rec"), whole.substr(0, whole.size() - 10));  // within the third step's result
    outcome = run("replay died.rec --check");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_TRUE(outcome.err.starts_with("steps       3, ")) << outcome.err;
    EXPECT_TRUE(
        outcome.err.ends_with("check       2 steps compared, all equal to the recording\n"
                              "ending      within a step; the replay completed this step\n"))
        << outcome.err;
}

TEST_F(Replay, WhatIsNoRecordingIsRefused) {
    record("r.rec");
    std::string damaged = content("r.rec");
    damaged[100] = char(damaged[100] ^ 1);
    write_file(file("damaged.rec"), damaged);
    write_file(file("text.rec"), std::string(100, 'x'));
    Outcome outcome = run("replay damaged.rec");
    EXPECT_EQ(outcome.status, 3);
    EXPECT_EQ(outcome.err, "octopair: damaged.rec: byte 32: the record's checksum is wrong\n");
    outcome = run("replay text.rec");
    EXPECT_EQ(outcome.status, 3);
    EXPECT_EQ(outcome.err, "octopair: text.rec: byte 0: not a recording of a scene\n");
    outcome = run("replay none.rec");
    EXPECT_EQ(outcome.status, 4);
    EXPECT_EQ(outcome.err, "octopair: none.rec: cannot open: No such file or directory\n");
    EXPECT_EQ(run("replay .").status, 3);
}

TEST_F(Replay, AStepThatFindsSomethingElse) {
    record("a.rec");
    // The result of another scene's first step: nothing began.
    { (void)Scene({1, Precision::float32, 0, file("b.rec")}).step(); }
    const std::string result = content("b.rec").substr(32 + 24);
    std::string mixed = content("a.rec");
    mixed.replace(mixed.size() - result.size(), result.size(), result);
    write_file(file("mixed.rec"), mixed);
    const Outcome outcome = run("replay mixed.rec --check");
    EXPECT_EQ(outcome.status, 6);
    EXPECT_EQ(outcome.err,
              "octopair: mixed.rec: step 3: 1 began, 0 ended, 0 persisting; recorded: 0 began, 0 ended, 0 "
              "persisting\n");
    EXPECT_EQ(run("replay mixed.rec").status, 0);
}

TEST_F(Replay, AnInterrupt) {
    {
        const std::vector<Box3f> boxes(20'000, {{0, 0, 0}, {1, 1, 1}});  // 199,990,000 pairs in every step
        Scene scene({1, Precision::float32, 0, file("long.rec")});
        std::vector<ObjectId> ids(boxes.size());
        scene.add(Objects{boxes}, ids);
    }
    // Appends the record of a step without its result, as if the program had died. The replay makes this step.
    { (void)Scene({1, Precision::float32, 0, file("step.rec")}).step(); }
    write_file(file("long.rec"), content("long.rec") + content("step.rec").substr(32, 24));
    const Outcome outcome =
        shell("\"$P\" replay long.rec --threads 1 & child=$!; hears $child; sleep 0.2; kill -INT $child; wait $child");
    EXPECT_EQ(outcome.status, 130);
    EXPECT_EQ(outcome.err, "octopair: interrupted\n");
}

}  // namespace
}  // namespace octopair::test
