// Tests the HTML report: a single page that holds the written data and shows all names as plain text.
#include "io/results/html_report.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "io/files/atomic_file.hpp"
#include "io/temporary.hpp"

namespace octopair::test {
namespace {

using nlohmann::json;

const std::vector<std::string> reported_names = {"car/wheel", "</script><script>alert('x')</script>", "r\xFFight",
                                                 "alone"};
const std::vector<Box3d> reported_boxes = {
    {{0, 0, 0}, {1, 1, 1}}, {{0.5, 0, 0}, {2, 1, 1}}, {{0.1, 0, 0}, {1, 1, 1}}, {{9, 9, 9}, {9, 9, 9}}};
const std::vector<Pair> reported_pairs = {{0, 1}, {1, 2}};

std::vector<Finding> reported_findings() {
    std::vector<Finding> findings(2);
    findings[0].collision_class = CollisionClass::penetrating;
    findings[0].depth = 0.5;
    findings[0].depth_kind = DepthKind::at_least;
    findings[0].depth_at_most = 0.75;
    findings[0].open = {false, true};
    findings[0].contacts = {{{0.75, 0.5, 0.5}, {1, 0, 0}, 0.5}};
    findings[1].collision_class = CollisionClass::clearance;
    findings[1].distance = 0.25;
    return findings;
}

std::size_t count(const std::string& text, std::string_view what) {
    std::size_t found = 0;
    for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++found;
    return found;
}

/// Returns the data in a script element of the page.
json data_of(const std::string& page, const std::string& id) {
    const std::string begin = "<script type=\"application/json\" id=\"" + id + "\">";
    const std::size_t at = page.find(begin) + begin.size();
    return json::parse(page.substr(at, page.find("</script>", at) - at));
}

class HtmlReport : public ::testing::Test {
protected:
    /// Returns the page for the given rows.
    std::string page(const io::ReportScene& scene, const io::CollisionRows& rows,
                     const std::vector<std::string_view>& gone = {}) const {
        io::HtmlReport report(std::make_unique<io::AtomicFile>(directory_.file("r.html")), scene);
        report.write(rows);
        if (!gone.empty()) report.write_gone(gone);
        report.add_fact("time", "3 s");
        report.add_note("n");
        report.finish();
        return read_file(directory_.file("r.html"));
    }

    TemporaryDirectory directory_;
};

TEST_F(HtmlReport, HoldsWhatWasWritten) {
    const auto found = reported_findings();
    io::ReportScene scene{"car.glb", {{{reported_names}, {reported_names}}, true}, std::span(reported_boxes), {}};
    scene.space = {io::UpAxis::y, "m"};
    const std::string text = page(scene, {reported_pairs, found, {}});
    EXPECT_EQ(data_of(text, "rows"), json::parse("[[0,1,4,null,null,0.5,null,1,0,[0.75,0.5,0.5],1,0.75,2],"
                                                 "[1,2,1,null,0.25,null,null,null,0,[0,0,0],0,null,0]]"));
    const json objects = data_of(text, "objects");
    ASSERT_EQ(objects.size(), 1u);
    EXPECT_EQ(objects[0][0], json::parse("[0,\"car/wheel\",0,0,0,1,1,1]"));
    EXPECT_EQ(objects[0][1][1], reported_names[1]);
    EXPECT_EQ(objects[0][2][1], "r\xEF\xBF\xBDight");
    EXPECT_EQ(data_of(text, "others"), json::parse("[[9,9,9,9,9,9]]"));
    EXPECT_EQ(data_of(text, "gone"), json::array());
    EXPECT_EQ(data_of(text, "words"), json::parse(R"([""])"));
    EXPECT_EQ(data_of(text, "summary"),
              json::parse(R"({"title":"car.glb","join":false,"notes":["n"],"unit":"m","up":1,"first":4,
        "facts":[["collisions","2"],["clearance","1"],["penetrating","1"],["time","3 s"]]})"));
    EXPECT_TRUE(text.starts_with("<!DOCTYPE html>"));
    EXPECT_TRUE(text.ends_with("</html>\n"));
}

TEST_F(HtmlReport, NamesAreTextAndNothingIsFetched) {
    const io::ReportScene scene{"<b>car</b>", {{{reported_names}, {reported_names}}}, std::span(reported_boxes), {}};
    const std::string text = page(scene, {reported_pairs, {}, {}});
    EXPECT_EQ(count(text, "<script"), 7u);  // six scripts with data, one with the page's code
    EXPECT_EQ(count(text, "</script"), 7u);
    EXPECT_EQ(count(text, "<b>"), 0u);
    EXPECT_EQ(count(text, "http:") + count(text, "https:") + count(text, "src="), 0u);
    EXPECT_EQ(data_of(text, "summary")["title"], "<b>car</b>");
}

TEST_F(HtmlReport, ChangesAndTheOtherSet) {
    const std::vector<Pair> pair = {{0, 3}};
    const std::vector<io::Change> changes = {io::Change::same};
    const std::vector<Box3f> others = {{{0, 0, 0}, {1, 1, 1}}, {}, {}, {{0, 0, 0}, {0.5f, 1, 1}}};
    const io::ReportScene scene{
        "t", {{{reported_names}, {}}, false, false, true}, std::span(reported_boxes), std::span(others), true};
    const std::string text = page(
        scene, {pair, {}, changes},
        {R"({"a":4,"b":5,"a_name":"<x>","depth":0.5,"depth_kind":"at_least","b_label":"L","contacts":[{"point":[1,2,3]}]})"});
    EXPECT_EQ(data_of(text, "rows"), json::parse("[[0,3,0,1,null,null,null,null,0,null,0,null,0]]"));
    EXPECT_EQ(data_of(text, "gone"), json::parse(R"([["<x>","#5","",null,0.5,null,1,1,"","","L",""]])"));
    const json objects = data_of(text, "objects");
    ASSERT_EQ(objects.size(), 2u);
    EXPECT_EQ(objects[1], json::parse("[[3,\"\",0,0,0,0.5,1,1]]"));
    EXPECT_EQ(data_of(text, "others").size(), 6u);
    EXPECT_EQ(data_of(text, "summary")["facts"],
              json::parse(R"([["collisions","1"],["new","0"],["same","1"],["gone","1"],["time","3 s"]])"));
}

TEST_F(HtmlReport, SaysWhatItLeavesOut) {
    const std::vector<Box3f> many(50'000);
    const std::vector<Pair> rows(io::HtmlReport::max_rows + 1, Pair{0, 1});
    const std::string text = page({"t", {}, std::span(many), {}}, {rows, {}, {}});
    EXPECT_EQ(data_of(text, "rows").size(), io::HtmlReport::max_rows);
    EXPECT_EQ(data_of(text, "others").size(), 16'666u);
    const json summary = data_of(text, "summary");
    EXPECT_EQ(summary["facts"][0][1], "200001");
    EXPECT_EQ(summary["notes"], json::parse(R"(["n", "The table has the worst 200000 of 200001 rows.",
        "The picture shows 16666 of the 49998 objects that are not in the table."])"));
}

TEST_F(HtmlReport, DetailsAreNumbersOfWords) {
    io::ObjectDetails details;
    io::DetailsBuilder builder(details);
    builder.add({"L", "T", "", "", "", ""});
    builder.add({"T", "", "i", "", "", "<m>"});
    const io::ObjectNames names{reported_names, {}, &details};
    const std::string text = page({"t", {{names, names}}, std::span(reported_boxes), {}}, {reported_pairs, {}, {}});
    EXPECT_EQ(data_of(text, "words"), json::parse(R"(["","L","T","i","<m>"])"));
    const json objects = data_of(text, "objects");
    EXPECT_EQ(objects[0][0], json::parse("[0,\"car/wheel\",0,0,0,1,1,1,1,2,0,0,0,0]"));
    EXPECT_EQ(json(objects[0][1].begin() + 8, objects[0][1].end()), json::parse("[2,0,3,0,0,4]"));
    EXPECT_EQ(json(objects[0][2].begin() + 8, objects[0][2].end()), json::parse("[0,0,0,0,0,0]"));
}

/// Rows that are not among the worst are left out, wherever they are in the result.
TEST_F(HtmlReport, KeepsTheWorstRowsInTheirOrder) {
    const std::size_t count = 2 * io::HtmlReport::max_rows + 3;
    std::vector<Pair> all_pairs(count);
    std::vector<Finding> all_findings(count);
    for (std::size_t i = 0; i < count; ++i) {
        all_pairs[i] = {std::uint32_t(i), std::uint32_t(i) + 1};
        all_findings[i].collision_class = CollisionClass::penetrating;
        all_findings[i].depth_kind = DepthKind::least;
        all_findings[i].depth = i % 2 == 0 ? 1.0 : 2.0;
    }
    all_findings[4].collision_class = CollisionClass::duplicate;
    const std::vector<Box3f> many(count + 1);
    const json rows = data_of(page({"t", {{}, true}, std::span(many), {}}, {all_pairs, all_findings, {}}), "rows");
    ASSERT_EQ(rows.size(), io::HtmlReport::max_rows);
    EXPECT_EQ(rows[0][0], 1);
    EXPECT_EQ(rows[1][0], 3);
    EXPECT_EQ(rows[2][0], 4) << "duplicates come before all depths";
    EXPECT_EQ(rows[3][0], 5);
    EXPECT_EQ(rows.back()[0], count - 6) << "of the equal rows, the last two are left out";
}

}  // namespace
}  // namespace octopair::test
