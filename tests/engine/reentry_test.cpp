// Tests callbacks of the local engine that call their engine.
#include "support/reentry.hpp"

namespace octopair::test {
namespace {

TEST(Reentry, IsRefusedByTheLocalEngineOnAnyThread) {
    for (const unsigned threads : {1u, 4u}) {
        SCOPED_TRACE(threads);
        expect_reentry_is_refused(*make_local_engine(threads));
    }
}

/// Two engines that call each other in turn would wait for the first one.
TEST(Reentry, IsRefusedThroughAnotherEngine) {
    const auto outer = make_local_engine(2), inner = make_local_engine(2);
    const std::vector<Box3f> boxes = boxes_in_a_row(20'000);
    const auto input = Objects{boxes};
    bool tried = false;
    (void)outer->stream_pairs(input, [&](std::span<const Pair>) {
        (void)inner->stream_pairs(input, [&](std::span<const Pair>) {
            if (!tried) expect_calls_refused(*outer);
            tried = true;
        });
    });
    EXPECT_TRUE(tried);
}

}  // namespace
}  // namespace octopair::test
