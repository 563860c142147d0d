// Tests caller-defined indices of more than 32 bits, on objects that are distributed over the ranks in any order. The
// pairs equal those of the local engine for the same objects in the order of their indices.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <optional>

#include "mpi/ranks.hpp"
#include "octopair/error.hpp"
#include "samples/random.hpp"
#include "samples/scenes.hpp"
#include "support/cases.hpp"

namespace octopair::test {
namespace {

/// Objects and their caller-defined indices.
struct Called {
    OwnedObjects objects;
    std::vector<std::uint64_t> indices;
    IndexedObjects view() const { return {objects.view(), indices}; }
};

/// Returns the index of element i of an ordered set.
std::uint64_t index_of(std::uint32_t i) { return (std::uint64_t(1) << 35) + 7 * std::uint64_t(i); }

template <typename Element>
std::vector<Element> in_order(const std::vector<Element>& elements, const std::vector<std::uint32_t>& order) {
    std::vector<Element> chosen;
    for (const std::uint32_t i : order) {
        if (!elements.empty()) chosen.push_back(elements[i]);
    }
    return chosen;
}

/// Returns this rank's part of a set in a random order.
Called scattered(const OwnedObjects& set, Spread spread, std::uint64_t seed) {
    std::vector<std::uint32_t> order(set.view().size());
    std::iota(order.begin(), order.end(), 0u);
    samples::RandomStream random(seed, 0);
    for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[std::size_t(random.below(i))]);
    const std::vector<std::uint32_t> own = slice(order, spread);
    Called called;
    std::visit([&](const auto& boxes) { called.objects.boxes = in_order(boxes, own); }, set.boxes);
    called.objects.padding = in_order(set.padding, own);
    for (const std::uint32_t i : own) called.indices.push_back(index_of(i));
    return called;
}

std::vector<Pair64> called(const std::vector<Pair>& pairs) {
    std::vector<Pair64> all(pairs.size());
    std::ranges::transform(pairs, all.begin(), [](const Pair& pair) {
        return Pair64{index_of(pair.a), index_of(pair.b)};
    });
    return all;
}

class RankIndices : public ::testing::Test {
protected:
    void expect_same(const Case& whole, std::uint64_t seed) {
        for (const Order order : {Order::ascending, Order::octal}) {
            for (const bool limited : {false, true}) {
                Options options{.order = order, .margin = whole.margin};
                if (limited) options.limit = whole.limit;
                const Spread spread = spreads[seed % std::size(spreads)];
                SCOPED_TRACE(whole.describe() + ", " + name_of(spread));
                PairList expected;
                std::vector<Pair64> found;
                const Called first = scattered(whole.first, spread, seed);
                std::optional<Called> second;
                if (whole.second) second = scattered(*whole.second, Spread::even, seed + 1);
                const Summary summary = local_->find_pairs(whole.input(), expected, options);
                const Summary found_summary = find_pairs64(
                    *ranks_, {first.view(), second ? std::optional(second->view()) : std::nullopt}, found, options);
                EXPECT_EQ(all_pieces(found), called(expected.to_vector()));
                EXPECT_EQ(found_summary.pairs, summary.pairs);
                EXPECT_EQ(found_summary.truncated, summary.truncated);
            }
        }
    }

    const std::unique_ptr<Engine> local_ = make_local_engine(1), ranks_ = make_mpi_engine(MPI_COMM_WORLD);
};

TEST_F(RankIndices, AreThoseOfTheCaller) {
    for (const char* kind : {"uniform", "dense", "clustered", "mixed", "coincident", "same-x", "far-outlier"}) {
        for (std::uint64_t i = 0; i < case_count(3); ++i) {
            const std::uint64_t seed = case_seed(kind, i);
            const Case whole = make_case(kind, seed);
            expect_same(whole, seed);
        }
    }
}

TEST_F(RankIndices, CountOnFromRankToRankWhereNoneAreGiven) {
    const std::vector<Box3f> boxes = samples::make_scene("dense", 3'000, 1);
    const std::vector<Box3f> own = slice(boxes, Spread::lopsided);
    std::vector<Pair64> found, expected;
    (void)find_pairs64(*ranks_, IndexedObjects{{own}, {}}, found);
    for (const Pair& pair : find_pairs(boxes)) expected.push_back({pair.a, pair.b});
    EXPECT_EQ(all_pieces(found), expected);
}

TEST_F(RankIndices, AreRefusedOnAllRanks) {
    const std::vector<Box3f> boxes = samples::make_scene("dense", 1'000, 1);
    std::vector<Box3f> own = slice(boxes, Spread::even);
    std::vector<std::uint64_t> indices(own.size());
    std::iota(indices.begin(), indices.end(), std::uint64_t(1) << 40);
    const auto expect_refused = [&](ErrorCode code, const std::string& message, std::span<const std::uint64_t> given) {
        std::vector<Pair64> found(1);
        std::optional<Error> refused;
        try {
            (void)find_pairs64(*ranks_, IndexedObjects{{own}, given}, found);
        } catch (const Error& error) {
            refused = error;
        }
        ASSERT_TRUE(on_all(refused.has_value()));
        EXPECT_EQ(int(refused->code()), int(code)) << refused->what();
        EXPECT_TRUE(has_text(refused->what(), message));
        EXPECT_TRUE(found.empty());
    };
    const bool last = own_rank() + 1 == rank_count();
    expect_refused(ErrorCode::bad_input, "3 indices for", last ? std::span(indices).first(3) : std::span(indices));
    if (rank_count() > 1) {
        expect_refused(ErrorCode::usage, "other ranks give indices", last ? std::span(indices).first(0) : indices);
        // All ranks give the same indices.
        expect_refused(ErrorCode::bad_input, "is given to two objects", indices);
    }
    std::ranges::transform(indices, indices.begin(),
                           [&](std::uint64_t index) { return index + own_slice(1'000, Spread::even).begin; });
    if (own_rank() == 0) own[5].max[1] = std::numeric_limits<float>::quiet_NaN();
    expect_refused(ErrorCode::bad_input, "object 1099511627781: ", indices);
}

TEST_F(RankIndices, NeedRanks) {
    std::vector<Pair64> found;
    EXPECT_THROW((void)find_pairs64(*local_, IndexedObjects{}, found), Error);
}

}  // namespace
}  // namespace octopair::test
