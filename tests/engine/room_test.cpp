// Tests results that do not fit: they are refused with the number of pairs, before memory is full or a sink has got too many.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <regex>

#include "base/test_hooks.hpp"
#include "octopair/octopair.hpp"
#include "samples/scenes.hpp"
#include "support/calls.hpp"
#include "support/errors.hpp"
#include "support/foretold.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

constexpr Order orders[] = {Order::ascending, Order::octal};

std::vector<Box3f> coincident(std::size_t objects) { return std::vector<Box3f>(objects, Box3f{{0, 0, 0}, {1, 1, 1}}); }

/// Lets this process map `more` further bytes until destruction.
class FreeMemory {
public:
    explicit FreeMemory(rlim_t more) {
        std::uint64_t pages = 0;
        std::ifstream("/proc/self/statm") >> pages;
        (void)::getrlimit(RLIMIT_AS, &before_);
        const rlimit lower{rlim_t(pages) * rlim_t(::sysconf(_SC_PAGESIZE)) + more, before_.rlim_max};
        EXPECT_EQ(::setrlimit(RLIMIT_AS, &lower), 0);
    }
    ~FreeMemory() { (void)::setrlimit(RLIMIT_AS, &before_); }
    FreeMemory(const FreeMemory&) = delete;
    FreeMemory& operator=(const FreeMemory&) = delete;

private:
    rlimit before_{};
};

class Room : public ::testing::TestWithParam<unsigned> {
protected:
    /// Returns the TooManyPairs of a stream. Counts the delivered pairs.
    TooManyPairs refused(std::uint64_t most, const std::vector<Box3f>& boxes, const Options& options) {
        delivered_ = 0;
        try {
            engine_->stream_at_most(
                most, objects_of(boxes), [&](std::span<const Pair> pairs) { delivered_ += pairs.size(); }, options);
        } catch (const TooManyPairs& excess) {
            EXPECT_EQ(excess.code(), ErrorCode::resource_limit);
            return excess;
        }
        ADD_FAILURE() << "nothing was thrown";
        return {"", 0, false};
    }

    const std::unique_ptr<Engine> engine_ = make_local_engine(GetParam());
    std::uint64_t delivered_ = 0;
};

INSTANTIATE_TEST_SUITE_P(Threads, Room, ::testing::Values(1, 3),
                         [](const auto& values) { return std::to_string(values.param); });

TEST_P(Room, AnAscendingStreamIsRefusedBeforeItsFirstPair) {
    const auto boxes = coincident(2000);  // 1,999,000 pairs
    // The pairs fit into the larger buffer, and are counted ahead if they do not.
    for (const std::uint64_t buffer : {1u << 30, 1u << 20}) {
        const TooManyPairs excess = refused(1'998'999, boxes, {.buffer_bytes = buffer});
        EXPECT_STREQ(excess.what(), "1,999,000 pairs; at most 1,998,999 are allowed");
        EXPECT_TRUE(excess.exact());
        EXPECT_EQ(excess.pairs(), 1'999'000u);
        EXPECT_EQ(delivered_, 0u);
    }
}

TEST_P(Room, AnOctalStreamIsCountedWhenItGrows) {
    const auto boxes = coincident(2000);
    const TooManyPairs excess = refused(400'000, boxes, {.order = Order::octal});
    EXPECT_TRUE(excess.exact());
    EXPECT_EQ(excess.pairs(), 1'999'000u);
    EXPECT_LE(delivered_, 400'000u);
}

#ifdef OCTOPAIR_TEST_HOOKS

/// Counting ends soon after the bound if it takes long.
TEST_P(Room, ManyMorePairsAreNotAllCounted) {
    test_hooks().tuning.output.counting_seconds = 0;
    const auto boxes = coincident(6000);  // 17,997,000 pairs, in several shares
    for (const Order order : orders) {
        const TooManyPairs excess = refused(300'000, boxes, {.order = order, .buffer_bytes = 1 << 20});
        EXPECT_FALSE(excess.exact());
        EXPECT_GE(excess.pairs(), 300'000u);
        EXPECT_LT(excess.pairs(), 17'996'999u);
        EXPECT_TRUE(has_text(excess.what(), "more than "));
        EXPECT_LE(delivered_, 300'000u);
    }
    test_hooks().tuning = default_tuning;
}

#endif

/// Doubtful results that fit are delivered whole, once.
TEST_P(Room, WhatFitsIsDelivered) {
    const auto boxes = coincident(2000);
    for (const Order order : orders) {
        for (const std::uint64_t most : {1'999'000u, 2'500'000u}) {
            for (const std::uint64_t buffer : {1u << 30, 1u << 20}) {
                std::vector<Pair> pairs;
                engine_->stream_at_most(most, objects_of(boxes), append_to(pairs),
                                        {.order = order, .buffer_bytes = buffer});
                EXPECT_EQ(pairs, listed_pairs(*engine_, objects_of(boxes), {.order = order}));
            }
        }
        std::vector<Pair> first;
        engine_->stream_at_most(1000, objects_of(boxes), append_to(first), {.order = order, .limit = 1000});
        EXPECT_EQ(first.size(), 1000u);
        EXPECT_EQ(engine_->stream_at_most(5, objects_of(boxes), {}).pairs, 1'999'000u);  // only counted
    }
}

/// Returns a message with 0 in place of the megabytes that are free.
std::string rounded_free(const std::string& message) {
    return std::regex_replace(message, std::regex("memory, [0-9.]+ MB"), "memory, 0 MB");
}

class MemoryRoom : public ::testing::Test {
protected:
    void SetUp() override {
        if (sanitized) GTEST_SKIP() << "sanitizers map terabytes";
    }
    const std::unique_ptr<Engine> engine_ = make_local_engine(2);
};

TEST_F(MemoryRoom, AListThatExceedsTheMemoryIsRefusedWithItsNumber) {
    const auto boxes = coincident(16'000);  // 127,992,000 pairs, 1.02 GB
    const FreeMemory some(rlim_t(700) << 20);
    for (const Order order : orders) {
        PairList list;
        const std::string message = error_of(ErrorCode::resource_limit,
                                             [&] { engine_->find_pairs(objects_of(boxes), list, {.order = order}); });
        EXPECT_TRUE(foretells(rounded_free(message),
                              "127,992,000 pairs need 1.02 GB of memory, 0 MB are free; "
                              "use count_pairs, limit or stream_pairs"))
            << message;
        EXPECT_EQ(list.size(), 0u);
        EXPECT_EQ(engine_->count_pairs(objects_of(boxes)), 127'992'000u);
        engine_->find_pairs(objects_of(boxes), list, {.order = order, .limit = 1000, .buffer_bytes = 1 << 24});
        EXPECT_EQ(list.size(), 1000u);
    }
}

/// The forecast doubts this list, which is found again after the pairs were counted.
TEST_F(MemoryRoom, AListThatFitsIsFound) {
    const auto boxes = coincident(8'500);  // 36,120,750 pairs, 289 MB
    const FreeMemory some(rlim_t(600) << 20);
    for (const Order order : orders) {
        PairList list;
        for (unsigned call = 0; call < 2; ++call) {  // the second call has the memory of the first
            engine_->find_pairs(objects_of(boxes), list, {.order = order});
            EXPECT_EQ(list.size(), 36'120'750u);
        }
        std::uint64_t sum = 0;
        for (const auto chunk : list.chunks())
            for (const Pair& pair : chunk) sum += pair.b - pair.a;
        EXPECT_EQ(sum, 8'500ull * (8'500ull * 8'500 - 1) / 6);  // of all pairs, each once
    }
}

/// A limit that does not fit either.
TEST_F(MemoryRoom, AListWithALimitThatExceedsTheMemoryIsRefused) {
    const auto boxes = coincident(16'000);
    const FreeMemory some(rlim_t(700) << 20);
    for (const Order order : orders) {
        PairList list;
        const Options options{.order = order, .limit = 120'000'000, .buffer_bytes = 1 << 24};
        const std::string message =
            error_of(ErrorCode::resource_limit, [&] { engine_->find_pairs(objects_of(boxes), list, options); });
        EXPECT_TRUE(foretells(rounded_free(message),
                              "120,000,000 pairs need 960 MB of memory, 0 MB are free; "
                              "use count_pairs, limit or stream_pairs"))
            << message;
        EXPECT_EQ(list.size(), 0u);
    }
}

}  // namespace
}  // namespace octopair::test
