// Tests filters that need no geometry, against plain loops.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>

#include "octopair/error.hpp"
#include "octopair/filters.hpp"
#include "octopair/octopair.hpp"
#include "pipeline/batch_access.hpp"
#include "pipeline/name_filter.hpp"
#include "samples/scenes.hpp"
#include "support/errors.hpp"

namespace octopair::test {
namespace {

using Numbers = std::vector<std::uint32_t>;
using Names = std::vector<std::string>;

constexpr std::uint32_t objects = 40;

/// Returns all pairs within one set of `objects` objects, or all pairs between two such sets.
std::vector<Pair> all_pairs(bool join) {
    std::vector<Pair> pairs;
    for (std::uint32_t a = 0; a < objects; ++a) {
        for (std::uint32_t b = join ? 0 : a + 1; b < objects; ++b) pairs.push_back({a, b});
    }
    return pairs;
}

std::vector<Pair> through(const Filter& filter, bool join) {
    Batch batch;
    detail::BatchAccess::append(batch, all_pairs(join));
    filter.apply(batch);
    return {batch.pairs().begin(), batch.pairs().end()};
}

template <typename Keep>
std::vector<Pair> kept(bool join, Keep keep) {
    std::vector<Pair> pairs = all_pairs(join);
    std::erase_if(pairs, [&](Pair pair) { return !keep(pair); });
    return pairs;
}

class SimpleFilters : public ::testing::TestWithParam<bool> {
protected:
    static constexpr int rounds = 20;

    Numbers numbers(std::uint32_t below) {
        Numbers drawn(objects);
        for (std::uint32_t& number : drawn) number = draw(below);
        return drawn;
    }
    std::uint32_t draw(std::uint32_t below) { return std::uint32_t(random_() % below); }
    /// Returns random text of few letters, so that many patterns match.
    std::string text(const std::string& letters) {
        std::string drawn(draw(6), ' ');
        for (char& c : drawn) c = letters[draw(std::uint32_t(letters.size()))];
        return drawn;
    }
    Names names() {
        Names drawn(objects);
        for (std::string& name : drawn) name = text("ab/");
        return drawn;
    }
    bool join() const { return GetParam(); }

    std::mt19937 random_{7};
};

INSTANTIATE_TEST_SUITE_P(, SimpleFilters, ::testing::Bool(),
                         [](const auto& drawn) { return drawn.param ? "Join" : "Within"; });

TEST_P(SimpleFilters, GroupsSelectEachOther) {
    for (int round = 0; round < rounds; ++round) {
        const Numbers groups = numbers(8), masks = numbers(8);
        const Numbers groups_b = join() ? numbers(8) : groups, masks_b = join() ? numbers(8) : masks;
        const auto filter =
            make_group_filter({groups, masks}, join() ? std::optional(GroupMasks{groups_b, masks_b}) : std::nullopt);
        EXPECT_EQ(through(*filter, join()), kept(join(), [&](Pair pair) {
                      return (groups[pair.a] & masks_b[pair.b]) && (groups_b[pair.b] & masks[pair.a]);
                  }));
    }
}

TEST_P(SimpleFilters, IgnoredPairsAreLeftOut) {
    for (const std::uint32_t count : {0u, 1u, 30u, 700u}) {
        std::vector<Pair> ignored;
        for (std::uint32_t i = 0; i < count; ++i) ignored.push_back({draw(objects), draw(objects)});
        const auto filter = make_ignored_pairs_filter(ignored, join());
        EXPECT_EQ(through(*filter, join()), kept(join(), [&](Pair pair) {
                      return std::ranges::none_of(ignored, [&](Pair out) {
                          return out == pair || (!join() && out == Pair{pair.b, pair.a});
                      });
                  }));
    }
}

TEST_P(SimpleFilters, ParentsDiffer) {
    const Numbers parents = numbers(6), parents_b = join() ? numbers(6) : parents;
    const auto filter =
        make_parent_filter(parents, join() ? std::optional<std::span<const std::uint32_t>>(parents_b) : std::nullopt);
    EXPECT_EQ(through(*filter, join()), kept(join(), [&](Pair pair) { return parents[pair.a] != parents_b[pair.b]; }));
}

/// Returns whether a pattern matches a name. Reference for matches_pattern, by recursion.
bool fits_plainly(std::string_view name, std::string_view pattern) {
    if (pattern.empty()) return name.empty();
    if (pattern[0] == '*') {
        for (std::size_t taken = 0; taken <= name.size(); ++taken) {
            if (fits_plainly(name.substr(taken), pattern.substr(1))) return true;
        }
        return false;
    }
    return !name.empty() && (pattern[0] == '?' || pattern[0] == name[0]) &&
           fits_plainly(name.substr(1), pattern.substr(1));
}

TEST_P(SimpleFilters, NameRulesLeaveOutEitherWayRound) {
    for (int round = 0; round < rounds; ++round) {
        const Names names_a = names(), names_b = join() ? names() : names_a;
        std::vector<NameRule> rules;
        for (std::uint32_t i = draw(6); i > 0; --i) rules.push_back({text("ab/*?*"), text("ab/*?*")});
        const auto filter = make_name_filter(
            names_a, rules, join() ? std::optional<std::span<const std::string>>(names_b) : std::nullopt);
        EXPECT_EQ(through(*filter, join()), kept(join(), [&](Pair pair) {
                      const std::string &a = names_a[pair.a], &b = names_b[pair.b];
                      return a.empty() || b.empty() || std::ranges::none_of(rules, [&](const NameRule& rule) {
                                 return (fits_plainly(a, rule.a) && fits_plainly(b, rule.b)) ||
                                        (fits_plainly(a, rule.b) && fits_plainly(b, rule.a));
                             });
                  }));
    }
}

TEST_P(SimpleFilters, ColumnRulesNeedAllTheirColumns) {
    const auto columns = [](const Names& first, const Names& second) {
        return TextColumns{first.size(), [&](std::uint32_t object, std::size_t column) {
                               return std::string_view(column == 0 ? first[object] : second[object]);
                           }};
    };
    const auto fits = [](const ColumnPatterns& patterns, const TextColumns& set, std::uint32_t object) {
        for (std::size_t i = 0; i < patterns.size(); ++i) {
            const std::string_view text = set.text(object, i);
            if (patterns[i] && (text.empty() || !fits_plainly(text, *patterns[i]))) return false;
        }
        return true;
    };
    const auto patterns = [&] {
        ColumnPatterns all(draw(3));
        for (auto& pattern : all) {
            if (draw(2) == 0) pattern = text("ab/*?*");
        }
        return all;
    };
    for (int round = 0; round < rounds; ++round) {
        const Names names_a = names(), types_a = names(), names_b = names(), types_b = names();
        const TextColumns first = columns(names_a, types_a);
        const TextColumns second = join() ? columns(names_b, types_b) : first;
        std::vector<ColumnRule> rules;
        for (std::uint32_t i = draw(4); i > 0; --i) rules.push_back({patterns(), patterns()});
        const auto filter = make_column_filter(first, rules, join() ? &second : nullptr);
        EXPECT_EQ(through(*filter, join()), kept(join(), [&](Pair pair) {
                      return std::ranges::none_of(rules, [&](const ColumnRule& rule) {
                          return (fits(rule.a, first, pair.a) && fits(rule.b, second, pair.b)) ||
                                 (fits(rule.b, first, pair.a) && fits(rule.a, second, pair.b));
                      });
                  }));
    }
}

TEST_P(SimpleFilters, PatternsMeanWhatTheySay) {
    for (int i = 0; i < 20'000; ++i) {
        const std::string name = text("ab"), pattern = text("ab*?*");
        EXPECT_EQ(matches_pattern(name, pattern), fits_plainly(name, pattern))
            << '"' << name << "\" \"" << pattern << '"';
    }
}

TEST(NamePatterns, CountCharacters) {
    EXPECT_TRUE(matches_pattern("Tür", "T?r"));
    EXPECT_TRUE(matches_pattern("Tür/größe", "T?r/*?e"));
    EXPECT_FALSE(matches_pattern("Tür", "T??r"));
    EXPECT_TRUE(matches_pattern("\xFF\xFE", "??"));
    EXPECT_TRUE(matches_pattern("frame/bolt 7", "*/bolt*"));
    EXPECT_FALSE(matches_pattern("bolt 7", "*/bolt*"));
    EXPECT_FALSE(matches_pattern("Frame", "frame"));
    EXPECT_TRUE(matches_pattern("", "*"));
    EXPECT_FALSE(matches_pattern("", "?"));
    // No pattern takes more than |name| * |pattern| steps.
    EXPECT_FALSE(matches_pattern(std::string(20'000, 'a'), std::string("*a*a*a*a*a*a*a*a*a*a") + "b"));
}

TEST(SimpleFilterErrors, SizesAgree) {
    const Numbers two{1, 2}, three{1, 2, 3};
    EXPECT_THROW((void)make_group_filter({two, three}), Error);
    EXPECT_THROW((void)make_group_filter({two, two}, GroupMasks{three, two}), Error);
    EXPECT_THROW((void)make_ignored_pairs_filter({{0, 0xFFFFFFFF}}), Error);
    EXPECT_THROW((void)make_filter("none", {}), Error);
}

/// Tests filters that have values for fewer objects than the engine.
TEST(SimpleFilterErrors, ObjectsWithoutValuesAreRefused) {
    const auto boxes = samples::make_scene("coincident", 5, 1);
    const Numbers three{1, 2, 3};
    const Names names{"a", "b", "c"};
    const auto engine = make_local_engine(1);
    const auto run = [&](std::unique_ptr<Filter> filter) {
        Pipeline pipeline(1);
        pipeline.add(std::move(filter));
        pipeline.run(*engine, {boxes}, {});
    };
    const auto refused = [&](std::unique_ptr<Filter> filter, const std::string& message) {
        EXPECT_EQ(error_of(ErrorCode::bad_input, [&] { run(std::move(filter)); }), message);
    };
    refused(make_parent_filter(three), "object 3 has no parent: values were given for 3 objects");
    refused(make_group_filter({three, three}), "object 3 has no group: values were given for 3 objects");
    refused(make_name_filter(names, {}), "object 3 has no name: values were given for 3 objects");
}

}  // namespace
}  // namespace octopair::test
