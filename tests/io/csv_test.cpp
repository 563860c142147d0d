// Tests the reader of boxes in .csv files.
#include "io/boxes/csv.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <bit>
#include <clocale>
#include <cmath>

#include "io/temporary.hpp"

namespace octopair::test {
namespace {

Buffer<Box3d> parsed_csv(const std::string& text) { return io::parse_csv_boxes(text, "f.csv"); }

std::string csv_refusal(const std::string& text) {
    return error_of(ErrorCode::bad_input, [&] { (void)parsed_csv(text); });
}

TEST(Csv, ReadsLines) {
    for (const std::string text :
         {"0,1,2,3,4,5.5\n-1,0,0,1e3,+2,.25\n", "0,1,2,3,4,5.5\r\n-1,0,0,1e3,+2,.25",
          "a,b,c,d,e,f\n0,1,2,3,4,5.5\n\n-1,0,0,1e3,2,.25\n",
          "\xef\xbb\xbfmin x,min y,min z,max x,max y,max z\r\n 0 , 1,\t2,3 ,4,5.5\r\n-1,0,0,1e3,2,.25\r\n\r\n"}) {
        const auto boxes = parsed_csv(text);
        ASSERT_EQ(boxes.size(), 2u) << text;
        EXPECT_EQ(boxes[0].max[2], 5.5);
        EXPECT_EQ(boxes[1].min[0], -1.0);
        EXPECT_EQ(boxes[1].max[0], 1000.0);
        EXPECT_EQ(boxes[1].max[1], 2.0);
        EXPECT_EQ(boxes[1].max[2], 0.25);
    }
}

TEST(Csv, ReadsFilesWithoutBoxes) {
    EXPECT_EQ(parsed_csv("").size(), 0u);
    EXPECT_EQ(parsed_csv("\n").size(), 0u);
    EXPECT_EQ(parsed_csv("a,b,c,d,e,f\n").size(), 0u);
}

TEST(Csv, LeavesJudgingToOthers) {
    const auto boxes = parsed_csv("nan,0,0,inf,1,-inf\n");
    ASSERT_EQ(boxes.size(), 1u);
    EXPECT_TRUE(std::isnan(boxes[0].min[0]));
    EXPECT_TRUE(std::isinf(boxes[0].max[0]));
}

TEST(Csv, NamesTheLine) {
    EXPECT_EQ(csv_refusal("0,0,0,1,1,1\n0,0,0,1,1\n"), "f.csv: line 2: 5 fields, not 6 numbers");
    EXPECT_EQ(csv_refusal("0,0,0,1,1,1,\n"), "f.csv: line 1: 7 fields, not 6 numbers");
    EXPECT_EQ(csv_refusal("0,0,0,1,1,1\n0,0,x,1,1,1\n"), "f.csv: line 2: field 3 is not a number: 'x'");
    EXPECT_EQ(csv_refusal("0,0,x,1,1,1\n"), "f.csv: line 1: field 3 is not a number: 'x'");
    EXPECT_EQ(csv_refusal("0,0,,1,1,1\n"), "f.csv: line 1: field 3 is not a number: ''");
    EXPECT_EQ(csv_refusal("\na,b,c,d,e,f\n"), "f.csv: line 2: field 1 is not a number: 'a'");
    EXPECT_EQ(csv_refusal("a,b,c,d,e,f\na,b,c,d,e,f\n"), "f.csv: line 2: field 1 is not a number: 'a'");
    EXPECT_EQ(csv_refusal("0,0,0,1,1,1e999\n"), "f.csv: line 1: field 6 is outside the range of float64: '1e999'");
    EXPECT_EQ(csv_refusal("0,0,0,1,1,0x10\n"), "f.csv: line 1: field 6 is not a number: '0x10'");
    EXPECT_EQ(csv_refusal("0,0,0,1,1,+-1\n"), "f.csv: line 1: field 6 is not a number: '+-1'");
    const std::string hint = "; separate the numbers with commas, and write them with a point";
    EXPECT_EQ(csv_refusal("0;0;0;1;1;1\n"), "f.csv: line 1: 1 fields, not 6 numbers" + hint);
    EXPECT_EQ(csv_refusal("0\t0\t0\t1\t1\t1\n"), "f.csv: line 1: 1 fields, not 6 numbers" + hint);
    EXPECT_EQ(csv_refusal("0,1;0,2;0,3;1,1;1,2;1\n"), "f.csv: line 1: field 2 is not a number: '1;0'" + hint);
    EXPECT_EQ(csv_refusal("0 0 0 1 1 1\n"), "f.csv: line 1: 1 fields, not 6 numbers" + hint);
    EXPECT_EQ(csv_refusal("#comment\n0,0,0,1,1,1\n"), "f.csv: line 1: 1 fields, not 6 numbers");
    EXPECT_EQ(csv_refusal(std::string("0,0,0,1,1,\x01\0x\n", 14)), "f.csv: line 1: field 6 is not a number: '??x'");
}

TEST(Csv, ReadsTheSpellingsOfOtherPrograms) {
    for (const std::string text :
         {"\"0\",\"0\",\"0\",\"1\",\"1\",\"1.5\"\n", "0.0D0,0d0,0,1.0D+0,1,15D-1\n", "0,0,0,1,1,1.5\r",
          "\"min x, m\",b,c,d,e,\"f\"\r0,0,0,1,1,1.5\r", "# a,b,c,d,e,f\n\t\"0\", \" 0 \",0,1,1,1.5"}) {
        const auto boxes = parsed_csv(text);
        ASSERT_EQ(boxes.size(), 1u) << text;
        EXPECT_EQ(boxes[0].max[0], 1) << text;
        EXPECT_EQ(boxes[0].max[2], 1.5) << text;
    }
}

TEST(Csv, ACarriageReturnEndsALine) {
    EXPECT_EQ(parsed_csv("0,0,0,1,1,1\r\n\r\n2,2,2,3,3,3\r").size(), 2u);
    EXPECT_EQ(parsed_csv("0,0,0,1,1,1\r2,2,2,3,3,3\r\r3,3,3,4,4,4").size(), 3u);
    EXPECT_EQ(csv_refusal("0,0,0\r,1,1,1\n"), "f.csv: line 1: 3 fields, not 6 numbers");
    EXPECT_EQ(csv_refusal("0,0,0,1,1,1\r0,0,x,1,1,1\r"), "f.csv: line 2: field 3 is not a number: 'x'");
}

TEST(Csv, TakesNoNumbersForAHeader) {
    EXPECT_EQ(csv_refusal("0x0,0x0,0x0,0x1,0x1,0x1\n"), "f.csv: line 1: field 1 is not a number: '0x0'");
    EXPECT_EQ(csv_refusal("'0','0','0','1','1','1'\n"), "f.csv: line 1: field 1 is not a number: ''0''");
    EXPECT_EQ(csv_refusal("$0,$0,$0,$1,$1,$1\n"), "f.csv: line 1: field 1 is not a number: '$0'");
    EXPECT_EQ(csv_refusal("1.#INF,b,c,d,e,f\n"), "f.csv: line 1: field 1 is not a number: '1.#INF'");
    EXPECT_EQ(csv_refusal("a,b,c,d,e,0 m\n"), "f.csv: line 1: field 1 is not a number: 'a'");
    EXPECT_EQ(csv_refusal(",,,,,\n"), "f.csv: line 1: field 1 is not a number: ''");
    EXPECT_EQ(csv_refusal("\"0,0,0,1,1,1\"\n"), "f.csv: line 1: 1 fields, not 6 numbers");
    EXPECT_EQ(parsed_csv("inf,nan,-inf,INF,NaN,Infinity\n").size(), 1u);
}

TEST(Csv, IgnoresTheLocale) {
    const char* set = std::setlocale(LC_ALL, "de_DE.UTF-8");
    EXPECT_EQ(parsed_csv("0.5,0,0,1.5,1,1\n")[0].min[0], 0.5) << (set != nullptr ? set : "no such locale here");
    std::setlocale(LC_ALL, "C");
}

RC_GTEST_PROP(Csv, RoundTripsEveryFiniteNumber, ()) {
    const auto bits = *rc::gen::container<std::vector<std::uint64_t>>(6 * 20, rc::gen::arbitrary<std::uint64_t>());
    std::string text;
    std::vector<double> values;
    for (std::size_t i = 0; i < bits.size(); ++i) {
        const double any = std::bit_cast<double>(bits[i] * 0x9e3779b97f4a7c15);
        values.push_back(std::isfinite(any) ? any : double(bits[i]));
        text += fmt::format("{}{}", values.back(), i % 6 == 5 ? '\n' : ',');
    }
    const auto boxes = parsed_csv(text);
    RC_ASSERT(boxes.size() == 20u);
    RC_ASSERT(std::memcmp(boxes.data(), values.data(), values.size() * sizeof(double)) == 0);
}

RC_GTEST_PROP(Csv, AnyTextIsBoxesOrAnError, (const std::string& raw)) {
    std::string text = raw;
    for (char& c : text) c = "0123456789,,,,.-e\n\r na"[std::uint8_t(c) % 22];
    try {
        const auto boxes = parsed_csv(text);
        RC_ASSERT(boxes.size() <= std::size_t(std::count(text.begin(), text.end(), '\n')) + 1);
    } catch (const Error& error) {
        RC_ASSERT(error.code() == ErrorCode::bad_input);
    }
}

}  // namespace
}  // namespace octopair::test
