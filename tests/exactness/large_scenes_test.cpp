// Tests large scenes on the local engine against a second algorithm that shares no code with the octree. For larger
// scenes, compares results before and after the scene is permuted, mirrored, scaled or split in two.
//
// OCTOPAIR_TEST_LARGE_SCENES=N checks N scenes instead of the default number.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "exactness/large_scenes.hpp"
#include "samples/random.hpp"
#include "support/families.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

constexpr std::uint64_t usual_scenes = scaled(20, 10);
constexpr std::uint64_t large_parts = 4;  // the scenes are split, so that several processes can share them
constexpr std::uint64_t min_objects = scaled(9'000, 3);

class LargeScenes : public ::testing::TestWithParam<std::uint64_t> {};

TEST_P(LargeScenes, AgreeWithTheSecondAlgorithm) {
    const EngineFor engines = local_engines();
    const SceneRange scenes = scene_range(SceneSize::large, usual_scenes).part(GetParam(), large_parts);
    for (std::uint64_t i = scenes.begin; i < scenes.end; ++i) {
        const Case a_case = large_case(i, min_objects);
        const auto finding = check_large_case(a_case, engines, i % 4 == 0 ? Calls::all : Calls::few);
        ASSERT_FALSE(finding) << "large case " << i << ", " << a_case.describe() << ": " << finding->check << ": "
                              << finding->text;
    }
}

INSTANTIATE_TEST_SUITE_P(Parts, LargeScenes, ::testing::Range(std::uint64_t(0), large_parts));

/// Scenes whose nested octrees once reported pairs twice.
class LongTails : public ::testing::TestWithParam<std::uint64_t> {};

TEST_P(LongTails, GiveEachPairOnce) {
    Case a_case;
    a_case.first.boxes = long_tailed_boxes(40'000, GetParam());
    a_case.limit = 1'000;
    std::fill_n(a_case.threads, 3, 2);
    const EngineFor engines = local_engines();
    const auto check = [&] { return check_large_case(a_case, engines, Calls::all); };
    ASSERT_FALSE(check()) << check()->text;
    a_case.second.emplace().boxes = long_tailed_boxes(20'000, GetParam() + 100);
    ASSERT_FALSE(check()) << check()->text;
}

INSTANTIATE_TEST_SUITE_P(Seeds, LongTails, ::testing::Values(2, 13, 36));

TEST(ClothScenes, GiveEachPairOnce) {
    const EngineFor engines = local_engines();
    for (const std::uint64_t seed : {1, 20, 40}) {
        const Case a_case = cloth_case(scaled(120'000, 4), seed);
        const auto finding = check_large_case(a_case, engines, Calls::few);
        ASSERT_FALSE(finding) << finding->check << ": " << finding->text;
    }
}

/// Fingerprint of a set of pairs that does not depend on their order: the number of pairs and the sum of their hashes.
struct SetOfPairs {
    std::uint64_t count = 0, sum = 0;
    bool operator==(const SetOfPairs&) const = default;

    void add(std::uint32_t a, std::uint32_t b) {
        ++count;
        sum += samples::mix_bits(std::uint64_t(std::min(a, b)) << 32 | std::max(a, b));
    }
};

/// Returns the pairs of boxes, renamed by `names`. `offset`: added to b in a join.
template <typename Find>
SetOfPairs pairs_of(const std::vector<std::uint32_t>& names, std::uint32_t offset, Find&& find) {
    SetOfPairs pairs;
    find([&](std::span<const Pair> batch) {
        for (const Pair& pair : batch) pairs.add(names[pair.a], names[pair.b + offset]);
    });
    return pairs;
}

class Metamorphic : public ::testing::TestWithParam<std::string> {
protected:
    static constexpr std::uint64_t objects = scaled(1'000'000, 50);

    Metamorphic() : boxes_(objects), names_(objects) {
        std::iota(names_.begin(), names_.end(), 0u);
        // Use the first scene of the family that is a single set of float32 boxes with few pairs.
        for (std::uint64_t seed = 1;; ++seed) {
            Case a_case = make_family_case(GetParam(), objects, seed);
            if (a_case.second || a_case.first.boxes.index() != 0) continue;
            boxes_ = std::get<std::vector<Box3f>>(std::move(a_case.first.boxes));
            names_.resize(boxes_.size());
            std::iota(names_.begin(), names_.end(), 0u);
            Options few{.limit = 30 * boxes_.size()};
            if (engine_->count_pairs({boxes_}, few) < *few.limit) break;
        }
    }

    SetOfPairs pairs_of_all(const std::vector<Box3f>& boxes, const std::vector<std::uint32_t>& names) const {
        return pairs_of(names, 0, [&](const PairSink& sink) {
            (void)engine_->stream_pairs({boxes}, sink, {.order = Order::octal});
        });
    }

    const std::unique_ptr<Engine> engine_ = make_local_engine(2);
    std::vector<Box3f> boxes_;
    std::vector<std::uint32_t> names_;
};

TEST_P(Metamorphic, PermutedMirroredScaledAndCut) {
    const SetOfPairs expected = pairs_of_all(boxes_, names_);
    std::vector<std::uint32_t> order = names_;
    samples::RandomStream random(1, 0);
    for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
    std::vector<Box3f> other(boxes_.size());
    for (std::size_t i = 0; i < order.size(); ++i) other[i] = boxes_[order[i]];
    EXPECT_EQ(pairs_of_all(other, order), expected) << "permuted";

    for (std::size_t i = 0; i < other.size(); ++i) {
        // Mirrored on y, x and z exchanged, and scaled by a quarter: exact in float32, except for denormals.
        const Box3f& box = boxes_[i];
        other[i] = {{box.min[2] / 4, -box.max[1] / 4, box.min[0] / 4},
                    {box.max[2] / 4, -box.min[1] / 4, box.max[0] / 4}};
    }
    EXPECT_EQ(pairs_of_all(other, names_), expected) << "mirrored and scaled";

    const std::size_t half = boxes_.size() / 3;
    const std::span<const Box3f> first = std::span(boxes_).first(half), second = std::span(boxes_).subspan(half);
    const auto part = [&](const auto& find, std::uint32_t offset) { return pairs_of(names_, offset, find); };
    SetOfPairs sum = part([&](const PairSink& sink) { (void)engine_->stream_pairs({first}, sink); }, 0);
    std::vector<std::uint32_t> later(names_.begin() + std::ptrdiff_t(half), names_.end());
    const SetOfPairs within_second =
        pairs_of(later, 0, [&](const PairSink& sink) { (void)engine_->stream_pairs({second}, sink); });
    const SetOfPairs between = part(
        [&](const PairSink& sink) {
            (void)engine_->stream_pairs(Join{Objects{first}, Objects{second}}, sink);
        },
        std::uint32_t(half));
    sum.count += within_second.count + between.count;
    sum.sum += within_second.sum + between.sum;
    EXPECT_EQ(sum, expected) << "cut in two sets";
}

INSTANTIATE_TEST_SUITE_P(Families, Metamorphic, ::testing::Values("long_tail", "nested", "lattice"));

}  // namespace
}  // namespace octopair::test
