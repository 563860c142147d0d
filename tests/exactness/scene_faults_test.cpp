// Tests scenes whose searches give wrong results because of planted faults. A detectably wrong step throws and changes
// nothing. The next full step without the fault is correct.
#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <string>
#include <vector>

#include "boxes/box_kernel.hpp"
#include "exactness/small_scenes.hpp"
#include "exactness/tiny_tuning.hpp"
#include "samples/random.hpp"
#include "scene/model.hpp"
#include "support/errors.hpp"

#ifdef OCTOPAIR_TEST_HOOKS

namespace octopair::test {
namespace {

constexpr std::uint64_t objects = 60;

Box3f random_box(samples::RandomStream& random) {
    Box3f box;
    for (int axis = 0; axis < 3; ++axis) {
        box.min[axis] = float(random.below(64));
        box.max[axis] = box.min[axis] + float(random.below(24));
    }
    return box;
}

/// A scene of random boxes with its expected pairs.
class TestScene {
public:
    explicit TestScene(std::uint64_t seed) : random_(seed, 0), ids_(objects), scene_({.threads = 1}) {
        for (std::uint64_t i = 0; i < objects; ++i) boxes_.push_back(random_box(random_));
        scene_.add(Objects{boxes_}, ids_);
    }

    void move(std::uint64_t count) {
        for (std::uint64_t i = 0; i < count; ++i) boxes_[random_.below(objects)] = random_box(random_);
        scene_.move(ids_, Boxes(std::span<const Box3f>(boxes_)));
    }
    /// Moves an object beyond all others.
    void move_away(std::uint32_t object) {
        boxes_[object] = {{1000, 1000, 1000}, {1001, 1001, 1001}};
        scene_.move(std::span(&ids_[object], 1), Boxes(std::span<const Box3f>(&boxes_[object], 1)));
    }

    Scene& scene() { return scene_; }
    const std::vector<Pair>& last() const { return last_; }
    std::vector<Pair> true_pairs() const {
        Model model;
        for (std::uint32_t i = 0; i < objects; ++i) model.objects[i] = {ids_[i], wide(boxes_[i]), 0, {}};
        return model.pairs();
    }

    /// Compares a step with the pairs of the last step that did not throw.
    void check_step() {
        const StepResult& result = scene_.step();
        const std::vector<Pair> now = true_pairs();
        std::vector<Pair> began, ended;
        std::set_difference(now.begin(), now.end(), last_.begin(), last_.end(), std::back_inserter(began));
        std::set_difference(last_.begin(), last_.end(), now.begin(), now.end(), std::back_inserter(ended));
        EXPECT_EQ(std::vector<Pair>(result.began.begin(), result.began.end()), began);
        EXPECT_EQ(std::vector<Pair>(result.ended.begin(), result.ended.end()), ended);
        EXPECT_EQ(result.persisting, now.size() - began.size());
        EXPECT_EQ(scene_.pairs().to_vector(), now);
        EXPECT_EQ(scene_.persisting().to_vector().size(), result.persisting);
        last_ = now;
    }

    /// Makes a step with a fault and reads its pairs. Returns the message of the thrown error, empty if no error
    /// was thrown.
    std::string faulty_step(Fault fault) {
        const FaultScope planted(fault);
        return error_if_any(ErrorCode::engine_failed, [&] {
            (void)scene_.step();
            last_ = scene_.pairs().to_vector();
        });
    }

    /// Returns the message of the error of Scene::verify(), empty if there is none.
    std::string fault_that_verify_finds() {
        return error_if_any(ErrorCode::engine_failed, [&] { (void)scene_.verify(); });
    }

private:
    samples::RandomStream random_;
    std::vector<Box3f> boxes_;
    std::vector<ObjectId> ids_;
    Scene scene_;
    std::vector<Pair> last_;  // pairs of the last step that did not throw
};

Tuning tuning_with(std::uint64_t seed, StepChoice step) {
    Tuning tuning = tiny_tuning(seed);
    tuning.scene = default_tuning.scene;
    tuning.scene.step = step;
    return tuning;
}

class DoubledPairs : public ::testing::TestWithParam<Fault> {};

TEST_P(DoubledPairs, AreAnErrorThatChangesNothing) {
    int errors = 0;
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        const TuningScope tiny(tuning_with(seed, seed % 2 == 0 ? StepChoice::full : StepChoice::incremental));
        TestScene test(seed);
        test.check_step();
        test.move(objects);
        const std::string message = test.faulty_step(GetParam());
        if (!message.empty()) {
            ++errors;
            EXPECT_TRUE(has_text(message, " twice"));
            EXPECT_EQ(test.scene().pairs().to_vector(), test.last());
        } else {
            EXPECT_EQ(test.last(), test.true_pairs());
        }
        test.move(3);
        test.check_step();
        test.move(3);
        test.check_step();
        if (HasFailure()) return;
    }
    EXPECT_GT(errors, 5);
}

std::string fault_name_of(const ::testing::TestParamInfo<Fault>& info) {
    return info.param == Fault::part_joined_twice ? "part_joined_twice" : "sweep_repeats_block";
}

INSTANTIATE_TEST_SUITE_P(, DoubledPairs, ::testing::Values(Fault::sweep_repeats_block, Fault::part_joined_twice),
                         fault_name_of);

/// Returns the first pair of `all` that is missing in `some`.
const Pair* first_missing(const std::vector<Pair>& some, const std::vector<Pair>& all) {
    for (const Pair& pair : all) {
        if (!std::binary_search(some.begin(), some.end(), pair)) return &pair;
    }
    return nullptr;
}

std::string text_of(const Pair& pair) { return "(" + std::to_string(pair.a) + ", " + std::to_string(pair.b) + ")"; }

TEST(MissingPairs, OfAFullStepComeBackWithTheNext) {
    int missing = 0;
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        const TuningScope tiny(tuning_with(seed, StepChoice::full));
        TestScene test(seed);
        test.check_step();
        test.move(objects);
        ASSERT_EQ(test.faulty_step(Fault::window_end_open), "");
        const std::vector<Pair> all = test.true_pairs();
        const Pair* const pair = first_missing(test.last(), all);
        missing += pair != nullptr ? 1 : 0;
        EXPECT_EQ(test.fault_that_verify_finds(),
                  pair == nullptr ? "" : "verification failed: pair " + text_of(*pair) + " is missing");
        test.move(3);
        test.check_step();
        if (HasFailure()) return;
    }
    EXPECT_GT(missing, 5);
}

TEST(MissingPairs, ThatEndAreAnErrorUntilTheNextFullStep) {
    int errors = 0;
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        const TuningScope tiny(tuning_with(seed, StepChoice::incremental));
        TestScene test(seed);
        ASSERT_EQ(test.faulty_step(Fault::window_end_open), "");
        const std::vector<Pair> all = test.true_pairs();
        const Pair* const pair = first_missing(test.last(), all);
        if (pair == nullptr) continue;
        ++errors;
        test.move_away(pair->a);
        std::string message = test.faulty_step(Fault::none);
        EXPECT_TRUE(has_text(message, "ended"));
        message = test.faulty_step(Fault::none);
        EXPECT_EQ(message, "");
        EXPECT_EQ(test.last(), test.true_pairs());
        test.move(3);
        test.check_step();
        if (HasFailure()) return;
    }
    EXPECT_GT(errors, 5);
}

}  // namespace
}  // namespace octopair::test

#endif
