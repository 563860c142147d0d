// Tests real assemblies with the program. Collisions of nodes and of triangles agree, for all engines and any number of
// threads.
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <utility>

#include "cli/program.hpp"

namespace octopair::test {
namespace {

#if defined(OCTOPAIR_WITH_MESHES) && defined(OCTOPAIR_WITH_PIPELINE)

/// Two names, in order.
using Pairing = std::pair<std::string, std::string>;

class Assemblies : public ProgramTest, public ::testing::WithParamInterface<std::string> {
protected:
    void SetUp() override {
        if (!std::filesystem::exists(model())) GTEST_SKIP() << "no models; scripts/data unpacks them";
    }

    std::string model() const { return std::string(OCTOPAIR_DATA "/assimp_models/") + GetParam(); }

    std::vector<nlohmann::json> rows(const std::string& arguments) const {
        const Outcome outcome = run("detect '" + model() + "' --quiet --output r.jsonl " + arguments);
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        std::vector<nlohmann::json> rows;
        std::istringstream lines(content("r.jsonl"));
        for (std::string line; std::getline(lines, line);) rows.push_back(nlohmann::json::parse(line));
        return rows;
    }

    /// Returns the names of two nodes, in alphabetical order.
    static Pairing pairing(const nlohmann::json& row) {
        const std::string a = row["a_name"], b = row["b_name"];
        return std::minmax(a, b);
    }
};

TEST_P(Assemblies, NodesAndTrianglesGiveEqualPairs) {
    std::set<Pairing> by_node, by_triangle;
    for (const auto& row : rows("")) {
        if (row["class"] != "contained") by_node.insert(pairing(row));
    }
    for (const auto& row : rows("--objects triangle")) {
        const Pairing names = pairing(row);
        if (names.first != names.second) by_triangle.insert(names);
    }
    EXPECT_EQ(by_node, by_triangle);
    EXPECT_FALSE(by_node.empty());
}

TEST_P(Assemblies, FeaturesAreOfTheObjectsThatMeet) {
    const auto objects = rows("--margin 0.01"), features = rows("--margin 0.01 --stage features --tolerance 0");
    ASSERT_EQ(objects.size(), features.size());
    for (std::size_t i = 0; i < objects.size(); ++i) {
        EXPECT_EQ(objects[i]["a"], features[i]["a"]);
        EXPECT_EQ(objects[i]["b"], features[i]["b"]);
        const std::string what = features[i]["class"];
        if (objects[i]["class"] == "collision") {
            EXPECT_TRUE(what == "touching" || what == "penetrating" || what == "duplicate") << what << features[i];
            if (what == "duplicate") continue;
            EXPECT_GE(features[i]["contacts"].size(), 1u);
            EXPECT_TRUE(what == "penetrating" || features[i]["depth"] == 0) << features[i];
        } else {
            EXPECT_EQ(objects[i]["class"], what);
        }
    }
}

TEST_P(Assemblies, SameBytesFromAllEngines) {
    for (const std::string order : {"ascending", "octal"}) {
        const std::string arguments = "--stage features --margin 0.01 --order " + order;
        (void)rows(arguments + " --threads 1");
        const std::string expected = content("r.jsonl");
        for (const std::string engine : {"--threads 3", "--engine processes --workers 2"}) {
            (void)rows(arguments + " " + engine);
            EXPECT_EQ(content("r.jsonl"), expected) << engine;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Models, Assemblies,
                         ::testing::Values("glTF2/2CylinderEngine-glTF-Binary/2CylinderEngine.glb", "OBJ/regr01.obj",
                                           "OBJ/spider.obj", "3DS/test1.3ds"),
                         [](const auto& at) {
                             std::string name = at.param.substr(at.param.rfind('/') + 1);
                             return name.substr(0, name.find('.'));
                         });

#endif

}  // namespace
}  // namespace octopair::test
