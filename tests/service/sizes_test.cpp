// Tests inputs and results at the size limits of messages, pieces, and small and large jobs.
#include <gtest/gtest.h>

#include "service/protocol/messages.hpp"
#include "service/served.hpp"
#include "service/server/jobs/job_scheduler.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

using service::max_small_objects;
using service::piece_bytes;

/// Returns `objects` boxes. The first `crowd` boxes are equal, and the others touch no box.
std::vector<Box3f> boxes_with(std::uint64_t objects, std::uint64_t crowd) {
    std::vector<Box3f> boxes;
    boxes.reserve(objects);
    for (std::uint64_t i = 0; i < objects; ++i) {
        const float x = i < crowd ? 0 : 2 * float(i);
        boxes.push_back({{x, 0, 0}, {x + 1, 1, 1}});
    }
    return boxes;
}

void expect_same(Engine& remote, const Objects& objects, const Options& options = {}) {
    const auto local = make_local_engine(2);
    PairList expected, found;
    std::vector<Pair> streamed;
    const PairSink sink = [&](auto batch) { streamed.insert(streamed.end(), batch.begin(), batch.end()); };
    const Summary wanted = local->find_pairs(objects, expected, options);
    const Summary listed = remote.find_pairs(objects, found, options);
    const Summary summary = remote.stream_pairs(objects, sink, options);
    EXPECT_EQ(found.to_vector(), expected.to_vector());
    EXPECT_EQ(streamed, expected.to_vector());
    EXPECT_EQ(listed.pairs, wanted.pairs);
    EXPECT_EQ(listed.truncated, wanted.truncated);
    EXPECT_EQ(summary.truncated, wanted.truncated);
    EXPECT_EQ(listed.entries, wanted.entries);
    EXPECT_EQ(remote.count_pairs(objects, options), wanted.pairs);
}

TEST(ServedSizes, OfInputsAtTheBordersOfPieces) {
    const Served served;
    const auto remote = served.client();
    constexpr std::uint64_t in_a_piece = piece_bytes / sizeof(Box3f);
    for (const std::uint64_t objects :
         {std::uint64_t(0), std::uint64_t(1), std::uint64_t(2), max_small_objects, max_small_objects + 1,
          in_a_piece - 1, in_a_piece, in_a_piece + 1, 2 * in_a_piece, 2 * in_a_piece + 1, 3 * in_a_piece + 2}) {
        SCOPED_TRACE(objects);
        const std::vector<Box3f> boxes = boxes_with(objects, 7);
        expect_same(*remote, {boxes});
    }
}

TEST(ServedSizes, OfInputsThatFillPiecesToTheByte) {
    const Served served;
    const auto remote = served.client();
    // Each object has 32 bytes. So boxes and paddings meet within a piece, and the last piece ends with the input.
    for (const std::uint64_t objects :
         {piece_bytes / 32 - 1, piece_bytes / 32, piece_bytes / 32 + 1, piece_bytes / 16}) {
        SCOPED_TRACE(objects);
        const std::vector<Box3f> boxes = boxes_with(objects, 7);
        const std::vector<double> padding(objects, 0.6);
        expect_same(*remote, {std::span(boxes), padding});
    }
}

TEST(ServedSizes, OfResultsAtTheBordersOfPieces) {
    const Served served;
    const auto remote = served.client();
    constexpr std::uint64_t in_a_piece = piece_bytes / sizeof(Pair);
    const std::vector<Box3f> boxes = boxes_with(900, 900);  // three pieces of pairs
    for (const std::uint64_t pairs :
         {std::uint64_t(0), std::uint64_t(1), std::uint64_t(2), std::uint64_t(2047), std::uint64_t(2048),
          std::uint64_t(2049), std::uint64_t(8192), std::uint64_t(8193), in_a_piece - 1, in_a_piece, in_a_piece + 1,
          2 * in_a_piece, 3 * in_a_piece + 1}) {
        for (const Order order : {Order::octal, Order::ascending}) {
            SCOPED_TRACE(std::to_string(pairs) + " pairs, order " + std::to_string(int(order)));
            expect_same(*remote, {boxes}, {.order = order, .limit = pairs});
        }
    }
}

TEST(ServedSizes, OfJoinsWithAnEmptySet) {
    const Served served;
    const auto remote = served.client();
    const std::vector<Box3f> boxes = boxes_with(50, 50), none;
    const std::vector<Box3d> wide = {{{0, 0, 0}, {1, 1, 1}}};
    const std::vector<double> padding = {0.5};
    PairList list;
    EXPECT_EQ(remote->find_pairs(Join{{boxes}, {none}}, list).pairs, 0u);
    EXPECT_EQ(remote->find_pairs(Join{{none}, {boxes}}, list).pairs, 0u);
    EXPECT_EQ(remote->find_pairs(Join{{none}, {none}}, list).pairs, 0u);
    EXPECT_EQ(remote->find_pairs(Join{{boxes}, {std::span(wide), padding}}, list).pairs, 50u);
    EXPECT_EQ(remote->find_pairs(Join{{std::span(wide), padding}, {boxes}}, list).pairs, 50u);
}

}  // namespace
}  // namespace octopair::test
