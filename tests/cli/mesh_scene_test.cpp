// Tests mesh scenes from Debian packages. Expected counts come from two independent programs. Some files are known to
// break importers.
#include "cli/program.hpp"

namespace octopair::test {
namespace {

namespace fs = std::filesystem;

class MeshScene : public ProgramTest {
protected:
    /// Returns the path of a file that scripts/data unpacks, or "" if the file does not exist.
    std::string data(const std::string& name) const {
        const std::string path = std::string(OCTOPAIR_DATA) + "/" + name;
        return fs::exists(path) ? path : "";
    }
};

#ifdef OCTOPAIR_WITH_MESHES
TEST_F(MeshScene, Counts) {
    const std::string bunny = data("bunny00.off"), elephant = data("refined_elephant.off");
    if (bunny.empty() || elephant.empty()) GTEST_SKIP() << "no data; scripts/data unpacks it";
    const auto count = [&](const std::string& path) {
        return run("detect '" + path + "' --objects triangle --stage pairs --count-only --stats s.json --quiet").out;
    };
    EXPECT_EQ(count(bunny), "471777\n");
    EXPECT_TRUE(has_text(content("s.json"), "\"objects\": 75408,"));
    EXPECT_EQ(count(elephant), "538234\n");
    EXPECT_TRUE(has_text(content("s.json"), "\"objects\": 88928,"));
}

TEST_F(MeshScene, NamesReachTheResult) {
    write_file(file("two.obj"),
               "o left\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\no right\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 4 5 6\n");
    ASSERT_EQ(run("detect two.obj --stage pairs --output p.jsonl").status, 0);
    EXPECT_EQ(content("p.jsonl"), "{\"a\":0,\"b\":1,\"a_name\":\"two.obj/left\",\"b_name\":\"two.obj/right\"}\n");
}

TEST_F(MeshScene, DifferentAxesAreAWarning) {
    const fs::path models = data("assimp_models");
    if (models.empty()) GTEST_SKIP() << "no data; scripts/data unpacks it";
    const std::string house = "'" + (models / "IFC/AC14-FZK-Haus.ifc").string() + "'";
    const std::string box = "'" + (models / "glTF2/BoxTextured-glTF-Binary/BoxTextured.glb").string() + "'";
    const std::string warning = "warning     the formats of the inputs have different axes up";
    for (const std::string& inputs : {house + " " + box, house + " --against " + box})
        EXPECT_TRUE(has_text(run("detect " + inputs + " --output p.csv").err, warning)) << inputs;
    EXPECT_FALSE(has_text(run("detect " + house + " --output p.csv").err, "warning"));
}

TEST_F(MeshScene, NoFileCrashesTheProgram) {
    const fs::path models = data("assimp_models");
    if (models.empty()) GTEST_SKIP() << "no data; scripts/data unpacks it";
    std::size_t files = 0, refused = 0;
#ifdef OCTOPAIR_TEST_SANITIZED
    constexpr bool sanitized = true;  // no memory limit is possible, and one file needs all memory
#else
    constexpr bool sanitized = false;
#endif
    for (const char* part : {"invalid", "RAW", "OBJ", "glTF2/IndexOutOfRange"}) {
        for (const auto& entry : fs::recursive_directory_iterator(models / part)) {
            if (!entry.is_regular_file() || (sanitized && entry.path().filename() == "OutOfMemory.off")) continue;
            const Outcome outcome =
                run("detect '" + entry.path().string() + "' --objects triangle --output p.csv --quiet");
            ++files;
            refused += outcome.status != 0;
            EXPECT_TRUE(outcome.status == 0 || outcome.status == 3 || outcome.status == 5)
                << entry.path() << ": " << outcome.status;
            EXPECT_EQ(outcome.err.empty(), outcome.status == 0) << entry.path();
            EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), outcome.status == 0 ? 0 : 1)
                << outcome.err;
            EXPECT_EQ(fs::exists(file("p.csv")), outcome.status == 0);
            fs::remove(file("p.csv"));
        }
    }
    EXPECT_GE(files, 20u);
    EXPECT_GE(refused, 10u);
}
#endif

TEST_F(MeshScene, SpheresOfTheMelt) {
    const std::string melt = data("nylon_melt.npy");
    if (melt.empty()) GTEST_SKIP() << "no data; scripts/data unpacks it";
    EXPECT_EQ(run("detect '" + melt + "' --count-only --quiet").out, "854050\n");
}

}  // namespace
}  // namespace octopair::test
