// Tests the lines of texts: all ends of lines, and the byte order mark.
#include "io/files/line_splitter.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace octopair::test {
namespace {

std::vector<std::string> lines_of(std::string_view text) {
    std::vector<std::string> lines;
    for (io::LineSplitter splitter(text); splitter.next();) {
        lines.emplace_back(splitter.line());
        EXPECT_EQ(splitter.number(), lines.size());
    }
    EXPECT_LE(lines.size(), io::most_lines(text));
    return lines;
}

TEST(LineSplitter, EndsLinesWithAnyEnd) {
    const std::vector<std::string> lines = {"a", "", "b c"};
    for (const std::string end : {"\n", "\r\n", "\r"}) {
        const std::string text = "a" + end + end + "b c";
        EXPECT_EQ(lines_of(text), lines);
        EXPECT_EQ(lines_of(text + end), lines);
        EXPECT_EQ(lines_of("\xef\xbb\xbf" + text), lines);
    }
    EXPECT_EQ(lines_of("a\r\n\nb c\r"), lines);
    EXPECT_EQ(lines_of("a\n\rb c"), lines);
    EXPECT_EQ(lines_of(""), std::vector<std::string>());
    EXPECT_EQ(lines_of("\xef\xbb\xbf"), std::vector<std::string>());
    EXPECT_EQ(lines_of("\r"), std::vector<std::string>(1));
    EXPECT_EQ(lines_of("\xef\xbb"), std::vector<std::string>{"\xef\xbb"});
}

TEST(LineSplitter, TellsWhereBytesAfterAHeaderBegin) {
    // The bytes after the header may look like another end of a line.
    for (const auto& [text, offset] : std::vector<std::pair<std::string, std::size_t>>{
             {"ply\nend\n\rx", 8}, {"ply\nend\n\nx", 8}, {"ply\rend\r\nx", 8}, {"ply\r\nend\r\n\nx", 10}}) {
        io::LineSplitter splitter(text);
        ASSERT_TRUE(splitter.next() && splitter.next());
        EXPECT_EQ(splitter.line(), "end");
        EXPECT_EQ(splitter.offset(), offset);
    }
}

}  // namespace
}  // namespace octopair::test
