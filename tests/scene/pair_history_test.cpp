// Tests PairHistory: its refusals, and that a refused call changes nothing.
#include "scene/pair_history.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "octopair/error.hpp"
#include "scene/model.hpp"
#include "support/errors.hpp"

namespace octopair::test {
namespace {

using Pairs = std::vector<Pair>;

void set_fresh(PairHistory& history, const Pairs& pairs) {
    detail::PairStorage& storage = detail::storage_of(history.fresh());
    storage.reset();
    storage.append(storage.copy(pairs));
}

class PairHistoryTest : public ::testing::Test {
protected:
    PairHistoryTest() { take_over({{1, 2}, {3, 7}, {4, 5}}); }

    PairChanges take_over(const Pairs& pairs) {
        set_fresh(history_, pairs);
        PairChanges changes;
        history_.take_over(changes);
        return changes;
    }
    void expect_refused(const PairChanges& changes, const std::string& text) {
        const std::string message = error_if_any(ErrorCode::engine_failed, [&] { history_.apply(changes); });
        EXPECT_TRUE(has_text(message, text));
        expect_unchanged();
    }
    void expect_unchanged() {
        EXPECT_EQ(history_.size(), 3U);
        EXPECT_EQ(history_.list().to_vector(), (Pairs{{1, 2}, {3, 7}, {4, 5}}));
    }
    /// Applies changes whose error is found when the list is read. Then repairs the history with a full detection.
    void expect_inconsistent(const std::vector<PairChanges>& steps, const std::string& text) {
        for (const PairChanges& changes : steps) history_.apply(changes);
        for (int i = 0; i < 2; ++i) {
            const std::string message = error_if_any(ErrorCode::engine_failed, [&] { (void)history_.list(); });
            EXPECT_TRUE(has_text(message, text));
            EXPECT_TRUE(history_.is_inconsistent());
        }
        EXPECT_EQ(error_if_any(ErrorCode::engine_failed, [&] { take_over({{0, 9}}); }), "");
        EXPECT_FALSE(history_.is_inconsistent());
        EXPECT_EQ(history_.list().to_vector(), (Pairs{{0, 9}}));
    }

    PairHistory history_;
};

TEST_F(PairHistoryTest, AFullDetectionThatListsAPairTwice) {
    const std::string message = error_if_any(ErrorCode::engine_failed, [&] { take_over({{1, 2}, {6, 8}, {6, 8}}); });
    EXPECT_TRUE(has_text(message, "full detection lists pair 6-8 twice"));
    expect_unchanged();
}

TEST_F(PairHistoryTest, AFullDetectionOutOfOrder) {
    const std::string message = error_if_any(ErrorCode::engine_failed, [&] { take_over({{1, 2}, {4, 5}, {3, 7}}); });
    EXPECT_TRUE(has_text(message, "full detection lists pair 3-7 after pair 4-5"));
    expect_unchanged();
}

TEST_F(PairHistoryTest, AFullDetectionWhoseLastPairsAreTwiceAndOld) {
    EXPECT_NE(error_if_any(ErrorCode::engine_failed, [&] { take_over({{4, 5}, {4, 5}}); }), "");
    expect_unchanged();
}

TEST_F(PairHistoryTest, AStepThatListsAPairTwice) {
    expect_refused({{{0, 1}, {6, 8}, {6, 8}}, {}}, "began lists pair 6-8 twice");
    expect_refused({{}, {{3, 7}, {3, 7}}}, "ended lists pair 3-7 twice");
    expect_refused({{}, {{3, 7}, {1, 2}}}, "ended lists pair 1-2 after pair 3-7");
}

TEST_F(PairHistoryTest, AStepThatEndsMoreThanThereIs) {
    expect_refused({{}, {{0, 1}, {0, 2}, {0, 3}, {0, 4}}},
                   "4 pairs ended, the first of them pair 0-1, but the scene had 3");
}

TEST_F(PairHistoryTest, APairThatBeganButWasThere) { expect_inconsistent({{{{3, 7}}, {}}}, "pair 3-7 began, but"); }
TEST_F(PairHistoryTest, APairThatBeganInTwoSteps) {
    expect_inconsistent({{{{6, 8}}, {}}, {{{6, 8}}, {}}}, "pair 6-8 began twice");
}
TEST_F(PairHistoryTest, APairThatEndedButWasNotThere) { expect_inconsistent({{{}, {{6, 8}}}}, "pair 6-8 ended, but"); }
TEST_F(PairHistoryTest, APairBeyondTheListThatEnded) {
    expect_inconsistent({{{{0, 1}}, {{9, 10}}}}, "pair 9-10 ended, but");
}
TEST_F(PairHistoryTest, APairThatEndedInTwoSteps) {
    expect_inconsistent({{{}, {{3, 7}}}, {{}, {{3, 7}}}}, "pair 3-7 ended twice");
}

TEST_F(PairHistoryTest, StepsThatAreRight) {
    history_.apply({{{6, 8}}, {{3, 7}}});
    history_.apply({{{3, 7}}, {{1, 2}}});
    history_.apply({{{0, 1}}, {{6, 8}}});
    EXPECT_EQ(history_.list().to_vector(), (Pairs{{0, 1}, {3, 7}, {4, 5}}));
    const PairChanges changes = take_over({{3, 7}, {9, 10}});
    EXPECT_EQ(changes.began, (Pairs{{9, 10}}));
    EXPECT_EQ(changes.ended, (Pairs{{0, 1}, {4, 5}}));
}

}  // namespace
}  // namespace octopair::test
