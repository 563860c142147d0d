// Tests exchanges that need several messages, and failures that are reported on all ranks.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include <numeric>

#include "engine/mpi/comm/agreement.hpp"
#include "engine/mpi/comm/communicator.hpp"
#include "engine/mpi/partition/even_cuts.hpp"
#include "mpi/ranks.hpp"

namespace octopair::test {
namespace {

/// Returns the number of values that rank `from` sends to rank `to`.
std::uint64_t count_between(unsigned from, unsigned to) {
    return (from * 7 + to * 13) % 5 == 0 ? 0 : 100 * from + 37 * to;
}

std::uint32_t value(unsigned from, unsigned to, std::uint64_t i) {
    return std::uint32_t(from * 1'000'000 + to * 10'000 + i);
}

TEST(RankCommunicator, ExchangesInMessagesOfAnyLength) {
    for (const std::size_t message_bytes : {std::size_t(4), std::size_t(60), std::size_t(1000), std::size_t(1) << 30}) {
        Communicator comm(MPI_COMM_WORLD, message_bytes);
        const unsigned ranks = comm.size(), rank = comm.rank();
        RankCounts sent(ranks);
        std::vector<std::uint32_t> out;
        std::uint64_t bytes = 0, messages = 0;
        for (unsigned to = 0; to < ranks; ++to) {
            sent[to] = count_between(rank, to);
            for (std::uint64_t i = 0; i < sent[to]; ++i) out.push_back(value(rank, to, i));
            if (to == rank) continue;
            bytes += 4 * sent[to];
            messages += (4 * sent[to] + message_bytes - 1) / message_bytes;
        }
        const Exchange counts = comm.plan_exchange(sent);
        std::vector<std::uint32_t> in(counts.incoming());
        const Traffic before = comm.traffic();
        comm.exchange(out.data(), in.data(), counts);
        EXPECT_EQ(comm.traffic().bytes - before.bytes, bytes);
        EXPECT_EQ(comm.traffic().messages - before.messages, messages);
        auto at = in.begin();
        for (unsigned from = 0; from < ranks; ++from) {
            ASSERT_EQ(counts.received[from], count_between(from, rank));
            for (std::uint64_t i = 0; i < counts.received[from]; ++i) ASSERT_EQ(*at++, value(from, rank, i));
        }
        std::vector<std::uint64_t> sums(100, rank);
        comm.add_up(sums);
        EXPECT_EQ(sums, std::vector<std::uint64_t>(100, ranks * (ranks - 1) / 2));
        std::vector<int> told(333, rank + 1 == ranks ? 5 : 0);
        comm.broadcast(std::span(told), ranks - 1);
        EXPECT_EQ(told, std::vector<int>(333, 5));
    }
}

TEST(RankCommunicator, TellsTheFirstBadObjectBeforeOtherFailures) {
    Communicator comm(MPI_COMM_WORLD);
    Agreement agreement(comm);
    agreement.together([] {});
    const auto fail = [&] {
        if (comm.rank() % 3 == 0) throw BadObject{1000 - comm.rank(), "object " + std::to_string(1000 - comm.rank())};
        if (comm.rank() % 3 == 1) throw Error(ErrorCode::io_failed, "disk");
    };
    const unsigned lowest = 1000 - (comm.size() - 1) / 3 * 3;
    EXPECT_EQ(error_of(ErrorCode::bad_input, [&] { agreement.together(fail); }), "object " + std::to_string(lowest));
}

TEST(RankCuts, AreEven) {
    const std::vector<std::uint64_t> even(1000, 3);
    EXPECT_EQ(even_cuts(even, 4), (std::vector<std::size_t>{0, 250, 500, 750, 1000}));
    const std::vector<std::uint64_t> lumped = {0, 0, 100, 0, 1, 1};
    const std::vector<std::size_t> cuts = even_cuts(lumped, 3);
    EXPECT_EQ(cuts.size(), 4u);
    EXPECT_TRUE(std::is_sorted(cuts.begin(), cuts.end()));
    EXPECT_EQ(cuts.front(), 0u);
    EXPECT_EQ(cuts.back(), lumped.size());
    EXPECT_EQ(even_cuts({}, 3), (std::vector<std::size_t>{0, 0, 0, 0}));
    EXPECT_EQ(even_cuts(std::vector<std::uint64_t>(5, 0), 2), (std::vector<std::size_t>{0, 5, 5}));
}

/// Returns the smallest possible work of the largest of `parts` parts, by trying all cuts.
std::uint64_t least_largest(std::span<const std::uint64_t> work, std::size_t parts) {
    if (parts == 1 || work.empty()) return std::accumulate(work.begin(), work.end(), std::uint64_t(0));
    std::uint64_t first = 0, least = ~std::uint64_t(0);
    for (std::size_t cut = 0; cut <= work.size(); ++cut) {
        least = std::min(least, std::max(first, least_largest(work.subspan(cut), parts - 1)));
        if (cut < work.size()) first += work[cut];
    }
    return least;
}

TEST(RankCuts, HaveTheLeastWorkOfTheLargestPart) {
    std::mt19937 random(1);
    for (unsigned round = 0; round < 300; ++round) {
        std::vector<std::uint64_t> work(random() % 9);
        for (std::uint64_t& one : work) one = random() % 4 == 0 ? 0 : random() % 100;
        const std::size_t parts = 1 + random() % 4;
        const std::vector<std::size_t> cuts = least_cuts(work, parts);
        ASSERT_EQ(cuts.size(), parts + 1);
        ASSERT_TRUE(std::ranges::is_sorted(cuts));
        ASSERT_EQ(cuts.front(), 0u);
        ASSERT_EQ(cuts.back(), work.size());
        std::uint64_t largest = 0;
        for (std::size_t part = 0; part < parts; ++part) {
            const auto begin = work.begin() + std::ptrdiff_t(cuts[part]),
                       end = work.begin() + std::ptrdiff_t(cuts[part + 1]);
            largest = std::max(largest, std::accumulate(begin, end, std::uint64_t(0)));
        }
        // A cut is exact to one thousandth of the mean, and one.
        EXPECT_LE(largest, least_largest(work, parts) + 1);
    }
}

}  // namespace
}  // namespace octopair::test
