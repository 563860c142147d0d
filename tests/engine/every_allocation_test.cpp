// Tests that a call of an engine may run out of memory at each of its allocations. It then throws Error{resource_limit} and leaves the
// list empty, and the next call of the engine is right.
#include <gtest/gtest.h>

#include "base/test_hooks.hpp"
#include "octopair/octopair.hpp"
#include "samples/scenes.hpp"
#include "support/at_allocation.hpp"

namespace octopair::test {
namespace {

class EveryAllocation : public ::testing::TestWithParam<unsigned> {
protected:
    struct Made {
        std::unique_ptr<Engine> engine;
        PairList list;
        std::vector<Pair> streamed;
        std::uint64_t count = 0;
    };
    Made made() const { return {make_local_engine(GetParam()), {}, {}, 0}; }
    Objects objects() const { return {boxes_}; }
    std::vector<Pair> right() const { return find_pairs(boxes_); }
    static void see(Made& made, std::span<const Pair> batch) {
        made.streamed.insert(made.streamed.end(), batch.begin(), batch.end());
    }

    std::vector<Box3f> boxes_ = samples::make_scene("dense", 400, 1);
};

INSTANTIATE_TEST_SUITE_P(, EveryAllocation, ::testing::Values(1u, 3u));

TEST_P(EveryAllocation, OfASearchMayFail) {
    const std::vector<Pair> pairs = right();
    const auto find = [&](Made& made) {
        made.list = {};
        made.engine->find_pairs(objects(), made.list, {});
    };
    const std::uint64_t failures = fail_every_allocation([&] { return made(); }, find,
                                                         [&](Made& made, bool failed) {
                                                             if (failed) {
                                                                 EXPECT_EQ(made.list.size(), 0u);
                                                                 find(made);
                                                             }
                                                             EXPECT_EQ(made.list.to_vector(), pairs);
                                                         });
    EXPECT_GT(failures, 20u);
}

/// An octant that gets entries from above needs memory for a second set. If that fails, the next search must not read what the set held.
TEST_P(EveryAllocation, OfASearchWithHandedDownEntriesMayFail) {
    const std::vector<Box3f> boxes = samples::make_scene("world10", 5000, 1);
#ifdef OCTOPAIR_TEST_HOOKS
    const auto& handed_down = test_hooks().paths[std::size_t(Path::handed_down)];
    const std::uint64_t before = handed_down;
#endif
    const std::vector<Pair> pairs = find_pairs(boxes);
#ifdef OCTOPAIR_TEST_HOOKS
    EXPECT_GT(handed_down, before);
#endif
    const auto find = [&](Made& made) {
        made.list = {};
        made.engine->find_pairs(Objects{boxes}, made.list, {});
    };
    const std::uint64_t failures = fail_every_allocation([&] { return made(); }, find,
                                                         [&](Made& made, bool failed) {
                                                             if (failed) find(made);
                                                             EXPECT_EQ(made.list.to_vector(), pairs);
                                                         });
    EXPECT_GT(failures, 20u);
}

TEST_P(EveryAllocation, OfAVerifiedJoinMayFail) {
    const Options verified{.margin = 0.01, .verify = true};
    std::vector<Pair> pairs;
    const auto join = [&](Made& made) {
        made.engine->find_pairs(Join{objects(), {std::span(boxes_).first(50)}}, made.list, verified);
    };
    Made first = made();
    join(first);
    pairs = first.list.to_vector();
    const std::uint64_t failures = fail_every_allocation([&] { return made(); }, join,
                                                         [&](Made& made, bool failed) {
                                                             if (failed) {
                                                                 EXPECT_EQ(made.list.size(), 0u);
                                                                 join(made);
                                                             }
                                                             EXPECT_EQ(made.list.to_vector(), pairs);
                                                         });
    EXPECT_GT(failures, 20u);
}

/// The pairs before the failure are the first ones of all.
TEST_P(EveryAllocation, OfAStreamMayFail) {
    const std::vector<Pair> pairs = right();
    const auto stream = [&](Made& made) {
        // The sink allocates, too.
        made.engine->stream_pairs(objects(), [&](auto batch) { see(made, batch); }, {.buffer_bytes = 1 << 10});
    };
    const std::uint64_t failures = fail_every_allocation(
        [&] { return made(); }, stream,
        [&](Made& made, bool failed) {
            if (failed) {
                ASSERT_LE(made.streamed.size(), pairs.size());
                EXPECT_TRUE(std::equal(made.streamed.begin(), made.streamed.end(), pairs.begin()));
                made.streamed.clear();
                stream(made);
            }
            EXPECT_EQ(made.streamed, pairs);
        });
    EXPECT_GT(failures, 20u);
}

TEST_P(EveryAllocation, OfACountMayFail) {
    const std::uint64_t pairs = right().size();
    const auto count = [&](Made& made) { made.count = made.engine->count_pairs(objects()); };
    const std::uint64_t failures = fail_every_allocation([&] { return made(); }, count,
                                                         [&](Made& made, bool failed) {
                                                             if (failed) {
                                                                 EXPECT_EQ(made.count, 0u);
                                                                 count(made);
                                                             }
                                                             EXPECT_EQ(made.count, pairs);
                                                         });
    EXPECT_GT(failures, 20u);
}

TEST_P(EveryAllocation, OfAJobMayFail) {
    const std::vector<Pair> pairs = right();
    const auto run = [&](Made& made) {
        Job job = made.engine->submit(boxes_);
        made.list = job.take_pairs();
    };
    const std::uint64_t failures = fail_every_allocation([&] { return made(); }, run,
                                                         [&](Made& made, bool failed) {
                                                             if (failed) run(made);
                                                             EXPECT_EQ(made.list.to_vector(), pairs);
                                                         });
    EXPECT_GT(failures, 20u);
}

TEST_P(EveryAllocation, OfAListOfOctantsMayFail) {
    const OctantOptions options{.threads = GetParam()};
    const std::size_t octants = list_octants(objects(), options).all().size();
    std::size_t listed = 0;
    const std::uint64_t failures =
        fail_every_allocation([&] { return 0; }, [&](int) { listed = list_octants(objects(), options).all().size(); },
                              [&](int, bool failed) {
                                  if (!failed) {
                                      EXPECT_EQ(listed, octants);
                                  }
                              });
    EXPECT_GT(failures, 10u);
}

}  // namespace
}  // namespace octopair::test
