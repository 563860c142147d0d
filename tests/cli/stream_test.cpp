// Tests streams as inputs and outputs: standard input and output, and pipes.
#include "cli/program.hpp"

namespace octopair::test {
namespace {

class Streams : public ProgramTest {
protected:
    void SetUp() override { save_boxes("a.npy", {0, 0.5f, 1.5f, 3}); }

    const std::string pairs = "a,b\n0,1\n1,2\n";
};

TEST_F(Streams, StandardInputIsAnInput) {
    EXPECT_EQ(shell("cat a.npy | \"$P\" detect - --quiet").out, pairs);
    EXPECT_EQ(shell("\"$P\" detect /dev/stdin --quiet <a.npy").out, pairs);
    EXPECT_EQ(shell("cat a.npy | \"$P\" detect /dev/stdin --quiet").out, pairs);
    EXPECT_EQ(shell("echo 0,0,0,1,1,1 | \"$P\" detect - - --count-only --quiet").out, "1\n") << "read once, used twice";
    EXPECT_EQ(shell("cat a.npy | \"$P\" detect - --against a.npy --count-only --quiet").out, "8\n");
    const Outcome broken = shell("head -c 100 a.npy | \"$P\" detect - --quiet");
    EXPECT_EQ(broken.status, 3);
    EXPECT_EQ(broken.err.find("octopair: -: "), 0u) << broken.err;
}

#ifdef OCTOPAIR_WITH_PIPELINE
TEST_F(Streams, JsonIsKnownByItsFirstByte) {
    const std::string sphere = R"({"shape":{"type":"sphere","radius":1}})";
    const std::string scene = R"( {"objects":[)" + sphere + "," + sphere + "]}";
    const Outcome outcome = shell("echo '" + scene + "' | \"$P\" detect - --quiet --output p.jsonl && cat p.jsonl");
    EXPECT_EQ(outcome.out, "{\"a\":0,\"b\":1,\"key\":\"1#0 | 1#1\",\"class\":\"collision\"}\n") << outcome.err;
}
#endif

TEST_F(Streams, PipesAreInputsByTheirEnding) {
    ASSERT_EQ(shell("mkfifo f.npy f.csv").status, 0);
    EXPECT_EQ(shell("cat a.npy >f.npy & \"$P\" detect f.npy --quiet").out, pairs);
    EXPECT_EQ(shell("echo 0,0,0,1,1,1 >f.csv & \"$P\" detect f.csv a.npy --count-only --quiet").out, "4\n");
    EXPECT_EQ(shell("sleep 0.3 >f.npy & \"$P\" detect f.npy --quiet").status, 3) << "an empty file";
}

TEST_F(Streams, ResultsGoToStreams) {
    EXPECT_EQ(shell("\"$P\" detect a.npy --output - --quiet").out, pairs);
    EXPECT_EQ(shell("\"$P\" detect a.npy --output /dev/stdout --quiet | cat").out, pairs);
    EXPECT_EQ(shell("\"$P\" detect a.npy --count-only --stats - --quiet | grep -c objects").out, "1\n");
    ASSERT_EQ(
        shell("mkfifo p.npy && { cat p.npy >copy.npy & } && \"$P\" detect a.npy --output p.npy --quiet && wait").status,
        0);
    ASSERT_EQ(run("detect a.npy --output file.npy --quiet").status, 0);
    EXPECT_EQ(content("copy.npy"), content("file.npy"));
    EXPECT_EQ(shell("\"$P\" generate uniform --objects 5 --seed 1 --output - --quiet | \"$P\" detect - --quiet").status,
              0);
    EXPECT_EQ(run("detect a.npy --output /dev/full --quiet").status, 4);
}

}  // namespace
}  // namespace octopair::test
