// Tests the table of details: equal texts are stored once, and tables of several sets become one.
#include "io/object_details.hpp"

#include <gtest/gtest.h>

namespace octopair::test {
namespace {

using io::Detail;

TEST(ObjectDetails, StoresEqualTextsOnce) {
    io::ObjectDetails details;
    io::DetailsBuilder builder(details);
    builder.add({"a", "wall", "1", "", "", "stone"});
    builder.add({"b", "wall", "2", "a", "", ""});
    EXPECT_EQ(details.words.size(), 7u);  // with the empty text
    EXPECT_EQ(details.of(1, Detail::type), "wall");
    EXPECT_EQ(details.of(1, Detail::parent), "a");
    EXPECT_EQ(details.of(1, Detail::material), "");
    EXPECT_EQ(details.of(2, Detail::label), "");
    EXPECT_TRUE(details.has(Detail::material));
    EXPECT_FALSE(details.has(Detail::level));
}

TEST(ObjectDetails, AppendKeepsTheNumbersOfObjects) {
    io::ObjectDetails one, two, none;
    io::DetailsBuilder(one).add({"a", "wall", "", "", "", ""});
    io::DetailsBuilder(two).add({"b", "wall", "", "", "", ""});
    io::append_details(none, {}, {3, 4});
    EXPECT_TRUE(none.empty());
    io::append_details(none, one, {2, 1});
    EXPECT_EQ(none.of(2, Detail::label), "a");
    EXPECT_EQ(none.of(0, Detail::label), "");
    io::append_details(none, two, {3, 2});
    ASSERT_EQ(none.rows.size(), 5u);
    EXPECT_EQ(none.of(3, Detail::label), "b");
    EXPECT_EQ(none.of(3, Detail::type), "wall");
    EXPECT_EQ(none.of(4, Detail::type), "");
    EXPECT_EQ(none.words.size(), 4u);
}

TEST(ObjectDetails, LongListsOfMaterialsAreCut) {
    EXPECT_EQ(io::joined_materials({}), "");
    EXPECT_EQ(io::joined_materials({"b", "a"}), "a, b");
    std::set<std::string> many;
    for (char c = 'a'; c <= 'z'; ++c) many.insert(std::string(1, c));
    EXPECT_EQ(io::joined_materials(many), "a, b, c, d, e, f, g, h, ...");
}

}  // namespace
}  // namespace octopair::test
