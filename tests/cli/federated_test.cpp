// Tests building models: elements that are lost, rules by relations, units and places of several models.
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <utility>

#include "cli/program.hpp"
#include "io/ifc_model.hpp"

namespace octopair::test {
namespace {

#if defined(OCTOPAIR_WITH_MESHES) && defined(OCTOPAIR_WITH_PIPELINE)

using nlohmann::json;

class Federated : public ProgramTest {
protected:
    void save(const std::string& name, const IfcModel& model) const { write_file(file(name), model.text()); }
};

TEST_F(Federated, LostElementsAreTold) {
    IfcModel model;
    model.add_box("IFCWALL", "wall", {0, 0, 0, 4, 1, 3});
    model.add_box("IFCBEAM", "beam", {3, 0, 2, 8, 1, 4});
    model.add_element("IFCBEAM", "block", model.add("IFCBLOCK(#9,1.,1.,1.)"));
    model.add_element("IFCSPACE", "room", model.add("IFCBLOCK(#9,1.,1.,1.)"));
    save("a.ifc", model);
    const std::string warning = "1 of 3 elements with geometry were not read: 1 IFCBEAM, the first is " +
                                ifc_id("block") + " ('block'). Export the model as glTF or OBJ\n";
    const Outcome outcome = run("detect a.ifc --stats s.json -o p.csv");
    EXPECT_TRUE(has_text(outcome.err,
                         "\nelements    2 of 3 with geometry were read; left out on purpose: IFCSPACE 1\n"
                         "warning     a.ifc: " +
                             warning));
    const json elements = json::parse(content("s.json"))["elements"];
    EXPECT_EQ(elements["with_geometry"], 3);
    EXPECT_EQ(elements["read"], 2);
    ASSERT_EQ(elements["lost"].size(), 1u);
    EXPECT_EQ(elements["lost"][0]["file"], "a.ifc");
    EXPECT_EQ(elements["lost"][0]["type"], "IFCBEAM");
    EXPECT_EQ(elements["lost"][0]["count"], 1);
    EXPECT_EQ(elements["lost"][0]["first"], ifc_id("block") + " ('block')");
    EXPECT_EQ(elements["left_out"]["IFCSPACE"], 1);
    const std::string info = run("info a.ifc").out;
    EXPECT_TRUE(has_text(info, "elements         2 of 3 with geometry were read\n"));
    EXPECT_TRUE(has_text(info, "not read         IFCSPACE (1)\n"));
    EXPECT_TRUE(has_text(info, "warning          " + warning));
}

TEST_F(Federated, ElementsOfAllInputsAreCounted) {
    IfcModel model;
    model.add_box("IFCWALL", "wall", {0, 0, 0, 4, 1, 3});
    save("a.ifc", model);
    save("b.ifc", model);
    write_file(file("c.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    EXPECT_TRUE(
        has_text(run("detect a.ifc b.ifc c.obj -o p.csv").err, "\nelements    2 of 2 with geometry were read\n"));
    EXPECT_TRUE(
        has_text(run("detect a.ifc --against b.ifc -o p.csv").err, "\nelements    2 of 2 with geometry were read\n"));
    EXPECT_FALSE(has_text(run("detect c.obj -o p.csv").err, "elements"));
}

/// Pairs of names of elements, each in alphabetical order.
using NamePairs = std::set<std::pair<std::string, std::string>>;

class RelationRules : public Federated {
protected:
    /// Returns the pairs that detect finds, by the names of the elements.
    NamePairs pairs(const std::string& arguments) const {
        const Outcome outcome = run("detect " + arguments + " -o p.jsonl");
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        NamePairs found;
        std::istringstream lines(content("p.jsonl"));
        for (std::string line; std::getline(lines, line);) {
            const json row = json::parse(line);
            const auto word = [&](const char* key) {
                const std::string name = row[key];  // ends with TYPE_WORD_GLOBALID
                const std::string type_and_word = name.substr(name.rfind('/') + 1, name.size() - name.rfind('/') - 24);
                return type_and_word.substr(type_and_word.find('_') + 1);
            };
            found.insert(std::minmax(word("a_name"), word("b_name")));
        }
        return found;
    }
};

/// Two walls, and two doors in the opening of the first. One door is where the second wall is.
IfcModel walls_and_doors(const std::string& project = "project") {
    IfcModel model("$", project);
    const int wall = model.add_box("IFCWALL", "wall", {0, 0, 0, 10, 0.5, 3});
    model.add_box("IFCWALL", "other", {0, 5, 0, 10, 5.5, 3});
    model.fill(wall, model.add_box("IFCDOOR", "door", {2, -0.1, 0, 3, 0.6, 2}));
    model.fill(wall, model.add_box("IFCDOOR", "near", {2.9, -0.1, 0, 4, 0.6, 2}));
    model.fill(wall, model.add_box("IFCDOOR", "moved", {2, 4.9, 0, 3, 5.6, 2}));
    return model;
}

TEST_F(RelationRules, WhatFillsAnOpeningOfItsHost) {
    save("a.ifc", walls_and_doors());
    EXPECT_EQ(pairs("a.ifc"), (NamePairs{{"door", "wall"}, {"near", "wall"}, {"door", "near"}, {"moved", "other"}}));
    const NamePairs rest = {{"door", "near"}, {"moved", "other"}};
    write_file(file("r.json"), R"({"exclude": [{"relation": "fills"}]})");
    for (const std::string options : {"--exclude fills", "--exclude r.json",
                                      "--exclude fills --stage features --verify", "--exclude fills --stage pairs",
                                      "--exclude fills --engine processes --workers 2", "--exclude fills,assembly"})
        EXPECT_EQ(pairs("a.ifc " + options), rest) << options;
    write_file(file("r.json"), R"({"exclude": [{"relation": "fills"}, {"a": {"id": "*moved"}, "b": "*"}]})");
    EXPECT_EQ(pairs("a.ifc --exclude r.json"), (NamePairs{{"door", "near"}}));
}

/// A wall of two layers, of which only the first has the opening; a panel fills it, and a window fills an opening of the panel.
TEST_F(RelationRules, HostsOfHosts) {
    IfcModel model;
    const int core = model.add_box("IFCBUILDINGELEMENTPART", "core", {0, 0, 0, 10, 0.5, 3});
    const int cover = model.add_box("IFCBUILDINGELEMENTPART", "cover", {0, 0.5, 0, 10, 0.6, 3});
    const int wall = model.add_box("IFCWALL", "wall", {0, 0, 0, 10, 0.6, 3});
    const int panel = model.add_box("IFCWALL", "panel", {2, -0.1, 0, 6, 0.55, 3});
    const int window = model.add_box("IFCWINDOW", "window", {3, -0.2, 1, 4, 0.55, 2});
    const int pane = model.add_box("IFCPLATE", "pane", {3, -0.1, 1, 4, 0.55, 2});
    model.aggregate(wall, {core, cover});
    model.aggregate(window, {pane});
    model.fill(core, panel);
    model.fill(panel, window);
    save("a.ifc", model);
    NamePairs expected = pairs("a.ifc");
    EXPECT_EQ(expected.size(), 15u);
    for (const auto& [filler, host] : {std::pair("panel", "core"),
                                       {"panel", "wall"},
                                       {"window", "panel"},
                                       {"pane", "panel"},
                                       {"window", "core"},
                                       {"pane", "core"},
                                       {"window", "wall"},
                                       {"pane", "wall"}}) {
        EXPECT_EQ(expected.erase(std::minmax(std::string(filler), std::string(host))), 1u) << filler << host;
    }
    EXPECT_EQ(pairs("a.ifc --exclude fills"), expected) << "the cover has no opening";
}

/// An opening in the whole is one in its parts.
TEST_F(RelationRules, PartsOfTheHost) {
    IfcModel model;
    const int wall = model.add_whole("IFCWALL", "wall");
    model.aggregate(wall, {model.add_box("IFCBUILDINGELEMENTPART", "core", {0, 0, 0, 10, 0.5, 3}),
                           model.add_box("IFCBUILDINGELEMENTPART", "cover", {0, 0.5, 0, 10, 0.6, 3})});
    model.fill(wall, model.add_box("IFCDOOR", "door", {2, -0.1, 0, 3, 0.6, 2}));
    save("a.ifc", model);
    EXPECT_EQ(pairs("a.ifc --exclude fills"), (NamePairs{{"core", "cover"}}));
}

TEST_F(RelationRules, AssembliesMayBeNested) {
    IfcModel model;
    const IfcBox box = {0, 0, 0, 1, 1, 1};
    const int stair = model.add_whole("IFCSTAIR", "stair"), flight = model.add_whole("IFCMEMBER", "flight");
    model.aggregate(stair, {flight, model.add_box("IFCRAILING", "railing", box)});
    model.aggregate(flight, {model.add_box("IFCMEMBER", "left", box), model.add_box("IFCMEMBER", "right", box)});
    model.add_box("IFCSLAB", "slab", box);
    const int own = model.add_box("IFCSTAIR", "stair2", box);
    model.aggregate(own, {model.add_box("IFCRAILING", "railing2", box)});
    save("a.ifc", model);
    EXPECT_EQ(pairs("a.ifc").size(), 15u);
    NamePairs expected = pairs("a.ifc");
    for (const auto& [a, b] :
         {std::pair("left", "right"), {"left", "railing"}, {"railing", "right"}, {"railing2", "stair2"}})
        EXPECT_EQ(expected.erase({a, b}), 1u) << a << b;
    EXPECT_EQ(pairs("a.ifc --exclude assembly"), expected);
}

/// Elements that fill openings of each other do not stop the program.
TEST_F(RelationRules, CirclesOfHostsEnd) {
    IfcModel model;
    const IfcBox box = {0, 0, 0, 1, 1, 1};
    const int a = model.add_box("IFCWALL", "a", box), b = model.add_box("IFCWALL", "b", box);
    const int c = model.add_box("IFCWALL", "c", box);
    model.fill(a, b);
    model.fill(b, a);
    model.fill(c, c);
    save("a.ifc", model);
    EXPECT_EQ(pairs("a.ifc --exclude fills,assembly,system"), (NamePairs{{"a", "c"}, {"b", "c"}}));
}

TEST_F(RelationRules, Systems) {
    IfcModel model;
    const IfcBox box = {0, 0, 0, 1, 1, 1};
    std::map<std::string, int> parts;
    for (const std::string name : {"cold1", "cold2", "hot", "both", "none", "pump"})
        parts[name] = model.add_box("IFCFLOWSEGMENT", name, box);
    const int motor = model.add_box("IFCFLOWSEGMENT", "motor", box);
    model.aggregate(parts["pump"], {motor});
    model.add_system("IFCSYSTEM", {parts["cold1"], parts["cold2"], parts["both"], parts["pump"]});
    model.add_system("IFCDISTRIBUTIONSYSTEM", {parts["hot"], parts["both"]});
    model.add_system("IFCZONE", {parts["none"], parts["hot"]});
    save("a.ifc", model);
    NamePairs expected = pairs("a.ifc");
    EXPECT_EQ(expected.size(), 21u);
    for (const auto& [a, b] : {std::pair("cold1", "cold2"),
                               {"both", "cold1"},
                               {"both", "cold2"},
                               {"both", "hot"},
                               {"both", "pump"},
                               {"cold1", "pump"},
                               {"cold2", "pump"},
                               {"both", "motor"},
                               {"cold1", "motor"},
                               {"cold2", "motor"},
                               {"motor", "pump"}})
        EXPECT_EQ(expected.erase({a, b}), 1u) << a << b;
    EXPECT_EQ(pairs("a.ifc --exclude system"), expected);
}

/// GlobalIds of one project name an element in all inputs; those of other projects do not.
TEST_F(RelationRules, OfSeveralInputs) {
    save("a.ifc", walls_and_doors());
    save("same.ifc", walls_and_doors());
    save("other.ifc", walls_and_doors("another"));
    IfcModel doors;
    doors.add_box("IFCDOOR", "door", {2, -0.1, 0, 3, 0.6, 2});
    doors.add_box("IFCDOOR", "unknown", {5, -0.1, 0, 6, 0.6, 2});
    save("doors.ifc", doors);
    const std::pair<std::string, std::string> own = {"door", "wall"}, moved = {"moved", "other"};
    for (const std::string inputs : {"a.ifc --against same.ifc", "a.ifc same.ifc", "a.ifc --against doors.ifc",
                                     "doors.ifc --against a.ifc", "doors.ifc a.ifc"}) {
        EXPECT_TRUE(pairs(inputs).contains(own)) << inputs;
        EXPECT_FALSE(pairs(inputs + " --exclude fills").contains(own)) << inputs;
    }
    EXPECT_TRUE(pairs("a.ifc --against same.ifc --exclude fills").contains(moved));
    EXPECT_TRUE(pairs("a.ifc --against doors.ifc --exclude fills").contains({"unknown", "wall"}));
    EXPECT_TRUE(pairs("a.ifc --against other.ifc --exclude fills").contains(own));
    EXPECT_TRUE(pairs("a.ifc other.ifc --exclude fills").contains(own)) << "the door of one and the wall of the other";
}

TEST_F(RelationRules, ARelationThatNoInputHasIsAWarning) {
    save("a.ifc", walls_and_doors());
    write_file(file("c.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    write_file(file("r.json"), R"({"exclude": [{"relation": "fills"}, {"relation": "assembly"}]})");
    EXPECT_TRUE(has_text(run("detect a.ifc --exclude fills,system -o p.csv --stats s.json").err,
                         "\nwarning     --exclude: no element of the inputs is in a system (IfcSystem, "
                         "IfcRelAssignsToGroup); the rule 'system' leaves out nothing\n"));
    EXPECT_EQ(json::parse(content("s.json"))["warnings"].size(), 1u);
    EXPECT_TRUE(has_text(run("detect a.ifc --exclude r.json -o p.csv").err,
                         "\nwarning     r.json: exclude[1]: no element of the inputs is part of another "
                         "(IfcRelAggregates); the rule 'assembly' leaves out nothing\n"));
    EXPECT_TRUE(has_text(run("detect c.obj --exclude fills -o p.csv").err, "the rule 'fills' leaves out nothing\n"));
}

#endif

}  // namespace
}  // namespace octopair::test
