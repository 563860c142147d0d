// Tests the shares of a stream: results in order, concurrent shares, and that the call reports the first failure.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <utility>
#include <vector>

#include "engine/threads/team_output.hpp"
#include "octopair/error.hpp"
#include "support/errors.hpp"

namespace octopair::test {
namespace {

using std::chrono::seconds;

class Stream : public ::testing::TestWithParam<unsigned> {
protected:
    /// Returns the output of shares that write their number `each` times.
    std::vector<Pair> stream(std::size_t shares, std::size_t each, std::uint64_t buffer) {
        std::vector<Pair> all;
        const auto append = [&](std::span<const Pair> pairs) { all.insert(all.end(), pairs.begin(), pairs.end()); };
        run(shares, {append, buffer, stop_}, [&](std::size_t share, ShareWriter& writer) {
            const Pair pair{std::uint32_t(share), 0};
            for (std::size_t i = 0; i < each; ++i) writer.write({&pair, 1});
        });
        return all;
    }

    void run(std::size_t shares, const StreamTo& to, const std::function<void(std::size_t, ShareWriter&)>& share) {
        stream_pairs(team_, to, [&](Executor& executor) { executor.for_each_writing(shares, share); });
    }
    const PairSink ignore_ = [](std::span<const Pair>) {};

    Team team_{GetParam()};
    std::stop_source stop_;
};

/// Streams with more than one thread.
class StreamOfThreads : public Stream {};

std::string threads_of(const ::testing::TestParamInfo<unsigned>& info) { return std::to_string(info.param); }
INSTANTIATE_TEST_SUITE_P(Threads, Stream, ::testing::Values(1, 2, 3, 8), threads_of);
INSTANTIATE_TEST_SUITE_P(Threads, StreamOfThreads, ::testing::Values(2, 3, 8), threads_of);

TEST_P(Stream, IsInTheOrderOfItsShares) {
    for (const std::uint64_t buffer : {1, 100, 100'000}) {
        for (const std::size_t each : {0, 1, 100}) {
            const std::vector<Pair> all = stream(100, each, buffer);
            EXPECT_EQ(all.size(), 100 * each);
            EXPECT_TRUE(std::ranges::is_sorted(all, {}, &Pair::a)) << buffer << ' ' << each;
        }
    }
    EXPECT_TRUE(stream(0, 1, 1).empty());
}

/// The pairs of one write may be more than the buffer holds.
TEST_P(Stream, BuffersNoMorePairsThanAllowed) {
    constexpr std::size_t each = 500, shares = 60;
    for (const std::uint64_t buffer : {200u, 1000u}) {
        std::atomic<std::uint64_t> written = 0;
        std::uint64_t delivered = 0, most = 0;
        bool ordered = true;
        std::uint32_t last = 0;
        const PairSink receive = [&](std::span<const Pair> pairs) {
            // A share may deliver pairs before its write returns. `written` does not count these pairs yet, and they need no buffer.
            const std::uint64_t so_far = written.load();
            if (so_far > delivered) most = std::max(most, so_far - delivered);
            for (const Pair& pair : pairs) ordered &= std::exchange(last, pair.a) <= pair.a;
            delivered += pairs.size();
        };
        run(shares, {receive, buffer, stop_}, [&](std::size_t share, ShareWriter& writer) {
            const std::vector<Pair> pairs(each, Pair{std::uint32_t(share), 0});
            writer.write(pairs);
            written += each;
        });
        EXPECT_EQ(delivered, shares * each);
        EXPECT_TRUE(ordered);
        EXPECT_LE(most, buffer) << buffer;
    }
}

/// While another thread runs a share, the calling thread runs the next share.
TEST_P(StreamOfThreads, RunSharesSideBySide) {
    // Number of shares that may begin before the first share ends. With more shares, the calling thread could wait for
    // a successor in the last of them, while the helper that runs the first share gets no core.
    const std::size_t shares = 4 * GetParam();
    std::mutex mutex;
    std::condition_variable changed;
    std::size_t begun = 0, alone = 0;
    run(shares, {ignore_, 1000, stop_}, [&](std::size_t share, ShareWriter&) {
        std::unique_lock lock(mutex);
        begun = std::max(begun, share + 1);
        changed.notify_all();
        const auto is_followed = [&] { return begun > share + 1; };
        if (share + 1 < shares && alone == 0 && !changed.wait_for(lock, seconds(60), is_followed)) ++alone;
    });
    EXPECT_EQ(alone, 0u);
}

TEST_P(Stream, TellsTheFirstFailure) {
    const auto fail = [&] {
        run(50, {ignore_, 10, stop_}, [&](std::size_t share, ShareWriter& writer) {
            if (share == 20) throw Error(ErrorCode::resource_limit, "twenty");
            const Pair pair{std::uint32_t(share), 0};
            for (int i = 0; i < 100; ++i) {
                if (stop_.stop_requested()) throw Error(ErrorCode::cancelled, "stopped");
                writer.write({&pair, 1});
            }
        });
    };
    EXPECT_EQ(error_of(ErrorCode::resource_limit, fail), "twenty");
    EXPECT_TRUE(stop_.stop_requested());
}

TEST_P(Stream, EndsWhereItsReceiverFails) {
    std::size_t received = 0;
    const PairSink receive = [&](std::span<const Pair> pairs) {
        received += pairs.size();
        if (received >= 700) throw 7;
    };
    EXPECT_THROW(run(100, {receive, 100, stop_},
                     [](std::size_t share, ShareWriter& writer) {
                         const Pair pair{std::uint32_t(share), 0};
                         for (int i = 0; i < 50; ++i) writer.write({&pair, 1});
                     }),
                 int);
    EXPECT_LT(received, 1000u);
}

}  // namespace
}  // namespace octopair::test
