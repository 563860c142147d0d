// Tests that hold for both kinds of sweep, on cells and on boxes: kernels against scalar specifications, and both against brute force.
#include "octree/sweep/sweep.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "octree/sweep_kinds.hpp"

namespace octopair::test {
namespace {

template <typename Kind>
class Sweeps : public ::testing::Test {
protected:
    using Sweep = typename Kind::Sweep;
    using Set = typename Kind::Set;
    using Items = std::vector<typename Kind::Item>;
    /// Pairs of objects. Has a pair as often as it was found.
    using Found = std::multiset<std::pair<std::uint32_t, std::uint32_t>>;

    static constexpr std::size_t sizes[] = {0, 1, 2, 3, 4, 5, 7, 8, 9, 31, 33, 40, 63, 64, 65, 100, 130, 700};

    Items random_entries(std::uint32_t first_object) {
        return Kind::random_entries(random_, sizes[random_() % std::size(sizes)], first_object);
    }
    unsigned random_axis() { return unsigned(random_() % 3); }

    static Sweep sweep_of(const Set& rows, const Set& columns, SweepKind kind) {
        return {rows, kind == SweepKind::self ? rows : columns, kind};
    }

    static Positions positions(Kernel<Sweep> kernel, const Sweep& sweep, std::size_t room) {
        return Kind::positions(run(kernel, sweep, room));
    }

    static Found found_by(Kernel<Sweep> kernel, const Sweep& sweep) {
        Found found;
        for (const Pair& pair : Kind::pairs(sweep, run(kernel, sweep, 1000))) found.emplace(pair.a, pair.b);
        return found;
    }

    /// Returns the pairs that a test of every row against every column of its window finds.
    static Found brute_force(const Sweep& sweep) {
        Found found;
        for (std::size_t i = 0; i < sweep.rows.size(); ++i) {
            const auto row = Kind::item(sweep.rows, i);
            for (std::size_t k = 0; k < sweep.columns.size(); ++k) {
                const auto column = Kind::item(sweep.columns, k);
                const bool in_window = sweep.kind == SweepKind::self
                                           ? k > i
                                           : Kind::in_order(sweep, i, k, sweep.kind == SweepKind::cross_strict);
                if (in_window && Kind::is_pair(row, column)) found.insert(std::minmax(row.object, column.object));
            }
        }
        return found;
    }

    /// Returns the pairs within the entries, or between both lists of entries, whatever their order.
    static Found pairs_within(const Items& entries) {
        Found found;
        for (std::size_t i = 0; i < entries.size(); ++i) {
            for (std::size_t k = i + 1; k < entries.size(); ++k) {
                if (Kind::is_pair(entries[i], entries[k])) found.emplace(entries[i].object, entries[k].object);
            }
        }
        return found;
    }
    static Found pairs_between(const Items& first, const Items& second) {
        Found found;
        for (const auto& a : first) {
            for (const auto& b : second) {
                if (Kind::is_pair(a, b)) found.emplace(a.object, b.object);
            }
        }
        return found;
    }

    /// Expects of each kind of sweep, by the kernel and by the specification, the pairs of brute force; and each pair once.
    /// Returns the number of pairs.
    std::size_t expect_all_pairs(const Items& first, const Items& second) {
        const unsigned axis = random_axis();
        const Set rows = Kind::sorted_set(first, axis), columns = Kind::sorted_set(second, axis);
        for (const Kernel<Sweep> kernel : {Kernel<Sweep>(find_hits), Kernel<Sweep>(find_hits_scalar)}) {
            for (const SweepKind kind : sweep_kinds) {
                const Sweep sweep = sweep_of(rows, columns, kind);
                EXPECT_EQ(found_by(kernel, sweep), brute_force(sweep)) << "kind " << int(kind);
            }
            EXPECT_EQ(found_by(kernel, sweep_of(rows, rows, SweepKind::self)), pairs_within(first));
            Found both_ways = found_by(kernel, sweep_of(rows, columns, SweepKind::cross));
            both_ways.merge(found_by(kernel, sweep_of(columns, rows, SweepKind::cross_strict)));
            EXPECT_EQ(both_ways, pairs_between(first, second));
        }
        return pairs_within(first).size() + pairs_between(first, second).size();
    }

    std::mt19937 random_{1};
};

struct KindName {
    template <typename Kind>
    static std::string GetName(int) {
        return Kind::name;
    }
};
using Kinds = ::testing::Types<CellKind, BoxKind>;
TYPED_TEST_SUITE(Sweeps, Kinds, KindName);

TYPED_TEST(Sweeps, KernelAndSpecificationFindTheSameHitsInTheSameOrder) {
    constexpr std::size_t min_room = TypeParam::Sweep::min_room;
    for (int round = 0; round < 300; ++round) {
        const unsigned axis = this->random_axis();
        const auto rows = TypeParam::sorted_set(this->random_entries(0), axis);
        const auto columns = TypeParam::sorted_set(this->random_entries(1000), axis);
        for (const SweepKind kind : sweep_kinds) {
            const auto sweep = this->sweep_of(rows, columns, kind);
            const Positions expected = this->positions(find_hits_scalar, sweep, 100'000);
            for (const std::size_t room :
                 {min_room, min_room + 3, min_room + 5, std::size_t(1000), std::size_t(4000)}) {
                ASSERT_EQ(this->positions(find_hits_scalar, sweep, room), expected) << "round " << round;
                ASSERT_EQ(this->positions(find_hits, sweep, room), expected) << "round " << round;
            }
        }
    }
}

TYPED_TEST(Sweeps, FindEachPairOfRandomEntriesOnce) {
    std::size_t all = 0;
    for (int round = 0; round < 50 && !this->HasFailure(); ++round) {
        all += this->expect_all_pairs(this->random_entries(0), this->random_entries(1000));
    }
    EXPECT_GT(all, 1000u);
}

/// Boxes that are equal, are points, fill the grid, touch at corners, have one long box among them, or share a bit of their masks.
enum class Degenerate : std::uint8_t { coincident, points, filling, touching, one_long, one_mask };
constexpr Degenerate degenerate_kinds[] = {Degenerate::coincident, Degenerate::points,   Degenerate::filling,
                                           Degenerate::touching,   Degenerate::one_long, Degenerate::one_mask};

GridBox degenerate_box(std::mt19937& random, Degenerate kind, std::size_t i) {
    GridBox box{};
    for (unsigned axis = 0; axis < 3; ++axis) {
        const auto place = std::uint32_t(random() % GridBox::last);
        std::uint32_t &low = box.low[axis] = place, &high = box.high[axis] = place + std::uint32_t(random() % 2);
        if (kind == Degenerate::coincident) low = 5, high = 6;
        if (kind == Degenerate::points) low = high = place % 4;
        if (kind == Degenerate::filling) low = 0, high = GridBox::last;
        if (kind == Degenerate::touching) low = std::uint32_t(i % GridBox::last), high = low + 1;
        if (kind == Degenerate::one_long && i == 0) low = 0, high = GridBox::last;
    }
    if (kind == Degenerate::one_mask) box.mask = 4;
    return box;
}

TYPED_TEST(Sweeps, FindEachPairOfDegenerateEntriesOnce) {
    for (const Degenerate kind : degenerate_kinds) {
        std::size_t all = 0;
        for (const std::size_t count : {1, 2, 8, 65, 200}) {
            const auto entries = [&](std::size_t first_object) {
                std::vector<typename TypeParam::Item> made;
                for (std::size_t i = 0; i < count; ++i) {
                    made.push_back(
                        TypeParam::entry(degenerate_box(this->random_, kind, i), std::uint32_t(first_object + i)));
                }
                return made;
            };
            const auto first = entries(0);
            all += this->expect_all_pairs(first, entries(1000));
        }
        ASSERT_FALSE(this->HasFailure()) << "kind " << int(kind);
        EXPECT_EQ(all == 0, kind == Degenerate::one_mask) << "kind " << int(kind);
    }
}

TYPED_TEST(Sweeps, BaselineInstructionSetFindsTheSameHits) {
    constexpr std::size_t min_room = TypeParam::Sweep::min_room;
    const auto rows = TypeParam::sorted_set(TypeParam::random_entries(this->random_, 2000, 0), 1);
    const auto columns = TypeParam::sorted_set(TypeParam::random_entries(this->random_, 500, 10'000), 1);
    for (const SweepKind kind : sweep_kinds) {
        const auto sweep = this->sweep_of(rows, columns, kind);
        const std::size_t room = min_room + 42;
        const Positions best = this->positions(find_hits, sweep, room);
        restrict_sweep_to_baseline(true);
        const std::string restricted = sweep_instruction_set();
        const Positions baseline = this->positions(find_hits, sweep, room);
        restrict_sweep_to_baseline(false);
        EXPECT_EQ(best, baseline) << "against " << restricted;
        EXPECT_GT(best.size(), 1000u);
    }
}

}  // namespace
}  // namespace octopair::test
