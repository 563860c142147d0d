// Tests how many pairs fit into a file. The size of the shortest file is compared with all pairs of a few indices.
#include "cli/output/output_room.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <string>
#include <vector>

#include "support/errors.hpp"

namespace octopair::test {
namespace {

using cli::ShortestRows;

/// Returns the bytes of all rows of indices below `indices`, shortest first.
std::vector<std::uint64_t> all_rows(const ShortestRows& rows, unsigned indices) {
    std::vector<std::uint64_t> bytes;
    for (unsigned a = 0; a < indices; ++a) {
        for (unsigned b = rows.join ? 0 : a + 1; b < indices; ++b) {
            bytes.push_back(rows.fixed + std::to_string(a).size() + std::to_string(b).size());
        }
    }
    std::ranges::sort(bytes);
    return bytes;
}

TEST(ShortestRows, AreThoseOfTheSmallestIndices) {
    for (const ShortestRows rows : {ShortestRows{2, false}, {2, true}, {12, false}, {0, true}}) {
        const std::vector<std::uint64_t> all = all_rows(rows, 1000);
        std::uint64_t sum = 0;
        for (std::size_t pairs = 0; pairs <= 20'000; ++pairs) {
            ASSERT_EQ(rows.bytes_of(pairs), sum) << pairs;
            ASSERT_EQ(rows.pairs_in(sum), pairs);
            ASSERT_EQ(rows.pairs_in(sum + all[pairs] - 1), pairs);
            sum += all[pairs];
        }
    }
}

TEST(ShortestRows, OfAllPairsOfObjects) {
    const ShortestRows rows{2, false};
    // 45 pairs of one digit, 900 of one and two, then 9,000 of one and three and 4,005 of two.
    EXPECT_EQ(rows.bytes_of(45 + 900 + 9000 + 4005), 45u * 4 + 900 * 5 + 13'005 * 6);
    EXPECT_EQ(rows.pairs_in(~std::uint64_t(0)), rows.pairs_in(~std::uint64_t(0) - 1));
    EXPECT_GT(rows.pairs_in(~std::uint64_t(0)), std::uint64_t(1) << 59);
}

TEST(OutputRoom, HasTheBytesOfAPair) {
    rlimit before{};
    ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
    const rlimit lower{600'000'000, before.rlim_max};
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &lower), 0);
    cli::DetectRequest request;
    request.output = "pairs.npy";
    cli::OutputRoom room(request), wide(request, 16);
    room.require(40'000'000);
    const std::string message = error_of(ErrorCode::resource_limit, [&] { wide.require(40'000'000); });
    (void)::setrlimit(RLIMIT_FSIZE, &before);
    EXPECT_EQ(message,
              "pairs.npy: 40,000,000 pairs need 640 MB, 600 MB are allowed for a file (ulimit -f); "
              "use --count-only, --limit or a stream (without --output)");
}

}  // namespace
}  // namespace octopair::test
