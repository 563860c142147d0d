// Tests which collisions become rows: --tolerance, --duplicate-tolerance, --min-depth and --classes, alone and together.
#include <algorithm>
#include <nlohmann/json.hpp>
#include <random>
#include <set>
#include <sstream>
#include <tuple>

#include "cli/bolt.hpp"
#include "cli/program.hpp"

namespace octopair::test {
namespace {

#if defined(OCTOPAIR_WITH_MESHES) && defined(OCTOPAIR_WITH_PIPELINE)

using Rows = std::set<std::pair<int, int>>;

class RowChoice : public ProgramTest {
protected:
    /// Returns the pairs and classes of the rows.
    std::set<std::tuple<int, int, std::string>> classes(const std::string& arguments) const {
        const Outcome outcome = run("detect " + arguments + " --quiet --output r.jsonl");
        EXPECT_EQ(outcome.status, 0) << arguments << ": " << outcome.err;
        std::set<std::tuple<int, int, std::string>> rows;
        std::istringstream lines(content("r.jsonl"));
        for (std::string line; std::getline(lines, line);) {
            const auto row = nlohmann::json::parse(line);
            rows.emplace(row["a"], row["b"], row["class"]);
        }
        return rows;
    }
    Rows rows(const std::string& arguments) const {
        Rows rows;
        for (const auto& [a, b, what] : classes(arguments)) rows.emplace(a, b);
        return rows;
    }
    static std::string box(const std::string& name, const std::array<double, 3>& low, const std::array<double, 3>& size,
                           int number) {
        std::ostringstream text;
        text << "o " << name << '\n';
        for (unsigned i = 0; i < 8; ++i) {
            text << 'v';
            for (unsigned axis = 0; axis < 3; ++axis)
                text << ' ' << low[axis] + ((i >> axis & 1) != 0 ? size[axis] : 0);
            text << '\n';
        }
        const int faces[12][3] = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                                  {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
        for (const auto& face : faces) {
            text << 'f';
            for (const int corner : face) text << ' ' << number * 8 + corner + 1;
            text << '\n';
        }
        return text.str();
    }
    /// Writes plates with near copies: moved by a step between 0 and 0.2, so that they touch, overlap, or are duplicates.
    void write_plates(const std::string& name) const {
        std::mt19937 random(7);
        std::uniform_real_distribution<double> place(0, 4), thickness(0.02, 0.3);
        const double steps[] = {0, 1e-7, 1e-4, 1e-3, 0.01, 0.2};
        std::string text;
        int number = 0;
        for (int i = 0; i < 12; ++i) {
            const std::array<double, 3> at = {place(random), place(random), place(random) / 4},
                                        size = {1.5, 1, thickness(random)};
            text += box("plate " + std::to_string(i), at, size, number++);
            const double step = steps[i % 6];
            text += box("copy " + std::to_string(i), {at[0], at[1], at[2] + (i < 6 ? step : size[2] - step)}, size,
                        number++);
        }
        write_file(file(name), text);
    }
    /// Writes spheres and boxes with near copies.
    void write_shapes(const std::string& name) const {
        std::mt19937 random(8);
        std::uniform_real_distribution<double> place(0, 3);
        nlohmann::json objects = nlohmann::json::array();
        const double steps[] = {0, 1e-6, 1e-3, 0.02, 0.2};
        for (int i = 0; i < 20; ++i) {
            nlohmann::json shape = {{"type", "box"}, {"half_extents", {0.5, 0.4, 0.03}}};
            if (i % 2 == 0) shape = {{"type", "sphere"}, {"radius", 0.3}};
            const double x = place(random), y = place(random), z = place(random);
            objects.push_back({{"shape", shape}, {"position", {x, y, z}}});
            objects.push_back({{"shape", shape}, {"position", {x + steps[i % 5], y, z}}});
        }
        write_file(file(name), nlohmann::json{{"objects", objects}}.dump());
    }
};

/// Options together never give more rows than one of them alone.
TEST_F(RowChoice, ToleranceAndMinDepthComposeOnAllScenes) {
    write_plates("plates.obj");
    write_shapes("shapes.json");
    const std::vector<std::string> tolerances = {"--tolerance 0", "--tolerance 1e-3", "--tolerance 0.05",
                                                 "--tolerance 1e-3 --duplicate-tolerance 0.05"};
    const std::vector<std::string> depths = {"--min-depth 0.0005", "--min-depth 0.02", "--min-depth 0.2"};
    for (const std::string scene : {"plates.obj", "shapes.json", "plates.obj --objects triangle"}) {
        const std::string features = scene + " --stage features ";
        const Rows all = rows(features);
        std::vector<Rows> by_depth;
        for (const std::string& depth : depths) by_depth.push_back(rows(features + depth));
        EXPECT_LT(by_depth.back().size(), all.size()) << scene << ": the scene must have shallow collisions";
        for (const std::string& tolerance : tolerances) {
            if (scene.ends_with("triangle") && tolerance.find("duplicate") != std::string::npos) continue;
            SCOPED_TRACE(scene + ' ' + tolerance);
            EXPECT_EQ(rows(features + tolerance), all) << "--tolerance leaves out nothing";
            for (std::size_t i = 0; i < depths.size(); ++i) {
                const Rows both = rows(features + tolerance + ' ' + depths[i]);
                EXPECT_TRUE(std::includes(by_depth[i].begin(), by_depth[i].end(), both.begin(), both.end()))
                    << depths[i];
            }
        }
    }
}

/// With a larger default tolerance, --min-depth leaves out thin overlaps. They stay out with smaller tolerances.
TEST_F(RowChoice, SmallerTolerancesGiveNoMoreRowsThanTheDefault) {
    write_file(file("bolt.obj"), bolt_in_plate(0.995));
    const std::string detect = "bolt.obj --stage features --chord 0.005";
    EXPECT_EQ(rows(detect).size(), 1u);
    EXPECT_EQ(rows(detect + " --min-depth 0.02"), Rows());
    for (const std::string tolerance : {"0", "1e-3", "0.01", "0.1"})
        EXPECT_EQ(rows(detect + " --min-depth 0.02 --tolerance " + tolerance), Rows()) << tolerance;
}

TEST_F(RowChoice, ClassesAreThoseOfTheList) {
    write_plates("plates.obj");
    const std::string features = "plates.obj --stage features --margin 0.1 --tolerance 1e-3";
    const auto all = classes(features);
    std::set<std::string> words;
    for (const auto& row : all) words.insert(std::get<2>(row));
    EXPECT_EQ(words, (std::set<std::string>{"clearance", "duplicate", "penetrating", "touching"}));
    const std::vector<std::set<std::string>> lists = {
        {"penetrating"}, {"clearance", "penetrating"}, {"touching", "duplicate"}, {"contained"}};
    for (const auto& list : lists) {
        std::string given;
        for (const std::string& word : list) given += (given.empty() ? "" : ",") + word;
        auto expected = all;
        std::erase_if(expected, [&](const auto& row) { return !list.contains(std::get<2>(row)); });
        const std::string arguments = features + " --classes " + given;
        EXPECT_EQ(classes(arguments), expected) << given;
        EXPECT_EQ(classes(arguments + " --verify"), expected) << given;
        EXPECT_EQ(run("detect " + arguments + " --count-only --quiet").out, std::to_string(expected.size()) + '\n');
        EXPECT_EQ(run("detect " + arguments + " --fail-on-collision --quiet").status, expected.empty() ? 0 : 1);
        EXPECT_EQ(classes(arguments + " --limit 2").size(), std::min<std::size_t>(expected.size(), 2));
        const std::string summary = run("detect " + arguments + " --output r.csv").err;
        for (const std::string& word : words) EXPECT_EQ(has_text(summary, " " + word), list.contains(word)) << summary;
        for (const std::string engine : {"--threads 1", "--threads 3"}) {
            EXPECT_EQ(classes(arguments + ' ' + engine), expected) << engine;
        }
#ifdef OCTOPAIR_WITH_PROCESSES
        EXPECT_EQ(classes(arguments + " --engine processes --workers 2"), expected);
#endif
    }
}

TEST_F(RowChoice, WrongClassesAreRefused) {
    write_plates("plates.obj");
    save_boxes("boxes.npy", {0, 0.5});
    const auto message = [&](const std::string& arguments) {
        const Outcome outcome = run("detect " + arguments);
        EXPECT_EQ(outcome.status, 2) << arguments;
        return outcome.err.substr(0, outcome.err.find('\n'));
    };
    EXPECT_TRUE(has_text(message("plates.obj --stage features --classes penetratin"), "did you mean 'penetrating'?"));
    EXPECT_TRUE(
        has_text(message("plates.obj --stage features --classes touching,"), "--classes: '' is not a valid value"));
    EXPECT_TRUE(
        has_text(message("plates.obj --classes penetrating"),
                 "--classes: --stage objects never gives 'penetrating'; it gives: clearance, collision, contained"));
    EXPECT_TRUE(has_text(message("plates.obj --stage features --classes collision"),
                         "--classes: --stage features never gives 'collision'"));
    EXPECT_TRUE(has_text(message("plates.obj --stage features --objects triangle --classes contained"),
                         "--classes: --stage features of triangles never gives 'contained'"));
    EXPECT_TRUE(has_text(message("boxes.npy --classes clearance"), "--classes: only with --stage objects or features"));
}

#endif

}  // namespace
}  // namespace octopair::test
