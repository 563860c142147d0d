// Tests --statuses: what people decide about collisions stays from run to run, and goes into results and BCF files.
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <span>
#include <tuple>

#include "cli/ifc_storey.hpp"
#include "cli/program.hpp"

namespace octopair::test {
namespace {

#if defined(OCTOPAIR_WITH_MESHES) && defined(OCTOPAIR_WITH_PIPELINE)

using nlohmann::json;

class Statuses : public ProgramTest {
protected:
    /// A floor with columns in it, and a beam on the first two columns.
    static IfcStorey building() {
        return {{{"00000000000000000000F1", "Floor", {0, 0, 0}, {20, 4, 0.2}, "IFCSLAB"},
                 {"00000000000000000000C1", "C1", {-4, 0, 0.1}, {0.3, 0.3, 3}, "IFCCOLUMN"},
                 {"00000000000000000000C2", "C2", {-2, 0, 0.1}, {0.3, 0.3, 3}, "IFCCOLUMN"},
                 {"00000000000000000000C3", "C3", {2, 0, 0.1}, {0.3, 0.3, 3}, "IFCCOLUMN"},
                 {"00000000000000000000B1", "Beam", {-3, 0, 3}, {3, 0.2, 0.3}, "IFCBEAM"}}};
    }
    static IfcElement& box(IfcStorey& model, const std::string& name) {
        for (IfcElement& one : model.boxes) {
            if (one.name == name) return one;
        }
        throw std::runtime_error("no box " + name);
    }
    static std::string key(const std::string& a, const std::string& b) {
        const std::string prefix = "0000000000000000000001/00000000000000000000";
        return prefix + a + " | " + prefix + b;
    }
    void write(const IfcStorey& model) const { write_file(file("model.ifc"), model.text()); }
    Outcome detect(const std::string& more = "", const std::string& output = "r.jsonl") const {
        return run("detect model.ifc --stage features --statuses s.json --stats t.json --output " + output + " " +
                   more);
    }
    /// Returns the status by the last characters of the two ids, for example "C1 F1".
    std::map<std::string, std::string> statuses() const {
        std::map<std::string, std::string> statuses;
        const json all = json::parse(content("s.json"));
        for (const json& entry : all["collisions"]) {
            const std::string key = entry["key"];
            const std::size_t bar = key.find(" | ");
            statuses[key.substr(bar - 2, 2) + ' ' + key.substr(key.size() - 2)] = entry["status"];
        }
        return statuses;
    }
    /// Changes an entry of the file, as a person would do it.
    void decide(const std::string& of_key, const std::string& status, const std::string& comment = "") const {
        json all = json::parse(content("s.json"));
        bool found = false;
        for (json& entry : all["collisions"]) {
            if (entry["key"] != of_key) continue;
            entry["status"] = status;
            entry["comment"] = comment;
            found = true;
        }
        ASSERT_TRUE(found) << of_key;
        write_file(file("s.json"), all.dump());
    }
};

using Words = std::map<std::string, std::string>;

/// Five versions of a model, with what people decide after each.
TEST_F(Statuses, AMonthOfVersions) {
    IfcStorey model = building();
    write(model);
    ASSERT_EQ(detect().status, 0);
    EXPECT_EQ(statuses(),
              (Words{{"B1 C1", "new"}, {"B1 C2", "new"}, {"C1 F1", "new"}, {"C2 F1", "new"}, {"C3 F1", "new"}}));
    decide(key("C1", "F1"), "approved", "cast together");
    decide(key("C2", "F1"), "active");
    decide(key("B1", "C1"), "reviewed", "see \"detail 3\"");

    // Version 2: the storey, the file and an element have other names, and the order is another one. Nothing changes.
    model.storey = "Ground floor";
    box(model, "Floor").name = "Slab 200";
    std::swap(model.boxes[0], model.boxes[4]);
    write(model);
    ASSERT_EQ(shell("mv model.ifc other.ifc").status, 0);
    ASSERT_EQ(run("detect other.ifc --stage features --statuses s.json --output r.jsonl --quiet").status, 0);
    const Words decided = {
        {"B1 C1", "reviewed"}, {"B1 C2", "new"}, {"C1 F1", "approved"}, {"C2 F1", "active"}, {"C3 F1", "new"}};
    EXPECT_EQ(statuses(), decided);

    // Version 3: the beam is shorter, and a column is away. Their collisions are resolved, whatever was decided.
    box(model, "Beam").at[0] = -2.5;
    box(model, "Beam").size[0] = 1.5;
    box(model, "C3").at[0] = 200;
    write(model);
    ASSERT_EQ(detect().status, 0);
    EXPECT_EQ(statuses(), (Words{{"B1 C1", "resolved"},
                                 {"B1 C2", "new"},
                                 {"C1 F1", "approved"},
                                 {"C2 F1", "active"},
                                 {"C3 F1", "resolved"}}));

    // Version 4: the beam is back, and there is a new pipe in the first column.
    IfcStorey first = building();
    box(model, "Beam") = box(first, "Beam");
    model.boxes.push_back({"00000000000000000000P1", "Pipe", {-4, 0, 1}, {0.1, 2, 0.1}, "IFCBUILDINGELEMENTPROXY"});
    write(model);
    ASSERT_EQ(detect().status, 0);
    EXPECT_EQ(statuses(), (Words{{"B1 C1", "new"},
                                 {"B1 C2", "new"},
                                 {"C1 F1", "approved"},
                                 {"C1 P1", "new"},
                                 {"C2 F1", "active"},
                                 {"C3 F1", "resolved"}}));
    EXPECT_TRUE(has_text(content("s.json"), R"("comment": "see \"detail 3\"")")) << "a comment stays";
    decide(key("B1", "C1"), "approved");
    decide(key("B1", "C2"), "approved");
    decide(key("C1", "P1"), "approved");
    EXPECT_EQ(detect("--fail-on-collision").status, 1) << "C2 in the floor is active";

    // Version 5: that column is higher. All that is left was approved.
    box(model, "C2").at[2] = 0.5;
    write(model);
    EXPECT_EQ(detect("--fail-on-collision").status, 0);
    EXPECT_EQ(statuses(), (Words{{"B1 C1", "approved"},
                                 {"B1 C2", "approved"},
                                 {"C1 F1", "approved"},
                                 {"C1 P1", "approved"},
                                 {"C2 F1", "resolved"},
                                 {"C3 F1", "resolved"}}));
    EXPECT_EQ(json::parse(content("t.json"))["statuses"],
              (json{{"new", 0}, {"active", 0}, {"reviewed", 0}, {"approved", 4}, {"resolved", 2}}));
}

TEST_F(Statuses, AreInRowsAndInAStableFile) {
    write(building());
    const Outcome first = detect();
    ASSERT_EQ(first.status, 0) << first.err;
    EXPECT_TRUE(has_text(first.err, "\nstatuses    5 new, 0 active, 0 reviewed, 0 approved, 0 resolved\n"))
        << first.err;
    const std::string fresh = content("s.json");
    EXPECT_EQ(
        fresh.substr(0, fresh.find("},") + 1),
        "{\n\"options\": \"\",\n\"collisions\": [\n{\"key\": \"" + key("B1", "C1") +
            R"x(", "status": "new", "comment": "", "class": "penetrating", "a": "Beam (IfcBeam)", "b": "C1 (IfcColumn)"})x");
    ASSERT_EQ(detect("--threads 1 --order octal").status, 0);
    EXPECT_EQ(content("s.json"), fresh) << "the same bytes for every order";
    decide(key("C1", "F1"), "active", "a, \"b\"");
    ASSERT_EQ(run("detect model.ifc --stage features --statuses s.json --output r.csv --quiet").status, 0);
    EXPECT_TRUE(has_text(content("r.csv"), ",key,status,comment\n"));
    EXPECT_TRUE(has_text(content("r.csv"), key("C1", "F1") + ",active,\"a, \"\"b\"\"\"\n")) << content("r.csv");
    ASSERT_EQ(detect().status, 0);
    EXPECT_TRUE(has_text(content("r.jsonl"), key("C1", "F1") + R"(","status":"active","comment":"a, \"b\"",)"));
    ASSERT_EQ(run("detect model.ifc --stage features --output r.csv --quiet").status, 0);
    EXPECT_FALSE(has_text(content("r.csv"), ",status"));
}

TEST_F(Statuses, KeepWhatPeopleAdd) {
    write(building());
    ASSERT_EQ(detect().status, 0);
    json all = json::parse(content("s.json"));
    all["team"] = {{"lead", "Ada"}};
    all["collisions"][1]["assigned"] = {"Ada", 7, 0.5};
    write_file(file("s.json"), all.dump());
    ASSERT_EQ(detect().status, 0);
    EXPECT_EQ(json::parse(content("s.json")), all);
    const std::string once = content("s.json");
    ASSERT_EQ(detect().status, 0);
    EXPECT_EQ(content("s.json"), once);
}

TEST_F(Statuses, WrongFilesAreErrorsAndStay) {
    write(building());
    ASSERT_EQ(detect().status, 0);
    const std::string entry = R"({"key": "k", "status": "new"})";
    const std::pair<std::string, std::string> cases[] = {
        {"", "s.json: parse error at line 1"},
        {"{\"collisions\": [", "s.json: "},
        {"{}", "s.json: the key 'collisions' is missing"},
        {R"({"collisions": [{"key": "k", "status": "open"}]})",
         "s.json: collisions[0]: status: 'open' is none of new, active, reviewed, approved, resolved"},
        {R"({"collisions": [{"status": "new"}]})", "s.json: collisions[0]: the key 'key' is missing"},
        {R"({"collisions": [)" + entry + "," + entry + "]}", "s.json: collisions[1]: key: 'k' is twice in the file"},
        {R"({"collisions": [{"key": "k", "status": "new", "comment": 7}]})",
         "collisions[0]: comment: a number, not a string"},
    };
    for (const auto& [text, words] : cases) {
        write_file(file("s.json"), text);
        std::filesystem::remove(file("r.jsonl"));
        const Outcome outcome = detect();
        EXPECT_EQ(outcome.status, 3) << text;
        EXPECT_TRUE(has_text(outcome.err, words)) << outcome.err;
        EXPECT_EQ(content("s.json"), text) << "the file stays";
        EXPECT_FALSE(std::filesystem::exists(file("r.jsonl"))) << "nothing is searched";
    }
    for (const char* with : {"--stage pairs --statuses s.json", "--count-only --statuses s.json", "--statuses s.txt",
                             "--statuses model.ifc", "--statuses s.json --stats s.json"}) {
        EXPECT_EQ(run("detect model.ifc " + std::string(with)).status, 2) << with;
    }
}

TEST_F(Statuses, RunsThatFailChangeNothing) {
    write(building());
    ASSERT_EQ(detect().status, 0);
    decide(key("C1", "F1"), "approved");
    const std::string before = content("s.json");
    IfcStorey away = building();
    for (IfcElement& one : away.boxes) one.at[1] += 10 * one.at[0];
    write(away);
    EXPECT_EQ(run("detect model.ifc --stage features --statuses s.json --output /dev/full").status, 4);
    EXPECT_EQ(content("s.json"), before);
    EXPECT_EQ(run("detect model.ifc --stage features --statuses none/s.json --output r.csv").status, 4);
    // The reader never reads, so the pipe fills and the program blocks in a write. Only SIGINT can end the program.
    json objects = json::array();
    for (int i = 0; i < 80; ++i) objects.push_back({{"shape", {{"type", "sphere"}, {"radius", 1}}}});
    write_file(file("balls.json"), json{{"objects", objects}}.dump());
    EXPECT_EQ(shell("mkfifo pipe; exec 3<>pipe; \"$P\" detect balls.json --statuses s.json --quiet >pipe & child=$!; "
                    "hears $child; kill -INT $child; wait $child")
                  .status,
              130);
    EXPECT_EQ(content("s.json"), before);
}

/// Options that leave out rows resolve nothing.
TEST_F(Statuses, WhatOptionsLeaveOutStays) {
    write(building());
    ASSERT_EQ(detect().status, 0);
    decide(key("C1", "F1"), "approved");
    const Words before = statuses();
    write_file(file("rules.json"), R"({"exclude": [{"a": {"type": "IfcColumn"}, "b": {"type": "*"}}]})");
    for (const std::string more :
         {"--limit 1", "--min-depth 100", "--min-depth 100 --tolerance 0.5", "--classes touching",
          "--exclude rules.json", "--classes contained --engine processes --workers 2", "--same-parent exclude"}) {
#ifndef OCTOPAIR_WITH_PROCESSES
        if (has_text(more, "processes")) continue;
#endif
        ASSERT_EQ(detect(more).status, 0) << more;
        EXPECT_EQ(statuses(), before) << more;
    }
    IfcStorey away = building();
    box(away, "C1").at[0] = 100;
    write(away);
    ASSERT_EQ(detect("--classes touching").status, 0);
    Words after = before;
    after["C1 F1"] = after["B1 C1"] = "resolved";
    EXPECT_EQ(statuses(), after) << "what is not found at all is resolved";
}

/// Decisions about undecided pairs stay if the pairs are no rows, because --classes does not name their class.
TEST_F(Statuses, UndecidedPairsThatAreNoRowsStay) {
    // A box in another one that lacks a triangle. `at`: the place of the first corner of the inner box.
    const auto write_boxes = [&](int at) {
        std::string text;
        for (const auto& [name, low, high, triangles] :
             {std::tuple("outer", 0, 9, 11), std::tuple("inner", at, at + 1, 12)}) {
            text += std::string("o ") + name + '\n';
            for (int i = 0; i < 8; ++i) {
                text += 'v';
                for (int axis = 0; axis < 3; ++axis) text += ' ' + std::to_string((i >> axis & 1) != 0 ? high : low);
                text += '\n';
            }
            const int faces[12][3] = {{8, 6, 5}, {8, 5, 7}, {4, 3, 1}, {4, 1, 2}, {8, 4, 2}, {8, 2, 6},
                                      {7, 5, 1}, {7, 1, 3}, {8, 7, 3}, {8, 3, 4}, {6, 2, 1}, {6, 1, 5}};
            for (const auto& [a, b, c] : std::span(faces).first(std::size_t(triangles)))
                text += "f " + std::to_string(a - 9) + ' ' + std::to_string(b - 9) + ' ' + std::to_string(c - 9) + '\n';
        }
        write_file(file("open.obj"), text);
    };
    const auto status = [&](const std::string& more) {
        const Outcome outcome = run("detect open.obj --statuses s.json --output r.jsonl " + more);
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        return json::parse(content("s.json"))["collisions"].at(0)["status"].get<std::string>();
    };
    write_boxes(2);
    EXPECT_EQ(status("--classes undecided"), "new");
    decide(json::parse(content("s.json"))["collisions"][0]["key"], "approved");
    for (const std::string more : {"", "--stage features", "--stage features --min-depth 1", "--verify",
                                   "--classes contained", "--classes clearance --verify"}) {
        EXPECT_EQ(status(more), "approved") << more;
        EXPECT_EQ(content("r.jsonl"), "") << more;
    }
    EXPECT_TRUE(has_text(run("detect open.obj --statuses s.json").err, "undecided   1 pair left out"));
    write_boxes(20);
    EXPECT_EQ(status(""), "resolved");
}

TEST_F(Statuses, BelongToTheOptionsThatSayWhatACollisionIs) {
    write(building());
    ASSERT_EQ(detect("--margin 0.5").status, 0);
    const std::string before = content("s.json");
    const Outcome other = detect();
    EXPECT_EQ(other.status, 2);
    EXPECT_TRUE(has_text(other.err,
                         "s.json: its statuses belong to a run with --margin 0.5; this run has no option that matters"))
        << other.err;
    EXPECT_EQ(content("s.json"), before);
    EXPECT_EQ(detect("--margin 0.50").status, 0);
    ASSERT_EQ(shell("sed -i '/^\"options\"/d' s.json").status, 0);
    EXPECT_EQ(detect().status, 0);
}

TEST_F(Statuses, NearObjectsThatMeetAreNew) {
    IfcStorey model = building();
    box(model, "Beam").at[2] = 3.2;
    write(model);
    ASSERT_EQ(detect("--margin 0.2").status, 0);
    decide(key("B1", "C1"), "approved");
    EXPECT_TRUE(has_text(content("s.json"), "clearance"));
    write(building());
    ASSERT_EQ(detect("--margin 0.2").status, 0);
    EXPECT_EQ(statuses()["B1 C1"], "new");
}

class Bcf : public Statuses {
protected:
    void SetUp() override {
        if (shell("command -v xmllint >&2").status != 0) GTEST_SKIP() << "no xmllint; scripts/setup tests installs it";
    }
    /// Checks a BCF file against the schemas, and returns its topics.
    json topics(const std::string& name) const {
        const Outcome outcome = shell("python3 " OCTOPAIR_BCF_READER " " + name);
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        return json::parse(outcome.out);
    }
    std::map<std::string, json> by_title(const std::string& name) const {
        std::map<std::string, json> all;
        for (const json& topic : topics(name)) all[topic["title"]] = topic;
        return all;
    }
};

TEST_F(Bcf, HasATopicForEachCollision) {
    IfcStorey model = building();
    model.unit = ".MILLI.";
    model.units_a_metre = 1000;
    box(model, "C1").name = "C<1> & \"co\"";
    write(model);
    ASSERT_EQ(detect().status, 0);
    decide(key("C1", "F1"), "approved", "cast <together>");
    ASSERT_EQ(detect("--quiet", "r.bcf").status, 0);
    const auto all = by_title("r.bcf");
    ASSERT_EQ(all.size(), 5u);
    const json& topic = all.at("Floor (IfcSlab) and C<1> & \"co\" (IfcColumn)");
    EXPECT_EQ(topic["status"], "approved");
    EXPECT_EQ(topic["comments"], json::array({"cast <together>"}));
    EXPECT_EQ(topic["labels"], json::array({"penetrating"}));
    EXPECT_EQ(topic["selection"], json::array({"00000000000000000000F1", "00000000000000000000C1"}));
    EXPECT_EQ(topic["visible"], topic["selection"]);
    EXPECT_EQ(topic["files"], json::array({json::array({"model.ifc", "0000000000000000000001"})}));
    EXPECT_TRUE(has_text(topic["description"], "penetrating, 0.1 m deep, at (-")) << topic["description"];
    EXPECT_EQ(all.at("Floor (IfcSlab) and C2 (IfcColumn)")["status"], "new");
}

/// The camera of each topic looks at the contact: a ray through the middle of the view meets the common part of both elements.
TEST_F(Bcf, CamerasLookAtContacts) {
    write(building());
    ASSERT_EQ(detect("--quiet", "r.bcf").status, 0);
    for (const auto& [title, topic] : by_title("r.bcf")) {
        SCOPED_TRACE(title);
        const std::array<double, 3> place = topic["place"], direction = topic["direction"], up = topic["up"];
        double length = 0, across = 0;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            length += direction[axis] * direction[axis];
            across += direction[axis] * up[axis];
        }
        EXPECT_NEAR(length, 1, 1e-9);
        EXPECT_NEAR(across, 0, 1e-9);
        EXPECT_GT(up[2], 0.5);
        // The contact is in the text, in metres.
        const std::string text = topic["description"];
        std::array<double, 3> contact;
        ASSERT_EQ(std::sscanf(text.c_str() + text.find('('), "(%lf, %lf, %lf)", &contact[0], &contact[1], &contact[2]),
                  3);
        const double away = (contact[0] - place[0]) / direction[0];
        EXPECT_GT(away, 0.1);
        EXPECT_LT(away, 30);
        for (std::size_t axis = 0; axis < 3; ++axis)
            EXPECT_NEAR(place[axis] + away * direction[axis], contact[axis], 1e-4);
    }
}

TEST_F(Bcf, HasTheSameBytesAndGuidsFromRunToRun) {
    IfcStorey model = building();
    write(model);
    ASSERT_EQ(detect("--threads 1", "r.bcf").status, 0);
    const std::string bytes = content("r.bcf");
    ASSERT_EQ(detect("--threads 3", "r.bcfzip").status, 0);
    EXPECT_EQ(content("r.bcfzip"), bytes);
    std::map<std::string, std::string> guids;
    for (const json& topic : topics("r.bcf")) guids[topic["selection"].dump()] = topic["guid"];
    box(model, "Floor").name = "Slab";
    box(model, "C1").at[1] = 0.05;
    write(model);
    ASSERT_EQ(detect("--quiet", "r.bcf").status, 0);
    for (const json& topic : topics("r.bcf"))
        EXPECT_EQ(guids[topic["selection"].dump()], topic["guid"].get<std::string>());
    EXPECT_EQ(run("detect model.ifc --output r.bcf --stage pairs").status, 2);
    EXPECT_EQ(run("detect model.ifc --output r.bcf --objects triangle").status, 2);
    save_boxes("a.npy", {0, 0.5});
    EXPECT_TRUE(has_text(run("detect a.npy --output r.bcf").err, "r.bcf: BCF holds collisions"));
    EXPECT_TRUE(has_text(run("detect a.npy --events --output r.bcf").err, "r.bcf: events are rows of text"));
}

/// An element with many collisions has one topic for all of them.
TEST_F(Bcf, AnElementThatMeetsManyIsOneTopic) {
    IfcStorey model = building();
    for (int i = 0; i < 9; ++i) {
        model.boxes.push_back({"0000000000000000000D0" + std::to_string(i),
                               "D" + std::to_string(i),
                               {4 + 0.5 * i, 1, 0.1},
                               {0.1, 0.1, 1},
                               "IFCCOLUMN"});
    }
    write(model);
    ASSERT_EQ(detect().status, 0);
    for (const char* column : {"C1", "C2", "C3"}) decide(key(column, "F1"), "approved", std::string("fine, ") + column);
    ASSERT_EQ(detect("--quiet", "r.bcf").status, 0);
    const auto all = by_title("r.bcf");
    ASSERT_EQ(all.size(), 3u) << "the floor with 12 columns, and the beam with two";
    const json& floor = all.at("Floor (IfcSlab): 12 collisions");
    EXPECT_EQ(floor["selection"].size(), 13u);
    EXPECT_EQ(floor["selection"][0], "00000000000000000000F1");
    EXPECT_EQ(floor["status"], "new") << "the least decided of all";
    EXPECT_EQ(floor["comments"].size(), 3u);
    EXPECT_LT(floor["place"][2], 3) << "the camera shows the deepest contact, not the whole floor";
    EXPECT_TRUE(has_text(floor["description"], "\nD8 (IfcColumn): penetrating, "));
}

/// Characters that XML 1.0 does not have become U+FFFD.
TEST_F(Bcf, AllTextsAreValidXml) {
    const json names = {"a\x01\xEF\xBF\xBE", "b\xEF\xBF\xBF\xEF\xBF\xBF", "c\xEF\xBF\xBC"};
    json objects = json::array();
    for (const json& name : names) objects.push_back({{"name", name}, {"shape", {{"type", "sphere"}, {"radius", 1}}}});
    write_file(file("balls.json"), json{{"objects", objects}}.dump());
    ASSERT_EQ(run("detect balls.json --output r.bcf --quiet").status, 0);
    const std::string replacement = "\xEF\xBF\xBD", a = "1:a" + replacement + replacement,
                      b = "1:b" + replacement + replacement, c = "1:c\xEF\xBF\xBC";
    std::set<std::string> keys;
    for (const json& topic : topics("r.bcf")) keys.insert(topic["selection"].dump());
    EXPECT_EQ(keys, (std::set<std::string>{json{a, b}.dump(), json{a, c}.dump(), json{b, c}.dump()}));
}

TEST_F(Bcf, ObjectsWithoutIfcIdsHaveTheirKeys) {
    write_file(file("balls.json"),
               R"({"objects": [{"name": "a", "shape": {"type": "sphere", "radius": 1}},)"
               R"({"name": "b", "shape": {"type": "sphere", "radius": 1}, "position": [2.5, 0, 0]}]})");
    ASSERT_EQ(run("detect balls.json --margin 1 --output r.bcf --unit mm --up y --quiet").status, 0);
    const json topic = topics("r.bcf").at(0);
    EXPECT_EQ(topic["selection"], json::array({"1:a", "1:b"}));
    EXPECT_EQ(topic["description"], "clearance, 0.0005 m apart, at (0.00125, 0, 0)");
    EXPECT_GT(topic["up"][1], 0.5);
    for (const std::string unit : {"um", "µm"}) {
        ASSERT_EQ(run("detect balls.json --margin 1 --output r.bcf --unit " + unit + " --quiet").status, 0);
        EXPECT_EQ(topics("r.bcf").at(0)["description"], "clearance, 5e-07 m apart, at (1.25e-06, 0, 0)");
    }
    EXPECT_EQ(run("detect balls.json --output none.bcf --quiet").status, 0);
    EXPECT_EQ(topics("none.bcf"), json::array()) << "without collisions, a file without topics";
    ASSERT_EQ(shell("cp balls.json more.json").status, 0);
    ASSERT_EQ(run("detect balls.json --against more.json --output r.bcf --quiet").status, 0);
    EXPECT_EQ(topics("r.bcf").size(), 2u);
}

#endif

}  // namespace
}  // namespace octopair::test
