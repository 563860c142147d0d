// Tests building models: elements that are lost, rules by relations, units and places of several models.
#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <utility>

#include "cli/program.hpp"
#include "io/ifc_model.hpp"
#include "io/three_mf_reading.hpp"

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
                                ifc_id("block") +
                                " ('block'). Install octopair-ifc, or export the model as glTF or OBJ\n";
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

TEST_F(RelationRules, UnknownRelationsAreNamed) {
    save("a.ifc", walls_and_doors());
    const std::string relations = "; relations: fills, assembly, system";
    for (const auto& [value, word] :
         {std::pair("fills,foo", "foo"), {"foo,fills", "foo"}, {"fills,", ""}, {"fillz", "fillz"}}) {
        const Outcome outcome = run(std::string("detect a.ifc --exclude ") + value + " -o p.csv");
        EXPECT_EQ(outcome.status, 2) << value;
        EXPECT_TRUE(has_text(outcome.err, std::string("--exclude: '") + word +
                                              "' is no relation, and there is no file '" + value + '\'' + relations))
            << outcome.err;
    }
    EXPECT_TRUE(has_text(run("detect a.ifc --exclude none.json").err, "none.json: cannot open"));
    write_file(file("fills,foo"), R"({"exclude": [{"relation": "fills"}]})");
    EXPECT_EQ(pairs("a.ifc --exclude fills,foo"), pairs("a.ifc --exclude fills")) << "a file of this name";
}

/// A box in whole millimetres, from one corner to the other.
using MillimetreBox = std::array<int, 6>;

/// Returns a 3MF file with boxes. Its numbers are in its unit, "millimeter" or "meter".
std::string three_mf_of(const std::string& unit, const std::vector<MillimetreBox>& boxes) {
    std::string resources, items;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        std::string mesh = "<mesh><vertices>";
        for (std::size_t corner = 0; corner < 8; ++corner) {
            mesh += "<vertex";
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const int place = boxes[i][axis + (corner >> axis & 1) * 3];
                const std::string text = unit == "meter" ? fmt::format("{}e-3", place) : fmt::format("{}", place);
                mesh += fmt::format(" {}=\"{}\"", "xyz"[axis], text);
            }
            mesh += "/>";
        }
        mesh += "</vertices><triangles>";
        for (const char* const corners :
             {"021", "123", "456", "576", "014", "154", "236", "376", "042", "246", "135", "375"})
            mesh += fmt::format("<triangle v1=\"{}\" v2=\"{}\" v3=\"{}\"/>", corners[0], corners[1], corners[2]);
        resources += fmt::format("<object id=\"{}\" name=\"box {}\" type=\"model\">{}</triangles></mesh></object>",
                                 i + 1, i, mesh);
        items += fmt::format("<item objectid=\"{}\"/>", i + 1);
    }
    return package_of(model_text(resources, items, "unit=\"" + unit + "\""));
}

/// Boxes in a row that touch, overlap, or have gaps, by whole millimetres. Most places are no float64 in metres.
std::vector<MillimetreBox> row_of_boxes(int first) {
    std::vector<MillimetreBox> boxes;
    for (int i = 0, place = first; i < 60; ++i) {
        const int width = 37 + i * 53 % 71;
        boxes.push_back({place, 3, -7, place + width, 203, 2507});
        place += width + (i % 3 - 1);
    }
    return boxes;
}

class Units : public Federated {
protected:
    void SetUp() override {
        write_file(file("fixed.3mf"), three_mf_of("meter", row_of_boxes(1009)));
        write_file(file("fixed_mm.3mf"), three_mf_of("millimeter", row_of_boxes(1009)));
        write_file(file("m.3mf"), three_mf_of("meter", row_of_boxes(1013)));
        write_file(file("mm.3mf"), three_mf_of("millimeter", row_of_boxes(1013)));
    }
    /// Returns the rows of a result, without the names of the input files.
    std::string rows(const std::string& arguments) const {
        const Outcome outcome = run("detect " + arguments + " -o r.jsonl");
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        std::string rows;
        std::istringstream lines(content("r.jsonl"));
        for (std::string line; std::getline(lines, line);) {
            auto row = nlohmann::ordered_json::parse(line);
            row.erase("a_file");
            row.erase("b_file");
            rows += row.dump() + '\n';
        }
        return rows;
    }
};

TEST_F(Units, OneModelInTwoUnitsGivesTheSameRows) {
    for (const std::string options :
         {"", "--stage features", "--stage pairs", "--objects triangle --stage features",
          "--objects triangle --stage pairs", "--margin 0.001 --engine processes --workers 2"}) {
        const std::string together = rows("fixed.3mf m.3mf " + options),
                          join = rows("fixed.3mf --against m.3mf " + options);
        EXPECT_GT(join.size(), 1000u);
        EXPECT_EQ(rows("fixed.3mf mm.3mf " + options), together) << options;
        EXPECT_EQ(rows("fixed.3mf --against mm.3mf " + options), join) << options;
    }
    EXPECT_EQ(rows("mm.3mf fixed.3mf"), rows("mm.3mf fixed_mm.3mf"));
    EXPECT_EQ(rows("mm.3mf fixed.3mf --stage features"), rows("mm.3mf fixed_mm.3mf --stage features"));
}

TEST_F(Units, TheResultHasTheUnitOfTheFirstInputThatHasOne) {
    write_file(file("plain.obj"), "v 1 0 0\nv 2 0 0\nv 1 1 0\nf 1 2 3\n");
    Outcome outcome = run("detect fixed.3mf mm.3mf -o p.csv --stats s.json");
    EXPECT_TRUE(has_text(outcome.err, "\nunit        m; converted: mm.3mf from mm\n"));
    json stats = json::parse(content("s.json"));
    EXPECT_EQ(stats["unit"], "m");
    EXPECT_EQ(stats["converted"], json::parse(R"([{"file": "mm.3mf", "from": "mm"}])"));
    EXPECT_TRUE(has_text(run("detect mm.3mf m.3mf fixed.3mf -o p.csv").err,
                         "\nunit        mm; converted: m.3mf from m, fixed.3mf from m\n"));
    outcome = run("detect plain.obj --against mm.3mf -o p.csv --stats s.json");
    EXPECT_TRUE(has_text(outcome.err, "\nunit        mm\n"));
    EXPECT_FALSE(json::parse(content("s.json")).contains("converted"));
    EXPECT_FALSE(has_text(run("detect plain.obj -o p.csv").err, "unit"));
    EXPECT_TRUE(has_text(run("detect m.3mf -o p.csv").err, "\nunit        m\n"));
}

TEST_F(Units, AnInputWithoutAUnitIsAWarning) {
    const std::string triangle = "v 1 0 0\nv 2 0 0\nv 1 1 0\nf 1 2 3\n";
    write_file(file("plain.obj"), triangle);
    write_file(file("other.obj"), triangle);
    EXPECT_TRUE(has_text(run("detect plain.obj m.3mf -o p.csv").err,
                         "\nwarning     plain.obj: no unit is stated; coordinates count as m, the unit of m.3mf\n"));
    EXPECT_TRUE(
        has_text(run("detect m.3mf plain.obj --against other.obj -o p.csv").err,
                 "\nwarning     plain.obj and 1 more: no unit is stated; coordinates count as m, the unit of m.3mf\n"));
    for (const std::string inputs : {"plain.obj other.obj", "m.3mf mm.3mf", "m.3mf"})
        EXPECT_FALSE(has_text(run("detect " + inputs + " -o p.csv").err, "no unit")) << inputs;
}

TEST_F(Units, IfcMeetsOtherFormats) {
    IfcModel model(".MILLI.");
    model.add_box("IFCWALL", "wall", {1000, 0, 0, 3000, 200, 2500});
    save("wall.ifc", model);
    write_file(file("pipe.3mf"),
               three_mf_of("millimeter", {{1900, -500, 900, 2000, 700, 1000}, {3001, 0, 0, 3100, 100, 100}}));
    for (const std::string inputs : {"wall.ifc pipe.3mf", "wall.ifc --against pipe.3mf"})
        EXPECT_EQ(run("detect " + inputs + " --count-only --quiet").out, "1\n") << inputs;
    EXPECT_EQ(run("detect pipe.3mf wall.ifc --count-only --quiet").out, "1\n");
    EXPECT_EQ(run("detect pipe.3mf wall.ifc --margin 1.1 --count-only --quiet").out, "2\n") << "in millimetres";
    EXPECT_EQ(run("detect wall.ifc pipe.3mf --margin 0.0011 --count-only --quiet").out, "2\n") << "in metres";
}

TEST_F(Units, InputsThatDoNotMeetAreAWarning) {
    write_file(file("far.3mf"), three_mf_of("meter", {{85000000, 446000000, 0, 85001000, 446001000, 1000}}));
    write_file(file("near.3mf"), three_mf_of("meter", {{100000, 3, 0, 101000, 1000, 1000}}));
    write_file(file("at.3mf"), three_mf_of("meter", {{1000, 100, 0, 2000, 1000, 1000}}));
    const std::string near =
        "\nwarning     at.3mf and near.3mf do not meet: they are 98 m apart. The box of the first begins at 1 0.1 0, "
        "that of "
        "the second at 100 0.003 0; check that both are exported with the same origin and the same unit\n";
    EXPECT_TRUE(has_text(run("detect at.3mf near.3mf -o p.csv").err, near));
    EXPECT_TRUE(has_text(run("detect at.3mf --against near.3mf -o p.csv").err, near));
    EXPECT_FALSE(has_text(run("detect at.3mf near.3mf --margin 98 -o p.csv").err, "do not meet"));
    EXPECT_TRUE(
        has_text(run("detect at.3mf near.3mf far.3mf m.3mf -o p.csv").err, "same unit. 2 inputs meet no other\n"));
    EXPECT_TRUE(
        has_text(run("detect at.3mf m.3mf --against near.3mf -o p.csv").err, "at.3mf and near.3mf do not meet"));
    EXPECT_FALSE(has_text(run("detect at.3mf near.3mf --against near.3mf -o p.csv").err, "near.3mf and near.3mf"));
    EXPECT_FALSE(has_text(run("detect at.3mf m.3mf -o p.csv").err, "do not meet"));
    save_boxes("a.npy", {0});
    save_boxes("b.npy", {5});
    EXPECT_FALSE(has_text(run("detect a.npy --against b.npy -o p.csv").err, "do not meet")) << "files of boxes";
}

#endif

}  // namespace
}  // namespace octopair::test
