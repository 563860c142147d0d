// Tests result files of collisions and their comparison with older result files.
#include "io/results/collision_writer.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "io/files/atomic_file.hpp"
#include "io/results/baseline.hpp"
#include "io/results/result_file.hpp"
#include "io/temporary.hpp"

namespace octopair::test {
namespace {

using io::CollisionForm;

const std::vector<std::string> object_names = {"left, \"l\"", "", "r\xFFight"};
const std::vector<Pair> pairs = {{0, 1}, {0, 2}, {1, 2}};

std::vector<Finding> findings() {
    std::vector<Finding> findings(3);
    findings[0].collision_class = CollisionClass::clearance;
    findings[0].distance = 0.1;
    findings[0].nearest = {{{1, 2, 3}, {1, 2, 3.1}}};
    findings[1].collision_class = CollisionClass::penetrating;
    findings[1].depth = 1.0 / 3;
    findings[1].depth_kind = DepthKind::at_least;
    findings[1].depth_at_most = 0.5;
    findings[1].thickness = 0.125;
    findings[1].thickness_kind = ThicknessKind::at_least;
    findings[1].open = {false, true};
    findings[1].time = 0.5;
    findings[1].contacts = {{{0, 1e300, -0.0}, {0, 0, 1}, 1.0 / 3, 7, Contact::no_feature}};
    findings[1].more_contacts = true;
    findings[2].collision_class = CollisionClass::touching;
    findings[2].depth_kind = DepthKind::least;
    return findings;
}

/// Returns the content of a file with this ending after all rows, including the gone rows.
std::string written(const std::string& ending, const CollisionForm& form, const io::CollisionRows& rows,
                    const std::vector<std::string_view>& gone = {}) {
    const TemporaryDirectory directory;
    const std::string path = directory.file("c" + ending);
    const auto writer = io::make_collision_file_writer(path, form);
    writer->write(rows);
    writer->write_gone(gone);
    EXPECT_TRUE(directory.names().empty() || directory.names()[0].starts_with(".octopair"));
    writer->finish();
    return read_file(path);
}

TEST(CollisionWriter, JsonlSaysWhatIsKnown) {
    const auto found = findings();
    EXPECT_EQ(
        written(".jsonl", {{{object_names}, {object_names}}, true, true}, {pairs, found}),
        R"({"a":0,"b":1,"a_name":"left, \"l\"","class":"clearance","time":0,"distance":0.1,)"
        R"("nearest":[[1,2,3],[1,2,3.1]]}
{"a":0,"b":2,"a_name":"left, \"l\"","b_name":"r)"
        "\xEF\xBF\xBD"
        R"(ight","class":"penetrating","time":0.5,"depth":0.3333333333333333,"depth_kind":"at_least","depth_at_most":0.5,)"
        R"("thickness":0.125,"thickness_kind":"at_least",)"
        R"("contacts":[{"point":[0,1e+300,-0],"normal":[0,0,1],"depth":0.3333333333333333,"a_feature":7}],)"
        R"("more_contacts":true,"b_open":true}
{"a":1,"b":2,"b_name":"r)"
        "\xEF\xBF\xBD"
        R"(ight","class":"touching","time":0,"depth":0,"depth_kind":"least","contacts":[]}
)");
    EXPECT_EQ(written(".jsonl", {}, {pairs, {}}), "{\"a\":0,\"b\":1}\n{\"a\":0,\"b\":2}\n{\"a\":1,\"b\":2}\n");
}

TEST(CollisionWriter, CsvLeavesEmptyWhatIsNotKnown) {
    const auto found = findings();
    const std::string header =
        "a,b,a_name,b_name,class,distance,depth,time,contacts,points,more_contacts,depth_kind,open,thickness,thickness_"
        "kind";
    EXPECT_EQ(written(".csv", {{{object_names}, {object_names}}, true, true}, {pairs, found}),
              header +
                  "\n0,1,\"left, \"\"l\"\"\",,clearance,0.1,,0,,1 2 3;1 2 3.1,,,,,\n"
                  "0,2,\"left, \"\"l\"\"\",r\xEF\xBF\xBDight,penetrating,,0.3333333333333333,0.5,1,0 1e+300 "
                  "-0,true,at_least,b,0.125,at_least\n"
                  "1,2,,r\xEF\xBF\xBDight,touching,,0,0,0,,,least,,,\n");
    EXPECT_EQ(written(".csv", {}, {std::span(pairs).first(1), {}}), header + "\n0,1,,,,,,,,,,,,,\n");
}

TEST(CollisionWriter, TrianglesAreNamedByTheirOwner) {
    const std::vector<std::string> owners_names = {"box", "lid"};
    const std::vector<std::uint32_t> owners = {0, 0, 1};
    const std::vector<Pair> pair = {{1, 2}};
    const io::ObjectNames triangles{owners_names, owners};
    EXPECT_EQ(written(".jsonl", {{triangles, triangles}}, {pair, {}}),
              R"({"a":1,"b":2,"a_name":"box","a_triangle":1,"b_name":"lid","b_triangle":0})"
              "\n");
}

TEST(CollisionWriter, DetailsThatAnObjectHasAreColumns) {
    io::ObjectDetails details;
    io::DetailsBuilder builder(details);
    builder.add({"", "wall, thick", "1", "", "", ""});
    builder.add({"", "", "", "", "", "stone"});
    const std::vector<std::string> named = {"x", "y"};
    const io::ObjectNames names{named, {}, &details};
    const std::vector<Pair> pair = {{0, 1}};
    EXPECT_EQ(written(".jsonl", {{names, names}}, {pair, {}}),
              R"({"a":0,"b":1,"a_name":"x","a_type":"wall, thick","a_id":"1","b_name":"y","b_material":"stone"})"
              "\n");
    EXPECT_EQ(
        written(".csv", {{names, names}, false, false, true}, {pair, {}}, {R"({"a":0,"b":1,"a_type":"t","b_id":"7"})"}),
        "a,b,a_name,b_name,class,distance,depth,time,contacts,points,more_contacts,depth_kind,open,thickness,thickness_"
        "kind,a_type,b_type,"
        "a_id,b_id,a_material,b_material,change\n"
        "0,1,x,y,,,,,,,,,,,,\"wall, thick\",,1,,,stone,\n"
        "0,1,,,,,,,,,,,,,,t,,,7,,,gone\n");
}

TEST(CollisionWriter, NpyHoldsPairsAlone) {
    EXPECT_EQ(error_of(ErrorCode::usage, [] { (void)io::make_collision_file_writer("c.npy", {}); }),
              "c.npy: .npy can hold only pairs; write collisions to .csv or .jsonl");
}

TEST(CollisionWriter, OldRowsThatAreGone) {
    const std::vector<io::Change> changes = {io::Change::begun};
    const std::vector<Pair> pair = {{0, 1}};
    const std::string_view old =
        R"({"a":4,"b":5,"a_name":"x,y","class":"penetrating","depth":0.1,"contacts":[{"point":[1,2.5,3]},{"point":[4,5,6]}],"more_contacts":true,"b_open":true})";
    const CollisionForm form{.changes = true};
    EXPECT_EQ(written(".jsonl", form, {pair, {}, changes}, {old}), R"({"a":0,"b":1,"change":"new"})"
                                                                   "\n" +
                                                                       std::string(old.substr(0, old.size() - 1)) +
                                                                       ",\"change\":\"gone\"}\n");
    EXPECT_EQ(written(".csv", form, {pair, {}, changes}, {old}),
              "a,b,a_name,b_name,class,distance,depth,time,contacts,points,more_contacts,depth_kind,open,thickness,"
              "thickness_kind,change\n0,1,,,"
              ",,,,,,,,,,,new\n"
              "4,5,\"x,y\",,penetrating,,0.1,,2,1 2.5 3;4 5 6,true,,b,,,gone\n");
}

class BaselineTest : public ::testing::Test {
protected:
    static std::string words(io::Baseline& baseline, const std::vector<Pair>& news, const io::CollisionNames& all,
                             const std::vector<Finding>& findings = {}) {
        std::string text;
        for (const io::Change change : baseline.compare(news, findings, all))
            text += std::string(io::word_of(change)) + ' ';
        return text + std::to_string(baseline.gone().size()) + " gone";
    }
    static io::Baseline read(const std::string& text, bool join = false) {
        return io::Baseline::of_text(text, "old.jsonl", join);
    }
};

/// What a writer writes, a reader reads again. Only .jsonl has the depths, normals and features of contacts, and depth_at_most.
TEST(CollisionColumns, ComeBack) {
    const std::vector<std::string> names = {"a \"quoted\", name", "", "c"};
    const CollisionForm form{{{names}, {names}}, true, true};
    const std::vector<Finding> all = findings();
    const TemporaryDirectory directory;
    for (const std::string& path : {directory.file("rows.jsonl"), directory.file("rows.csv")}) {
        SCOPED_TRACE(path);
        const auto writer = io::make_collision_file_writer(path, form);
        writer->write({pairs, all});
        writer->finish();
        const io::ResultFile file = io::read_result(path, {});
        const io::ResultFrame frame = file.frames.frame(0);
        EXPECT_EQ(frame.pairs, pairs);
        EXPECT_EQ(file.names, (std::map<std::uint32_t, std::string>{{0, names[0]}, {2, names[2]}}));
        ASSERT_EQ(frame.findings.size(), all.size());
        for (std::size_t i = 0; i < all.size(); ++i) {
            const Finding &read = frame.findings[i], &wanted = all[i];
            EXPECT_EQ(read.collision_class, wanted.collision_class);
            EXPECT_EQ(read.distance, wanted.distance);
            EXPECT_EQ(read.nearest, wanted.nearest);
            EXPECT_EQ(read.depth, wanted.depth);
            EXPECT_EQ(read.depth_kind, wanted.depth_kind);
            EXPECT_EQ(read.time, wanted.time);
            EXPECT_EQ(read.open, wanted.open);
            EXPECT_EQ(read.more_contacts, wanted.more_contacts);
            ASSERT_EQ(read.contacts.size(), wanted.contacts.size());
            for (std::size_t c = 0; c < read.contacts.size(); ++c) {
                EXPECT_EQ(read.contacts[c].point, wanted.contacts[c].point);
                if (path.ends_with(".csv")) continue;
                EXPECT_EQ(read.contacts[c].normal, wanted.contacts[c].normal);
                EXPECT_EQ(read.contacts[c].depth, wanted.contacts[c].depth);
                EXPECT_EQ(read.contacts[c].feature_a, wanted.contacts[c].feature_a);
                EXPECT_EQ(read.contacts[c].feature_b, wanted.contacts[c].feature_b);
            }
            if (!path.ends_with(".csv")) {
                EXPECT_EQ(read.depth_at_most, wanted.depth_at_most);
            }
        }
    }
}

/// A value that no result has would be lost without a word in the table and in the report.
TEST_F(BaselineTest, ValuesOfAnotherTypeAreRefused) {
    const auto message = [](const std::string& value) {
        return error_of(ErrorCode::bad_input, [&] { (void)read("\n{\"a\":0,\"b\":1," + value + "}\n"); });
    };
    EXPECT_EQ(message(R"("b_id":7)"), "old.jsonl: line 2: b_id: a number, not a string");
    EXPECT_EQ(message(R"("class":"deep")"),
              "old.jsonl: line 2: class: 'deep' is none of unknown, clearance, collision, "
              "touching, penetrating, contained, duplicate, undecided");
    EXPECT_EQ(message(R"("change":"begun")"), "old.jsonl: line 2: change: 'begun' is none of new, same, gone");
    EXPECT_EQ(message(R"("depth_kind":1)"), "old.jsonl: line 2: depth_kind: a number, not a string");
    EXPECT_EQ(message(R"("depth":"0.1")"), "old.jsonl: line 2: depth: a string, not a number");
    EXPECT_EQ(message(R"("contacts":[{}])"), "old.jsonl: line 2: contacts: the key 'point' is missing");
    EXPECT_EQ(message(R"("nearest":[[0,0,0]])"), "old.jsonl: line 2: nearest: not two points");
    EXPECT_EQ(message(R"("more_contacts":1)"), "old.jsonl: line 2: more_contacts: a number, not true or false");
    io::Baseline baseline = read(R"({"a":0,"b":1,"depth":null,"unknown":{}})");
    EXPECT_EQ(words(baseline, {{0, 1}}, {}), "same 0 gone");
}

TEST_F(BaselineTest, NamesAreKnownInAnyOrderAndNumber) {
    const std::vector<std::string> objects = {"bolt", "nut", "plate"};
    io::Baseline baseline = read(R"({"a":7,"b":9,"a_name":"nut","b_name":"bolt"}
{"a":1,"b":2,"a_name":"nut","b_name":"rod","class":"touching"}

{"a":1,"b":3,"a_name":"rod","b_name":"bolt","change":"gone"}
)");
    EXPECT_EQ(words(baseline, {{0, 1}, {0, 2}}, {{objects}, {objects}}), "same new 1 gone");
    EXPECT_EQ(baseline.gone()[0], R"({"a":1,"b":2,"a_name":"nut","b_name":"rod","class":"touching"})");
    EXPECT_EQ(baseline.counts().begun, 1u);
    EXPECT_EQ(baseline.counts().same, 1u);
    EXPECT_EQ(baseline.counts().gone, 1u);
}

TEST_F(BaselineTest, TheSameNamesAreCounted) {
    const std::vector<std::string> objects = {"bolt", "bolt", "bolt", "plate"};
    io::Baseline baseline = read(R"({"a":0,"b":3,"a_name":"bolt","b_name":"plate"}
{"a":1,"b":3,"a_name":"bolt","b_name":"plate"})");
    EXPECT_EQ(words(baseline, {{0, 3}, {1, 3}, {2, 3}}, {{objects}, {objects}}), "same same new 0 gone");
}

TEST_F(BaselineTest, WhatWasNearAndMeetsIsNew) {
    const std::string old = R"({"a":0,"b":1,"class":"clearance","distance":1}
{"a":0,"b":2,"class":"touching"}
{"a":0,"b":3,"class":"collision"}
{"a":0,"b":4}
{"a":0,"b":5})";
    const std::vector<Pair> news = {{0, 1}, {0, 2}, {0, 3}, {0, 4}, {0, 5}};
    const std::vector<Finding> findings = {{.collision_class = CollisionClass::penetrating},
                                           {.collision_class = CollisionClass::clearance},
                                           {.collision_class = CollisionClass::contained},
                                           {.collision_class = CollisionClass::clearance},
                                           {.collision_class = CollisionClass::touching}};
    io::Baseline baseline = read(old);
    EXPECT_EQ(words(baseline, news, {}, findings), "new new same same same 2 gone");
    EXPECT_EQ(baseline.gone()[0], old.substr(0, old.find('\n')));
    // Without classes in the new result, pairs of the baseline count as the same whatever their class was.
    io::Baseline unasked = read(old);
    EXPECT_EQ(words(unasked, news, {}), "same same same same same 0 gone");
}

TEST_F(BaselineTest, ObjectsWithoutNamesAreKnownByNumber) {
    io::Baseline one_set = read(R"({"a":3,"b":5})");
    EXPECT_EQ(words(one_set, {{3, 5}, {3, 6}}, {}), "same new 0 gone");
    io::Baseline join = read(R"({"a":3,"b":5})", true);
    EXPECT_EQ(words(join, {{5, 3}}, {}), "new 1 gone");
    // The name '#5' is a name, not the number of an object.
    const std::vector<std::string> objects = {"", "", "", "#5"};
    io::Baseline named = read(R"({"a":3,"b":5,"a_name":"#5"})");
    EXPECT_EQ(words(named, {{3, 5}}, {{objects}, {objects}}), "same 0 gone");
    io::Baseline nameless = read(R"({"a":3,"b":5})");
    EXPECT_EQ(words(nameless, {{3, 5}}, {{objects}, {objects}}), "new 1 gone");
}

TEST_F(BaselineTest, TrianglesAreKnownWithinTheirOwner) {
    const std::vector<std::string> owner_names = {"box", "lid"};
    const std::vector<std::uint32_t> owners = {0, 0, 1};
    const io::ObjectNames triangles{owner_names, owners};
    io::Baseline baseline = read(R"({"a":11,"b":12,"a_name":"lid","a_triangle":0,"b_name":"box","b_triangle":1})");
    EXPECT_EQ(words(baseline, {{0, 2}, {1, 2}}, {triangles, triangles}), "new same 0 gone");
}

TEST_F(BaselineTest, WhatIsWrittenIsReadAgain) {
    const auto found = findings();
    const CollisionForm form{{{object_names}, {object_names}}, true};
    io::Baseline baseline = read(written(".jsonl", form, {pairs, found}));
    EXPECT_EQ(words(baseline, pairs, form.names), "same same same 0 gone");
}

TEST_F(BaselineTest, RefusesOtherFiles) {
    const std::pair<std::string, std::string> cases[] = {
        {"{\"a\":0,\"b\":1}\n{\"a\":0}", "old.jsonl: line 2: the key 'b' is missing"},
        {"[]", "old.jsonl: line 1: an array, not an object"},
        {"{\"a\":0,\"b\":-1}", "old.jsonl: line 1: b: -1 is not a whole number from 0 to 4294967295"},
        {"{\"frame\":0,\"a\":0,\"b\":1}", "old.jsonl: line 1: frame: results of moving scenes cannot be compared"},
    };
    for (const auto& [text, words] : cases) {
        EXPECT_EQ(error_of(ErrorCode::bad_input, [&, &old = text] { (void)read(old); }), words);
    }
    EXPECT_TRUE(error_of(ErrorCode::bad_input, [] { (void)read("a,b\n0,1\n"); }).starts_with("old.jsonl: line 1: "));
}

}  // namespace
}  // namespace octopair::test
