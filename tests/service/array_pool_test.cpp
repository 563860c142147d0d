// Tests the pool of arrays for later jobs: an array is reused only where it fits, and the pool stays small.
#include <gtest/gtest.h>

#include "service/server/jobs/array_pool.hpp"

namespace octopair::service {
namespace {

class ArrayPoolTest : public ::testing::Test {
protected:
    static constexpr std::uint64_t many = 100'000;  // 2.4 MB

    /// Gives an array of `count` boxes to the pool. Returns the address of its boxes.
    const Box3f* give(std::uint64_t count) {
        auto boxes = engine_->allocate_boxes<Box3f>(count);
        const Box3f* const place = boxes.boxes().data();
        pool_.give(*engine_, std::move(boxes));
        return place;
    }
    const Box3f* take(std::uint64_t count) {
        held_.push_back(pool_.take<float>(*engine_, count));
        EXPECT_GE(held_.back().size(), count);
        return held_.back().boxes().data();
    }

    const std::unique_ptr<Engine> engine_ = make_local_engine(1), other_ = make_local_engine(1);
    ArrayPool pool_;
    std::vector<BoxArray<Box3f>> held_;
};

TEST_F(ArrayPoolTest, GoToTheNextThatTheyFit) {
    const Box3f* const place = give(many);
    EXPECT_NE(take(many + 1), place);
    EXPECT_NE(take(many / 2 - 1), place);
    EXPECT_EQ(take(many - 1), place);
    EXPECT_NE(take(many - 1), place);
}

TEST_F(ArrayPoolTest, GoToTheirOwnEngineInTheirPrecision) {
    const Box3f* const place = give(many);
    const auto others = pool_.take<float>(*other_, many);
    EXPECT_NE(others.boxes().data(), place);
    const auto wider = pool_.take<double>(*engine_, many);
    EXPECT_EQ(wider.size(), many);
    EXPECT_EQ(take(many), place);
}

TEST_F(ArrayPoolTest, AreNeitherTinyNorMany) {
    for (const std::uint64_t count : {std::uint64_t(10), std::uint64_t(6'000'000)}) {
        give(count);
        EXPECT_EQ(pool_.bytes(), 0u);
    }
    const Box3f* last = nullptr;
    for (int i = 1; i <= 5; ++i) {
        held_.clear();
        for (int k = 0; k < i; ++k) take(1'000'000);
        for (auto& one : held_) {
            last = one.boxes().data();
            pool_.give(*engine_, std::move(one));
        }
        EXPECT_EQ(pool_.bytes(), std::uint64_t(i) * 24'000'000);
    }
    give(2'000'000);  // replaces two of the oldest arrays
    EXPECT_EQ(pool_.bytes(), 120'000'000u);
    EXPECT_EQ(take(999'999), last);
}

}  // namespace
}  // namespace octopair::service
