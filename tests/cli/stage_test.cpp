// Tests `--stage` and related options: colliding objects, exclusion rules, and messages about filters.
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/bolt.hpp"
#include "cli/program.hpp"
#include "support/page_data.hpp"

namespace octopair::test {
namespace {

#if defined(OCTOPAIR_WITH_MESHES) && defined(OCTOPAIR_WITH_PIPELINE)

/// Three triangles. All boxes overlap, except those of 1 and 2. Triangles 0 and 2 intersect. The distance of 0 and 1 is
/// 0.424, the distance of 1 and 2 is 0.813.
class Stages : public ProgramTest {
protected:
    void SetUp() override {
        write_file(file("t.obj"),
                   "o flat\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
                   "o beside\nv 1 1 0\nv 0.6 1 0\nv 1 0.6 0\nf 4 5 6\n"
                   "o through\nv 0.2 0.2 -1\nv 0.2 0.2 1\nv 0.3 0.2 1\nf 7 8 9\n");
    }

    /// Returns the columns a and b of the output.
    std::string rows(const std::string& arguments) const {
        const Outcome outcome =
            shell("\"$P\" detect " + arguments + " --quiet > out; s=$?; cut -d, -f1,2 out; exit $s");
        EXPECT_EQ(outcome.status, 0) << arguments << ": " << outcome.err;
        return outcome.out;
    }
    std::string refusal(const std::string& arguments) const {
        const Outcome outcome = run("detect " + arguments);
        EXPECT_EQ(outcome.status, 2) << arguments;
        EXPECT_EQ(outcome.out, "") << arguments;
        return outcome.err;
    }
    void rules(const std::string& text) const { write_file(file("r.json"), text); }
    nlohmann::json stats(const std::string& arguments) const {
        (void)rows(arguments + " --count-only --stats s.json");
        return nlohmann::json::parse(content("s.json"));
    }
};

TEST_F(Stages, ObjectsOfMeshesMeet) {
    EXPECT_EQ(rows("t.obj --stage pairs"), "a,b\n0,1\n0,2\n");
    EXPECT_EQ(rows("t.obj --stage objects"), "a,b\n0,2\n");
    EXPECT_EQ(rows("t.obj"), rows("t.obj --stage objects"));
    EXPECT_EQ(rows("t.obj --order octal"), "a,b\n0,2\n");
    EXPECT_EQ(rows("t.obj --count-only"), "1\n");
    EXPECT_EQ(rows("t.obj t.obj --count-only"),
              "7\n");  // three triangles with their copies; 0 and 2 intersect in four combinations
    EXPECT_EQ(rows("t.obj --against t.obj"), "a,b\n0,0\n0,2\n1,1\n2,0\n2,2\n");
}

TEST_F(Stages, MarginsAreEuclidean) {
    EXPECT_EQ(rows("t.obj --margin 0.42"), "a,b\n0,2\n");
    EXPECT_EQ(rows("t.obj --margin 0.43"), "a,b\n0,1\n0,2\n");
    EXPECT_EQ(rows("t.obj --margin 0.81"), "a,b\n0,1\n0,2\n");
    EXPECT_EQ(rows("t.obj --margin 0.82"), "a,b\n0,1\n0,2\n1,2\n");
    write_file(file("p.npy"), npy_of<double>(io::NpyType::float64, {3}, {0.23, 0.1, 0}));
    EXPECT_EQ(rows("t.obj --padding p.npy --margin 0.09"), "a,b\n0,2\n");
    EXPECT_EQ(rows("t.obj --padding p.npy --margin 0.1"), "a,b\n0,1\n0,2\n");
}

TEST_F(Stages, RulesLeavePairsOut) {
    const std::string with = "t.obj t.obj --exclude r.json";
    rules(R"({"exclude": [{"a": "*flat", "b": "*through"}]})");
    EXPECT_EQ(rows(with), "a,b\n0,3\n1,4\n2,5\n");
    EXPECT_EQ(rows("t.obj --stage pairs --exclude r.json"), "a,b\n0,1\n");
    EXPECT_EQ(rows("t.obj --against t.obj --exclude r.json"), "a,b\n0,0\n1,1\n2,2\n");
    rules(R"({"exclude": [{"a": {"label": "flat", "parent": "t.*"}, "b": {"name": "t.obj/through"}}]})");
    EXPECT_EQ(rows(with), "a,b\n0,3\n1,4\n2,5\n");
    EXPECT_EQ(rows("t.obj --against t.obj --exclude r.json"), "a,b\n0,0\n1,1\n2,2\n");
    rules(R"({"ignored_pairs": [["t.obj/flat", "t.obj/flat"], ["t.obj/through", "t.obj/flat"]]})");
    EXPECT_EQ(rows(with), "a,b\n1,4\n2,5\n");
    EXPECT_EQ(rows("t.obj --against t.obj --exclude r.json"), "a,b\n1,1\n2,2\n");
    rules(R"({"same_parent": true})");
    EXPECT_EQ(rows(with), "a,b\n0,3\n0,5\n1,4\n2,3\n2,5\n");  // each file has its own parent
    EXPECT_EQ(rows(with + " --same-parent include"), rows("t.obj t.obj"));
    EXPECT_EQ(rows("t.obj t.obj --same-parent exclude"), rows(with));
    EXPECT_EQ(rows("t.obj --same-parent exclude --stage pairs"), "a,b\n");
}

TEST_F(Stages, WrongRulesAreRefused) {
    const auto refused = [&](const std::string& text) {
        rules(text);
        const Outcome outcome = run("detect t.obj --exclude r.json");
        EXPECT_EQ(outcome.status, 3) << text;
        return outcome.err;
    };
    EXPECT_EQ(refused(R"({"ignored_pairs": [["t.obj/flat", "t.obj/none"]]})"),
              "octopair: r.json: ignored_pairs[0]: no object has the name 't.obj/none'\n");
    EXPECT_EQ(refused(R"({"exclude": 7})"), "octopair: r.json: exclude: a number, not an array\n");
    EXPECT_EQ(refused(R"({"exclude": [{"a": "*", "b": {"level": "*"}}]})"),
              "octopair: r.json: exclude[0]: b: no object of the inputs has the detail 'level'\n");
    EXPECT_EQ(run("detect t.obj --exclude none.json").status, 4);
    save_boxes("a.npy", {0, 0.5});
    rules(R"({"exclude": [{"a": "*", "b": "*"}]})");
    EXPECT_EQ(refusal("a.npy --exclude r.json"), "octopair: --exclude: a.npy has objects without names\n");
}

TEST_F(Stages, LimitsCountWhatCameOut) {
    EXPECT_EQ(rows("t.obj t.obj --limit 2"), "a,b\n0,2\n0,3\n");
    const nlohmann::json limited = stats("t.obj t.obj --limit 2");
    EXPECT_EQ(limited["pairs"], 2);
    EXPECT_EQ(limited["truncated"], true);
    const nlohmann::json all = stats("t.obj t.obj --limit 7");
    EXPECT_EQ(all["pairs"], 7);
    EXPECT_EQ(all["truncated"], false);
}

TEST_F(Stages, CollisionsAreWrittenWithWhatIsKnown) {
    ASSERT_EQ(run("detect t.obj --margin 0.5 --output p.jsonl --quiet").status, 0);
    std::istringstream lines(content("p.jsonl"));
    std::string line;
    std::getline(lines, line);
    const auto near = nlohmann::json::parse(line);
    EXPECT_EQ(near["class"], "clearance");
    EXPECT_NEAR(near["distance"].get<double>(), 0.42426, 1e-5);
    EXPECT_EQ(near["b_name"], "t.obj/beside");
    std::getline(lines, line);
    EXPECT_EQ(nlohmann::json::parse(line)["class"], "collision");
    ASSERT_EQ(run("detect t.obj --stage features --output p.jsonl --quiet").status, 0);
    const auto met = nlohmann::json::parse(content("p.jsonl"));
    EXPECT_EQ(met["class"], "penetrating");
    ASSERT_GE(met["contacts"].size(), 1u);
    EXPECT_NEAR(met["contacts"][0]["point"][2].get<double>(), 0, 1e-9);
    ASSERT_EQ(run("detect t.obj --stage features --max-contacts 0 --output p.jsonl --quiet").status, 0);
    EXPECT_TRUE(nlohmann::json::parse(content("p.jsonl")).value("contacts", nlohmann::json::array()).empty());
    ASSERT_EQ(run("detect t.obj --output p.npy --quiet").status, 0);  // .npy holds only pairs
    EXPECT_EQ(content("p.npy").size(), 128u + 8u);
}

TEST_F(Stages, TrianglesMeetBeyondWhatTheyShare) {
    // Triangles 0 and 1 share an edge. Triangle 2 shares a corner with 0, and triangle 3 intersects 0.
    write_file(file("s.obj"),
               "o s\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv -1 0 1\nv 0 -1 1\nv 0.2 0.2 -1\nv 0.2 0.2 1\nv 0.3 0.2 1\n"
               "f 1 2 3\nf 2 4 3\nf 1 5 6\nf 7 8 9\n");
    const std::string triangles = "s.obj --objects triangle";
    EXPECT_EQ(rows(triangles), "a,b\n0,3\n");
    EXPECT_EQ(rows(triangles + " --adjacent beyond-shared"), "a,b\n0,3\n");
    EXPECT_EQ(rows(triangles + " --adjacent exclude"), "a,b\n0,3\n");
    EXPECT_EQ(rows(triangles + " --adjacent include"), "a,b\n0,1\n0,2\n0,3\n");
    EXPECT_EQ(rows(triangles + " --against t.obj"), "a,b\n0,0\n0,2\n1,0\n1,1\n2,0\n3,0\n3,2\n");
    ASSERT_EQ(run("detect " + triangles + " --stage features --output p.jsonl --quiet").status, 0);
    const auto met = nlohmann::json::parse(content("p.jsonl"));
    EXPECT_EQ(met["class"], "penetrating");
    EXPECT_EQ(met["a_triangle"], 0);
    EXPECT_EQ(met["b_triangle"], 3);
}

TEST_F(Stages, StatsListTheFilters) {
    rules(R"({"exclude": [{"a": "*flat", "b": "*through"}]})");
    const nlohmann::json told = stats("t.obj --exclude r.json");
    EXPECT_EQ(told["pairs"], 0);
    EXPECT_EQ(told["candidates"], 2);
    EXPECT_GE(told["seconds"]["filter"], 0.0);
    ASSERT_EQ(told["filters"].size(), 4u);
    EXPECT_EQ(told["filters"][0]["name"], "name rules");
    EXPECT_EQ(told["filters"][0]["in"], 2);
    EXPECT_EQ(told["filters"][0]["out"], 1);
    EXPECT_EQ(told["filters"][1]["name"], "bounding spheres");
    EXPECT_EQ(told["filters"][1]["in"], 1);
    EXPECT_EQ(told["filters"][2]["name"], "oriented boxes");
    EXPECT_EQ(told["filters"][3]["name"], "exact object");
    EXPECT_EQ(told["filters"][3]["in"], told["filters"][2]["out"]);
    EXPECT_EQ(told["filters"][3]["out"], 0);
    const std::string summary = run("detect t.obj --output p.npy").err;
    EXPECT_TRUE(
        has_text(summary,
                 "pairs       1\nclasses     1 collision\nnot closed  3 of 3 objects have no inside (--weld joins "
                 "vertices): flat, beside, through\ncandidates  2\nfilter      bounding spheres: "));
    EXPECT_TRUE(has_text(summary, "\nfilter      exact object: 1 of "));
    EXPECT_FALSE(stats("t.obj --stage pairs").contains("filters"));
}

TEST_F(Stages, ResultsAreHeldAgainstABaseline) {
    ASSERT_EQ(run("detect t.obj --margin 1 --quiet --output old.jsonl").status, 0);
    const Outcome fewer = run("detect t.obj --baseline old.jsonl --output p.csv --stats s.json");
    ASSERT_EQ(fewer.status, 0);
    EXPECT_TRUE(has_text(fewer.err, "\nchanges     0 new, 1 same, 2 gone\n"));
    EXPECT_EQ(nlohmann::json::parse(content("s.json"))["gone"], 2);
    EXPECT_TRUE(has_text(content("p.csv"),
                         "0,2,t.obj/flat,t.obj/through,collision,,,,,,,,ab,,,flat,through,t.obj,t.obj,same\n0,1,"));
    // The result is the next baseline. Rows that are marked as gone are not part of that baseline.
    ASSERT_EQ(run("detect t.obj --baseline old.jsonl --output p.jsonl --quiet").status, 0);
    ASSERT_EQ(run("detect t.obj --baseline p.jsonl --margin 0.5 --stats s.json --output q.npy --quiet").status, 0);
    EXPECT_EQ(nlohmann::json::parse(content("s.json"))["new"], 1);
    EXPECT_EQ(nlohmann::json::parse(content("s.json"))["gone"], 0);
    EXPECT_EQ(run("detect t.obj --baseline none.jsonl").status, 4);
    write_file(file("bad.jsonl"), "{\"a\":0,\"b\":");
    EXPECT_EQ(run("detect t.obj --baseline bad.jsonl --output r.csv").status, 3);
    EXPECT_FALSE(std::filesystem::exists(file("r.csv")));
    for (const std::string with : {"--stage pairs", "--limit 1", "--count-only"}) {
        EXPECT_TRUE(has_text(refusal("t.obj --baseline p.jsonl " + with), "--baseline: ")) << with;
    }
}

TEST_F(Stages, ReportsAreTheSameFromRunToRun) {
    ASSERT_EQ(run("detect t.obj --stage features --report r.html --output p.csv --threads 1").status, 0);
    const std::string page = content("r.html");
    ASSERT_EQ(run("detect t.obj --stage features --report r.html --output p.csv --threads 3").status, 0);
    EXPECT_EQ(content("r.html"), page);
    EXPECT_EQ(run("detect t.obj --report none/r.html").status, 4);
    EXPECT_TRUE(has_text(refusal("t.obj --report r.txt"), "--report: r.txt: "));
    EXPECT_TRUE(has_text(refusal("t.obj --report r.html --count-only"), "--report: "));
    EXPECT_TRUE(has_text(data_of(page).at("view.json"), "\"up\":\"\",\"unit\":\"\"")) << "an OBJ file says neither";
}

/// A box that lacks a triangle has no inside: the box in it is left out, but counted.
TEST_F(Stages, UndecidedPairsAreCounted) {
    const auto box = [](const std::string& name, int low, int high, int first, bool whole) {
        std::string text = "o " + name + "\n";
        for (int i = 0; i < 8; ++i) {
            text += "v";
            for (int axis = 0; axis < 3; ++axis) text += " " + std::to_string((i >> axis & 1) != 0 ? high : low);
            text += "\n";
        }
        const int faces[12][3] = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                                  {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
        for (int i = 0; i < (whole ? 12 : 11); ++i) {
            text += "f";
            for (const int corner : faces[i]) text += " " + std::to_string(first + corner);
            text += "\n";
        }
        return text;
    };
    write_file(file("open.obj"), box("outer", 0, 9, 1, false) + box("inner", 2, 3, 9, true));
    write_file(file("closed.obj"), box("outer", 0, 9, 1, true) + box("inner", 2, 3, 9, true));
    EXPECT_TRUE(has_text(run("detect open.obj").err, "undecided   1 pair left out"));
    EXPECT_EQ(stats("open.obj")["undecided"], 1);
    EXPECT_EQ(stats("open.obj")["pairs"], 0);
    // As rows of their own class, if they are asked for.
    for (const std::string stage : {"objects", "features"}) {
        const Outcome listed =
            run("detect open.obj --stage " + stage + " --classes undecided,contained --output u.jsonl");
        EXPECT_TRUE(has_text(content("u.jsonl"), R"("class":"undecided")")) << content("u.jsonl");
        EXPECT_TRUE(has_text(listed.err, "classes     1 undecided")) << listed.err;
        EXPECT_FALSE(has_text(listed.err, "left out")) << listed.err;
        EXPECT_EQ(run("detect open.obj --verify --stage " + stage + " --classes undecided --count-only --quiet").out,
                  "1\n");
    }
    EXPECT_EQ(stats("closed.obj")["pairs"], 1);
    EXPECT_FALSE(stats("closed.obj").contains("undecided"));
}

/// The chord error of tessellated curves gives the default tolerance: a bolt in its hole touches, and the summary says why.
TEST_F(Stages, ChordErrorsGiveTheTolerance) {
    write_file(file("bolt.obj"), bolt_in_plate(0.99));
    const std::string detect = "detect bolt.obj --stage features --output b.jsonl";
    EXPECT_TRUE(has_text(run(detect).err, "classes     1 penetrating"));
    EXPECT_TRUE(has_text(content("b.jsonl"), R"("class":"penetrating")"));
    const Outcome with_chord = run(detect + " --chord 0.01 --stats s.json");
    EXPECT_TRUE(has_text(with_chord.err, "tolerance   0.02 (twice the chord error 0.01)")) << with_chord.err;
    EXPECT_TRUE(has_text(content("b.jsonl"), R"("class":"touching")")) << content("b.jsonl");
    EXPECT_TRUE(has_text(content("b.jsonl"), R"("thickness_kind":"at_most")")) << content("b.jsonl");
    EXPECT_TRUE(has_text(content("s.json"), R"("undecided_thickness": 0)")) << content("s.json");
    EXPECT_TRUE(has_text(run(detect + " --chord 0.01 --tolerance 0").err, "classes     1 penetrating"));
    EXPECT_EQ(run("detect bolt.obj --stage objects --chord 1").status, 2);
}

TEST_F(Stages, CoarseCoordinatesAreAWarning) {
    const auto save = [&](const std::string& name, const std::string& type, auto x) {
        const decltype(x) corners[] = {x, 0, 0, x, 1, 0, x, 0, 1};
        const auto bytes = std::as_bytes(std::span(corners));
        write_file(file(name), "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty " + type +
                                   " x\nproperty " + type + " y\nproperty " + type +
                                   " z\nelement face 1\nproperty list uchar uchar vertex_indices\nend_header\n" +
                                   std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()) +
                                   std::string("\3\0\1\2", 4));
    };
    save("far.ply", "float", 5410000.5f);
    save("exact.ply", "double", 5410000.5);
    save("near.ply", "float", 1.0f);
    EXPECT_TRUE(has_text(run("detect near.ply --stage features --chord 1e-9").err,
                         "(twice the chord error 1e-09, and the precision of float32)\n"));
    EXPECT_TRUE(has_text(run("detect near.ply --stage features").err, " (the precision of float32)\n"));
    const nlohmann::json far = stats("far.ply --stage pairs");
    ASSERT_EQ(far["warnings"].size(), 1u);
    EXPECT_EQ(
        far["warnings"][0].get<std::string>().find(
            "far.ply: coordinates up to 5.41e+06 were rounded to float32, in steps of 0.5; the scene measures 1."),
        0u);
    EXPECT_TRUE(has_text(run("detect far.ply --report r.html").err, "warning     far.ply: "));
    EXPECT_TRUE(has_text(data_of(content("r.html")).at("view.json"), "were rounded to float32"));
    EXPECT_FALSE(stats("exact.ply --stage features").contains("warnings"));
    EXPECT_FALSE(stats("near.ply --stage features --tolerance 1e-6").contains("warnings"));
    EXPECT_EQ(stats("near.ply --stage features --tolerance 1e-7")["warnings"].size(), 1u) << "a step is 1.2e-7";
}

TEST_F(Stages, ExitStatusIsOfWhatCameOut) {
    rules(R"({"exclude": [{"a": "*flat", "b": "*"}]})");
    EXPECT_EQ(run("detect t.obj --fail-on-collision --quiet").status, 1);
    EXPECT_EQ(run("detect t.obj --fail-on-collision --quiet --exclude r.json").status, 0);
}

TEST_F(Stages, WhatDoesNotGoTogetherIsRefused) {
    save_boxes("a.npy", {0, 0.5});
    EXPECT_EQ(refusal("a.npy --stage objects"),
              "octopair: --stage objects: a.npy has only boxes, no shapes; use --stage pairs\n");
    EXPECT_EQ(refusal("t.obj --against a.npy --stage objects"),
              "octopair: --stage objects: a.npy has only boxes, no shapes; use --stage pairs\n");
    EXPECT_EQ(refusal("t.obj --events --stage objects"), "octopair: --stage objects: not with --events\n");
    for (const std::string wrong :
         {"t.obj --adjacent include", "t.obj --objects triangle --stage pairs --adjacent include",
          "t.obj --max-contacts 3", "t.obj --objects triangle --stage features --max-contacts 3",
          "t.obj --stage features --max-contacts 4294967296", "t.obj --objects triangle --exclude r.json",
          "t.obj --objects triangle --same-parent exclude", "t.obj --objects triangle --padding p.npy", "t.obj --up y",
          "t.obj --unit m", "t.obj --report r.html --up x", "t.obj --report r.html --unit mile"}) {
        EXPECT_TRUE(refusal(wrong).starts_with("octopair: --")) << wrong;
    }
    EXPECT_TRUE(has_text(refusal("t.obj --stage everything"), "--stage: 'everything' is not a valid value"));
    EXPECT_TRUE(has_text(refusal("t.obj --same-parent no"), "--same-parent: 'no' is not a valid value"));
    // In a set of shapes and boxes, only boxes are compared.
    EXPECT_EQ(rows("t.obj a.npy --count-only"), rows("t.obj a.npy --count-only --stage pairs"));
}

#ifdef OCTOPAIR_WITH_PROCESSES
TEST_F(Stages, SameBytesFromWorkers) {
    EXPECT_EQ(rows("t.obj t.obj --engine processes --workers 2"), rows("t.obj t.obj"));
    EXPECT_EQ(rows("t.obj t.obj --engine processes --workers 3 --limit 3"), rows("t.obj t.obj --limit 3 --threads 1"));
}
#endif

#endif

}  // namespace
}  // namespace octopair::test
