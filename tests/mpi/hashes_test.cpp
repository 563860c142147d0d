// Tests that ranks give the same bytes as threads, for every kind of scene and every distribution of objects over
// ranks.
#include <gtest/gtest.h>

#include "mpi/ranks.hpp"
#include "samples/scenes.hpp"
#include "support/calls.hpp"
#include "support/compare.hpp"
#include "support/hash.hpp"
#include "support/kinds.hpp"
#include "support/pinned.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

class RankHashes : public ::testing::TestWithParam<std::string> {
protected:
    static Objects view(const std::vector<Box3f>& boxes) { return {boxes, {}}; }
    static Options options_of(Order order) {
        Options options{.order = order};
        return options;
    }
    static std::vector<Pair> listed(Engine& engine, const Objects& objects, Order order) {
        return listed_pairs(engine, objects, options_of(order));
    }
    static std::vector<Pair> streamed(Engine& engine, const Objects& objects, Order order) {
        std::vector<Pair> all;
        (void)engine.stream_pairs(
            objects, [&](std::span<const Pair> batch) { all.insert(all.end(), batch.begin(), batch.end()); },
            options_of(order));
        return all;
    }

    const Pinned& pinned_ = pinned_scene(GetParam());
    const std::vector<Box3f> boxes_ = samples::make_scene(GetParam(), pinned_.objects, 1);
};

TEST_P(RankHashes, AreThoseOfThreads) {
    const bool many = pinned_.pairs > 300'000;
    if (many && sanitized) GTEST_SKIP() << "too many pairs for a sanitizer";
    const std::vector<Pair> octal = listed(*make_local_engine(1), view(boxes_), Order::octal);
    for (const unsigned threads : {1u, 2u}) {
        const auto engine = make_mpi_engine(MPI_COMM_WORLD, {.threads = threads});
        for (const Spread spread : spreads) {
            if (many && spread != Spread::even) continue;
            SCOPED_TRACE(std::to_string(threads) + " threads, " + name_of(spread));
            const std::vector<Box3f> own = slice(boxes_, spread);
            EXPECT_EQ(hash_of(all_pieces(listed(*engine, view(own), Order::ascending))), pinned_.pair_hash);
            EXPECT_EQ(hash_of(all_pieces(streamed(*engine, view(own), Order::ascending))), pinned_.pair_hash);
            EXPECT_TRUE(same_bytes(all_pieces(listed(*engine, view(own), Order::octal)), octal));
            EXPECT_TRUE(same_bytes(all_pieces(streamed(*engine, view(own), Order::octal)), octal));
            EXPECT_EQ(engine->count_pairs(view(own)), pinned_.pairs);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(, RankHashes, ::testing::ValuesIn(sample_kind_names()), param_name);

TEST(Ranks, ShareTheWork) {
    const std::vector<Box3f> boxes = samples::make_scene("uniform", 100'000, 1);
    const std::vector<Box3f> own = slice(boxes, Spread::even);
    const auto engine = make_mpi_engine(MPI_COMM_WORLD);
    for (const Order order : {Order::octal, Order::ascending}) {
        PairList piece;
        Options options{.order = order};
        const Summary summary = engine->find_pairs({own, {}}, piece, options);
        EXPECT_GT(piece.size(), summary.pairs / rank_count() / 2);
        EXPECT_LT(piece.size(), 2 * summary.pairs / rank_count() + 1);
    }
}

/// Uses a buffer too small for the pairs of a rank: pairs are sent in windows, up to any limit.
TEST(Ranks, StreamManyPairsInBoundedMemory) {
    const std::vector<Box3f> boxes = samples::make_scene("dense", scaled(300'000, 2), 1);
    const std::vector<Box3f> own = slice(boxes, Spread::even);
    const std::vector<Pair> expected = find_pairs(boxes);
    Options options{.buffer_bytes = 1 << 20};
    const auto streamed = [&](Engine& engine, std::uint64_t& most) {
        std::vector<Pair> all;
        const Summary summary = engine.stream_pairs(
            {own, {}},
            [&](std::span<const Pair> batch) {
                all.insert(all.end(), batch.begin(), batch.end());
                most = std::max<std::uint64_t>(most, batch.size());
            },
            options);
        EXPECT_EQ(summary.pairs, std::min<std::uint64_t>(options.limit.value_or(~0ull), expected.size()));
        EXPECT_EQ(summary.truncated, summary.pairs < expected.size());
        return all_pieces(all);
    };
    for (const unsigned threads : {1u, 2u}) {
        const auto engine = make_mpi_engine(MPI_COMM_WORLD, {.threads = threads});
        for (const std::uint64_t limit : {~std::uint64_t(0), std::uint64_t(expected.size() / 2), std::uint64_t(0)}) {
            options.limit = limit;
            std::uint64_t most = 0;
            const std::vector<Pair> found = streamed(*engine, most);
            const auto wanted = std::span(expected).first(std::min<std::uint64_t>(limit, expected.size()));
            EXPECT_TRUE(same_bytes(found, {wanted.begin(), wanted.end()}));
            EXPECT_LE(most * sizeof(Pair), options.buffer_bytes);
        }
        // Then all pairs again, without a limit.
        options.limit.reset();
        EXPECT_TRUE(same_bytes(all_pieces(listed_pairs(*engine, {own, {}})), expected));
    }
}

/// The pairs of a single rank do not fit into the buffer, so all pairs are sent in windows.
TEST(Ranks, StreamWhatIsTooMuchForOneOfThem) {
    std::vector<Box3f> boxes = samples::make_scene("uniform", 20'000, 1);
    boxes.insert(boxes.end(), 500, boxes.front());
    const std::vector<Box3f> own = slice(boxes, Spread::even);
    const auto engine = make_mpi_engine(MPI_COMM_WORLD);
    Options options{.buffer_bytes = 1 << 20};
    std::vector<Pair> found;
    (void)engine->stream_pairs(
        {own, {}}, [&](std::span<const Pair> batch) { found.insert(found.end(), batch.begin(), batch.end()); },
        options);
    EXPECT_TRUE(same_bytes(all_pieces(found), find_pairs(boxes)));
}

TEST(Ranks, GatherTheirPieces) {
    const std::vector<Box3f> boxes = samples::make_scene("uniform", 20'000, 1);
    const std::vector<Box3f> own = slice(boxes, Spread::lopsided);
    const auto engine = make_mpi_engine(MPI_COMM_WORLD);
    PairList pairs;
    const Summary summary = engine->find_pairs({own, {}}, pairs);
    gather_pairs(*engine, pairs);
    if (own_rank() == 0) {
        EXPECT_EQ(pairs.size(), summary.pairs);
        EXPECT_TRUE(same_bytes(pairs.to_vector(), find_pairs(boxes)));
    } else {
        EXPECT_EQ(pairs.size(), 0u);
    }
}

}  // namespace
}  // namespace octopair::test
