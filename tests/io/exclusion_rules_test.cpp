// Tests the reader of exclusion rules in .json files.
#include "io/json/exclusion_rules.hpp"

#include <gtest/gtest.h>

#include "io/temporary.hpp"

namespace octopair::test {
namespace {

std::string rules_refusal(const std::string& text) {
    return error_of(ErrorCode::bad_input, [&] { (void)io::parse_exclusion_rules(text, "r.json"); });
}

TEST(ExclusionRules, AreRead) {
    const auto rules = io::parse_exclusion_rules(
        R"({"exclude": [{"a": "*/bolt*", "b": "*/nut?"}, {"b": "", "a": "*"}],
            "ignored_pairs": [["door", "hinge \u00e4"]], "same_parent": true})",
        "r.json");
    ASSERT_EQ(rules.exclude.size(), 2u);
    EXPECT_EQ(rules.exclude[0].a, ColumnPatterns{"*/bolt*"});
    EXPECT_EQ(rules.exclude[0].b, ColumnPatterns{"*/nut?"});
    EXPECT_EQ(rules.exclude[1].a, ColumnPatterns{"*"});
    EXPECT_EQ(rules.exclude[1].b, ColumnPatterns{""});
    ASSERT_EQ(rules.ignored_pairs.size(), 1u);
    EXPECT_EQ(rules.ignored_pairs[0][0], "door");
    EXPECT_EQ(rules.ignored_pairs[0][1], "hinge \xc3\xa4");
    EXPECT_TRUE(rules.same_parent);
}

TEST(ExclusionRules, MayBeAboutDetails) {
    const auto rules = io::parse_exclusion_rules(
        R"({"exclude": [{"a": {"type": "IfcBeam", "name": "x*"}, "b": {"material": "steel"}}]})", "r.json");
    ASSERT_EQ(rules.exclude.size(), 1u);
    ColumnPatterns a(7), b(7);
    a[0] = "x*";
    a[io::column_of(io::Detail::type)] = "IfcBeam";
    b[io::column_of(io::Detail::material)] = "steel";
    EXPECT_EQ(rules.exclude[0].a, a);
    EXPECT_EQ(rules.exclude[0].b, b);
}

TEST(ExclusionRules, MayBeAboutRelations) {
    const auto rules = io::parse_exclusion_rules(
        R"({"exclude": [{"relation": "fills"}, {"a": "x", "b": "y"}, {"relation": "system"}]})", "r.json");
    EXPECT_EQ(rules.exclude.size(), 1u);
    ASSERT_EQ(rules.relations.size(), 2u);
    EXPECT_EQ(rules.relations[0].relation, io::Relation::fills);
    EXPECT_EQ(rules.relations[1].relation, io::Relation::system);
    EXPECT_EQ(rules.relations[1].place, "r.json: exclude[2]");
    EXPECT_EQ(rules_refusal(R"({"exclude": [{"relation": "near"}]})"),
              "r.json: exclude[0]: relation: unknown relation 'near'; known relations: fills, assembly, system");
    EXPECT_EQ(rules_refusal(R"({"exclude": [{"relation": 1}]})"),
              "r.json: exclude[0]: relation: a number, not a string");
    EXPECT_EQ(rules_refusal(R"({"exclude": [{"relation": "fills", "a": "*"}]})"),
              "r.json: exclude[0]: unknown key 'a'; known keys: relation");
}

TEST(ExclusionRules, MayBeWordsOfRelations) {
    const auto rules = io::relation_rules("assembly,fills");
    ASSERT_TRUE(rules);
    ASSERT_EQ(rules->relations.size(), 2u);
    EXPECT_EQ(rules->relations[0].relation, io::Relation::assembly);
    EXPECT_EQ(rules->relations[1].place, "--exclude");
    for (const char* file : {"", "rules.json", "fills,", ",fills", "fills,rules.json", "Fills"})
        EXPECT_FALSE(io::relation_rules(file)) << file;
}

TEST(ExclusionRules, MayBeLeftOut) {
    const auto rules = io::parse_exclusion_rules("{}", "r.json");
    EXPECT_TRUE(rules.exclude.empty());
    EXPECT_TRUE(rules.ignored_pairs.empty());
    EXPECT_FALSE(rules.same_parent);
    EXPECT_FALSE(io::parse_exclusion_rules(R"({"same_parent": false})", "r.json").same_parent);
}

TEST(ExclusionRules, NameThePlace) {
    EXPECT_EQ(rules_refusal("[]"), "r.json: an array, not an object");
    EXPECT_EQ(rules_refusal(R"({"excludes": []})"),
              "r.json: unknown key 'excludes'; known keys: exclude, ignored_pairs, same_parent");
    EXPECT_EQ(rules_refusal(R"({"exclude": {}})"), "r.json: exclude: an object, not an array");
    EXPECT_EQ(rules_refusal(R"({"exclude": ["*"]})"), "r.json: exclude[0]: a string, not an object");
    EXPECT_EQ(rules_refusal(R"({"exclude": [{"a": "*", "b": "*"}, {"a": "*"}]})"),
              "r.json: exclude[1]: the key 'b' is missing");
    EXPECT_EQ(rules_refusal(R"({"exclude": [{"a": 1, "b": "*"}]})"),
              "r.json: exclude[0]: a: a number, not a string or an object");
    EXPECT_EQ(rules_refusal(R"({"exclude": [{"a": "*", "b": "*", "c": 1}]})"),
              "r.json: exclude[0]: unknown key 'c'; known keys: a, b, relation");
    EXPECT_EQ(rules_refusal(R"({"exclude": [{"a": {"kind": "x"}, "b": "*"}]})"),
              "r.json: exclude[0]: a: unknown key 'kind'; known keys: name, label, type, id, parent, level, material");
    EXPECT_EQ(rules_refusal(R"({"exclude": [{"a": {}, "b": "*"}]})"),
              "r.json: exclude[0]: a: needs at least one of the keys name, label, type, id, parent, level, material");
    EXPECT_EQ(rules_refusal(R"({"exclude": [{"a": "*", "b": {"type": 1}}]})"),
              "r.json: exclude[0]: b: type: a number, not a string");
    EXPECT_EQ(rules_refusal(R"({"exclude": [{"a": null, "b": "*"}]})"),
              "r.json: exclude[0]: a: null, not a string or an object");
    EXPECT_EQ(rules_refusal(R"({"ignored_pairs": [["a"]]})"),
              "r.json: ignored_pairs[0]: an array of 1, not of two names");
    EXPECT_EQ(rules_refusal(R"({"ignored_pairs": ["a"]})"), "r.json: ignored_pairs[0]: a string, not an array");
    EXPECT_EQ(rules_refusal(R"({"ignored_pairs": [["a", null]]})"), "r.json: ignored_pairs[0][1]: null, not a string");
    EXPECT_EQ(rules_refusal(R"({"same_parent": 1})"), "r.json: same_parent: a number, not true or false");
    EXPECT_EQ(rules_refusal(R"({"same_parent": true, "same_parent": false})"),
              "r.json: the key 'same_parent' occurs twice in one object");
}

TEST(ExclusionRules, MustBeJson) {
    for (const std::string text :
         {"", "{", "{} {}", "{\"exclude\": [}", "{'exclude': []}", "{\"exclude\": [],}", "\xff"}) {
        const std::string words = rules_refusal(text);
        EXPECT_TRUE(words.starts_with("r.json: parse error at line 1")) << words;
        EXPECT_EQ(words.find('\n'), std::string::npos) << words;
    }
}

TEST(ExclusionRules, NumbersAreNotTooLarge) {
    EXPECT_EQ(rules_refusal("{\"same_parent\": 4e442}"), "r.json: same_parent: number overflow parsing '4e442'");
}

TEST(ExclusionRules, AreReadFromFiles) {
    const TemporaryDirectory folder;
    const std::string path = folder.file("r.json");
    write_file(path, R"({"same_parent": true})");
    EXPECT_TRUE(io::read_exclusion_rules(path).same_parent);
    EXPECT_TRUE(error_of(ErrorCode::io_failed, [&] {
                    (void)io::read_exclusion_rules(folder.file("none.json"));
                }).find("none.json") != std::string::npos);
}

}  // namespace
}  // namespace octopair::test
