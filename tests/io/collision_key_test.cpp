// Tests keys of objects and collisions.
#include "io/results/collision_key.hpp"

#include <gtest/gtest.h>

namespace octopair::test {
namespace {

using Keys = std::vector<std::string>;

/// Returns the keys of all objects of the sets.
Keys keys_of(std::vector<io::ObjectNames> sets) {
    const std::vector<io::ObjectKeys> keys = io::make_object_keys(sets);
    Keys all;
    for (std::size_t set = 0; set < sets.size(); ++set) {
        sets[set].keys = &keys[set];
        for (std::uint32_t i = 0; i < sets[set].sources.back().end; ++i) all.push_back(io::object_key(i, sets[set]));
    }
    return all;
}

TEST(CollisionKeys, AreIdsOrPathsInTheFile) {
    const std::vector<std::string> names = {"m.ifc/wall", "m.ifc/site", "t.obj/left", "t.obj", "t.objects", "", "left"};
    io::ObjectDetails details;
    io::DetailsBuilder builder(details);
    builder.add({"", "", "W1", "", "", ""});
    builder.add({});
    const io::ObjectSource sources[] = {{"d/m.ifc", 2, "P", ""}, {"d/t.obj", 6, "", "t.obj"}, {"u.glb", 7}};
    const io::ObjectNames first{names, {}, &details, sources};
    const Keys expected = {"P/W1", "1:m.ifc/site", "2:left", "2:", "2:t.objects", "2#3", "3:left"};
    EXPECT_EQ(keys_of({first}), expected);
    const io::ObjectSource same[] = {{"d/m.ifc", 2, "P", ""}};
    Keys both = expected;
    both.insert(both.end(), {"P/W1~2", "4:m.ifc/site"});
    EXPECT_EQ(keys_of({first, {names, {}, &details, same}}), both) << "a join with the same file";
    const io::ObjectSource no_project[] = {{"d/m.ifc", 1}};
    EXPECT_EQ(keys_of({{names, {}, &details, no_project}}), Keys{"1/W1"});
}

TEST(CollisionKeys, EqualPathsAreNumbered) {
    const std::vector<std::string> names = {"bolt", "bolt", "bolt~2", "bolt", "bolt~2"};
    const io::ObjectSource sources[] = {{"a.glb", 5}};
    EXPECT_EQ(keys_of({{names, {}, nullptr, sources}}),
              (Keys{"1:bolt", "1:bolt~3", "1:bolt~2", "1:bolt~4", "1:bolt~2~2"}));
    const std::vector<std::string> many(100'000, "bolt");
    const io::ObjectSource long_source[] = {{"a.glb", 100'000}};
    EXPECT_EQ(keys_of({{many, {}, nullptr, long_source}}).back(), "1:bolt~100000");
}

TEST(CollisionKeys, OfCollisionsHaveTheLesserFirst) {
    const std::vector<std::string> names = {"b", "a | 1:c", "a"};
    const io::ObjectSource sources[] = {{"a.glb", 3}};
    const io::ObjectKeys keys;
    const io::ObjectNames set{.names = names, .sources = sources, .keys = &keys};
    EXPECT_EQ(io::collision_key({0, 2}, {set, set}), "1:a | 1:b");
    EXPECT_EQ(io::collision_key({2, 0}, {set, set}), "1:a | 1:b");
    EXPECT_EQ(io::collision_key({1, 0}, {set, set}), R"(1:a \| 1:c | 1:b)");
    EXPECT_EQ(io::collision_key({0, 1}, {}), "");
    const std::vector<std::uint32_t> owners = {0, 0, 2};
    const io::ObjectNames triangles{.names = names, .owners = owners, .sources = sources, .keys = &keys};
    EXPECT_EQ(io::collision_key({1, 2}, {triangles, triangles}), "1:a#0 | 1:b#1");
}

}  // namespace
}  // namespace octopair::test
