// Tests scenes whose steps are cancelled between changes and queries. Few objects of many move, so that steps are incremental.
#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <optional>
#include <random>
#include <stop_token>
#include <tuple>
#include <vector>

#include "octopair/octopair.hpp"
#include "support/calls.hpp"
#include "support/errors.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

constexpr std::size_t cancelled_scene_size = scaled(20'000, 10);
constexpr std::size_t moved_objects = 4;  // the objects that move, to places near each other

class CancelledSteps : public ::testing::TestWithParam<std::tuple<unsigned, double>> {
protected:
    CancelledSteps() : boxes_(cancelled_scene_size), ids_(cancelled_scene_size) {
        for (Box3f& box : boxes_) box = cube_at(place(0, 100), place(0, 100), place(0, 100));
        SceneOptions options{.threads = std::get<0>(GetParam()), .slack = std::get<1>(GetParam())};
        scene_.emplace(options);
        scene_->add({boxes_}, ids_);
    }

    float place(float low, float high) { return std::uniform_real_distribution<float>(low, high)(random_); }
    static Box3f cube_at(float x, float y, float z) { return {{x, y, z}, {x + 0.5f, y + 0.5f, z + 0.5f}}; }

    void move_one() {
        const std::size_t i = random_() % moved_objects;
        boxes_[i] = random_() % 2 == 0 ? cube_at(place(90, 91), 90, 90) : cube_at(place(10, 11), 10, 10);
        scene_->move(std::span(&ids_[i], 1), std::span<const Box3f>(&boxes_[i], 1));
    }

    void cancel_step() {
        (void)error_of(ErrorCode::cancelled, [&] { (void)scene_->step(requested_stop()); });
    }

    void check_step() {
        const std::vector<Pair> before = pairs_;
        const StepResult& step = scene_->step();
        incremental_ += step.full ? 0 : 1;
        pairs_ = find_pairs(boxes_);
        std::vector<Pair> began, ended;
        std::ranges::set_difference(pairs_, before, std::back_inserter(began), less);
        std::ranges::set_difference(before, pairs_, std::back_inserter(ended), less);
        ASSERT_EQ(std::vector(step.began.begin(), step.began.end()), began);
        ASSERT_EQ(std::vector(step.ended.begin(), step.ended.end()), ended);
        ASSERT_EQ(scene_->pairs().to_vector(), pairs_);
    }
    static bool less(const Pair& a, const Pair& b) { return std::tie(a.a, a.b) < std::tie(b.a, b.b); }

    void check_query() {
        const Box3d box{{90, 90, 90}, {91, 90.5, 90.5}};
        std::vector<std::uint32_t> expected;
        for (std::uint32_t i = 0; i < cancelled_scene_size; ++i) {
            bool touches = true;
            for (int axis = 0; axis < 3; ++axis)
                touches &= double(boxes_[i].min[axis]) <= box.max[axis] && box.min[axis] <= double(boxes_[i].max[axis]);
            if (touches) expected.push_back(i);
        }
        ASSERT_EQ(scene_->overlaps(box), expected);
    }

    std::mt19937 random_{1};
    std::vector<Box3f> boxes_;
    std::vector<ObjectId> ids_;
    std::optional<Scene> scene_;
    std::vector<Pair> pairs_;  // of the last step
    int incremental_ = 0;
};

TEST_P(CancelledSteps, LeaveTheSceneAsItWas) {
    for (int i = 0; i < 150; ++i) {
        SCOPED_TRACE(i);
        const auto call = random_() % 10;
        if (call < 3) {
            move_one();
        } else if (call < 5) {
            cancel_step();
        } else if (call < 7) {
            check_query();
        } else {
            check_step();
        }
        if (HasFatalFailure()) return;
    }
    EXPECT_GT(incremental_, 0);
}

INSTANTIATE_TEST_SUITE_P(, CancelledSteps, ::testing::Combine(::testing::Values(1u, 2u), ::testing::Values(0.0, 0.25)));

}  // namespace
}  // namespace octopair::test
