// Tests `detect --report`: the data of the page are those of the result, and texts of the input stay data.
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/program.hpp"
#include "support/page_data.hpp"

namespace octopair::test {
namespace {

#ifdef OCTOPAIR_WITH_PIPELINE

using nlohmann::json;

const std::string hostile = "</script><script>alert('x')</script><b>";

json ball(const std::string& name, double x, double radius = 1) {
    return {{"name", name}, {"shape", {{"type", "sphere"}, {"radius", radius}}}, {"position", {x, 0, 0}}};
}

class Report : public ProgramTest {
protected:
    void write_scene(const std::string& name, const json& objects) const {
        write_file(file(name), json{{"objects", objects}}.dump());
    }
    /// Runs `detect` with a report, and returns the data of the page.
    std::map<std::string, std::string> report(const std::string& arguments) const {
        const Outcome outcome = run("detect " + arguments + " --report r.html -o r.jsonl --quiet");
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        return data_of(content("r.html"));
    }
    std::vector<json> result() const {
        std::vector<json> rows;
        std::istringstream lines(content("r.jsonl"));
        for (std::string line; std::getline(lines, line);) rows.push_back(json::parse(line));
        return rows;
    }
};

/// Returns the row of a pair.
json row_of(const json& rows, std::uint64_t a, std::uint64_t b) {
    for (const json& row : rows) {
        if (row["a"] == a && row["b"] == b) return row;
    }
    return {};
}

TEST_F(Report, HasTheRowsOfTheResult) {
    write_scene("s.json", {ball("car/wheel", 0), ball("car/" + hostile, 1.5), ball("alone", 50),
                           ball("inner", 50.1, 0.2), ball("", 53)});
    const auto data = report("s.json --stage features --margin 1.5 --unit mm --up y");
    const json view = json::parse(data.at("view.json")), frame = json::parse(data.at("frame/0.json"));
    const json table = json::parse(data.at("collisions/0.json"));
    const std::vector<json> rows = result();
    ASSERT_EQ(rows.size(), 3u);
    EXPECT_EQ(table["total"], 3);
    ASSERT_EQ(table["rows"].size(), 3u);
    for (const json& expected : rows) {
        const json row = row_of(table["rows"], expected["a"], expected["b"]);
        ASSERT_FALSE(row.is_null()) << expected;
        for (const char* key : {"class", "distance", "nearest", "depth", "depth_at_most"}) {
            EXPECT_EQ(row.value(key, json()), expected.value(key, json())) << key;
        }
        EXPECT_EQ(row.contains("contacts"), expected.contains("contacts") && !expected["contacts"].empty());
    }
    EXPECT_EQ(table["rows"][0]["class"], "penetrating") << "the worst collision is first";
    EXPECT_EQ(table["rows"][2]["class"], "clearance");
    EXPECT_EQ(frame["classes"], (json{{"penetrating", 1}, {"contained", 1}, {"clearance", 1}}));
    EXPECT_EQ(view["title"], "s.json");
    EXPECT_EQ(view["unit"], "mm");
    EXPECT_EQ(view["up"], "y");
    EXPECT_EQ(view["margin"], 1.5);
    EXPECT_EQ(view["summary"]["tolerance"], "0");
    EXPECT_EQ(view["has"]["octants"], false);
    EXPECT_EQ(json::parse(data.at("names.json")).size(), 5u);
    EXPECT_TRUE(data.contains("shape/0"));
}

TEST_F(Report, NamesAreTextAndNothingIsFetched) {
    write_scene("s.json", {ball(hostile, 0), ball("r", 1)});
    const auto data = report("s.json");
    const std::string page = content("r.html");
    EXPECT_EQ(page.find("alert('x')"), std::string::npos);
    EXPECT_EQ(json::parse(data.at("names.json"))[0], hostile);
    EXPECT_NE(page.find("default-src 'none'"), std::string::npos) << "the browser refuses what the page does not have";
    EXPECT_TRUE(page.starts_with("<!doctype html>"));
    EXPECT_TRUE(page.ends_with("</html>\n"));
}

TEST_F(Report, ComparesWithAnOlderResult) {
    write_scene("s.json", {ball("a", 0), ball("b", 1.5), ball("c", 3)});
    ASSERT_EQ(run("detect s.json --stage features -o old.jsonl --quiet").status, 0);
    write_scene("s.json", {ball("a", 0), ball("b", 1.5), ball("c", 30), ball("d", -1.5)});
    const auto data = report("s.json --stage features --baseline old.jsonl");
    const json rows = json::parse(data.at("collisions/0.json"))["rows"], gone = json::parse(data.at("gone.json"));
    EXPECT_EQ(row_of(rows, 0, 1)["change"], "same");
    EXPECT_EQ(row_of(rows, 0, 3)["change"], "new");
    ASSERT_EQ(gone.size(), 1u);
    EXPECT_EQ(gone[0]["name_a"], "b");
    EXPECT_EQ(gone[0]["name_b"], "c");
    EXPECT_EQ(gone[0]["class"], "penetrating");
    EXPECT_EQ(gone[0]["depth"], 0.5);
    const json frame = json::parse(data.at("frame/0.json"));
    EXPECT_EQ(frame["new"], 1);
    EXPECT_EQ(frame["same"], 1);
    EXPECT_EQ(frame["gone"], 1);
}

/// The objects of the second set follow those of the first, and the page says from which file each is.
TEST_F(Report, HasTheStatusesOfTheRows) {
    write_scene("s.json", {ball("a", 0), ball("b", 1), ball("c", 2.5)});
    const auto row = [&] {
        const auto data = report("s.json --stage features --statuses t.json");
        const json table = json::parse(data.at("collisions/0.json"));
        EXPECT_EQ(row_of(table["rows"], 1, 2)["status"], "new");
        return row_of(table["rows"], 0, 1);
    };
    EXPECT_EQ(row()["status"], "new");
    EXPECT_FALSE(row().contains("comment"));
    json decided = json::parse(content("t.json"));
    ASSERT_EQ(decided["collisions"][0]["a"], "a");
    decided["collisions"][0]["status"] = "approved";
    decided["collisions"][0]["comment"] = hostile;
    write_file(file("t.json"), decided.dump());
    EXPECT_EQ(row()["status"], "approved");
    EXPECT_EQ(row()["comment"], hostile);
}

TEST_F(Report, OfAJoinHasBothSets) {
    write_scene("s.json", {ball("a", 0), ball("b", 9)});
    write_scene("t.json", {ball("c", 90), ball("d", 1)});
    const auto data = report("s.json --against t.json --stage features --up z");
    const json view = json::parse(data.at("view.json")), rows = json::parse(data.at("collisions/0.json"))["rows"];
    ASSERT_EQ(rows.size(), 1u);
    EXPECT_EQ(rows[0]["a"], 0);
    EXPECT_EQ(rows[0]["b"], 3);
    EXPECT_EQ(view["second_set"], 2);
    EXPECT_EQ(view["files"], json::parse(R"([{"name":"s.json","first":0},{"name":"t.json","first":2}])"));
    EXPECT_EQ(view["title"], "s.json against t.json");
    EXPECT_EQ(view["objects"], 4);
}

/// 204,480 duplicates are equally bad, and two pairs overlap, which is worse. These are among the last rows of the result.
TEST_F(Report, KeepsTheWorstRows) {
    json objects = json::array();
    for (int i = 0; i < 640; ++i) objects.push_back(ball("", 0));
    for (const double x : {100.0, 101.0, 102.5}) objects.push_back(ball("", x));
    write_scene("s.json", objects);
    const auto data = report("s.json --stage features");
    const json table = json::parse(data.at("collisions/0.json")), frame = json::parse(data.at("frame/0.json"));
    EXPECT_EQ(table["total"], 204'482);
    ASSERT_EQ(table["rows"].size(), 200'000u);
    EXPECT_EQ(table["rows"][0]["a"], 640);
    EXPECT_EQ(table["rows"][0]["depth"], 1);
    EXPECT_EQ(table["rows"][1]["a"], 641);
    EXPECT_EQ(table["rows"][2]["class"], "duplicate");
    EXPECT_EQ(frame["classes"], (json{{"duplicate", 204'480}, {"penetrating", 2}}));
    EXPECT_EQ(json::parse(data.at("view.json"))["notices"][0], "The table has the worst 200000 of 204482 rows.");
    write_file(file("none.jsonl"), "");
    const auto compared = report("s.json --stage features --baseline none.jsonl");
    EXPECT_EQ(json::parse(compared.at("frame/0.json"))["new"], 204'482) << "all rows, not only those of the table";
}

#endif

}  // namespace
}  // namespace octopair::test
