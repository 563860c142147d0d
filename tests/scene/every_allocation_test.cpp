// Tests that each call of a scene may run out of memory at each of its allocations. After the failure the scene is as before the call,
// and all later results are those of a scene without failures.
#include <gtest/gtest.h>

#include <functional>
#include <optional>
#include <random>
#include <tuple>
#include <vector>

#include "octopair/octopair.hpp"
#include "support/at_allocation.hpp"

namespace octopair::test {
namespace {

/// A scene, and all results that it has returned.
struct Observed {
    std::optional<Scene> scene;
    std::vector<ObjectId> ids;
    std::vector<std::vector<Pair>> pairs;
    std::vector<std::vector<std::uint32_t>> answers;

    void see(std::span<const Pair> list) {
        const AtAllocation::Paused paused;
        pairs.emplace_back(list.begin(), list.end());
    }
    void see(const PairList& list) {
        const AtAllocation::Paused paused;
        pairs.push_back(list.to_vector());
    }
    /// Sees the indices of answers to a query.
    template <typename Answers, typename Index>
    void see(const Answers& all, Index&& index_of) {
        const AtAllocation::Paused paused;
        std::vector<std::uint32_t> indices;
        for (const auto& one : all) indices.push_back(index_of(one));
        answers.push_back(std::move(indices));
    }
};

class EveryAllocation : public ::testing::TestWithParam<std::tuple<unsigned, double>> {
protected:
    using Call = std::function<void(Observed&)>;
    static constexpr std::size_t first_objects = 160, more_objects = 20;

    std::vector<Box3d> some_boxes(std::size_t count) {
        std::vector<Box3d> boxes(count);
        std::uniform_real_distribution<> place(0, 8);
        for (Box3d& box : boxes) {
            for (int axis = 0; axis < 3; ++axis) box.max[axis] = (box.min[axis] = place(random_)) + 1;
        }
        return boxes;
    }

    void append_add(std::size_t count, std::vector<double> padding, std::vector<Traits> traits) {
        calls_.emplace_back([boxes = some_boxes(count), padding, traits](Observed& observed) {
            std::vector<ObjectId> ids(boxes.size());
            observed.scene->add({boxes, padding}, ids, traits);
            const AtAllocation::Paused paused;
            observed.ids.insert(observed.ids.end(), ids.begin(), ids.end());
        });
    }
    void append_move(std::size_t first, std::size_t count, bool swept) {
        calls_.emplace_back([=, boxes = some_boxes(count)](Observed& observed) {
            const auto ids = std::span(observed.ids).subspan(first, count);
            swept ? observed.scene->sweep(ids, std::span<const Box3d>(boxes))
                  : observed.scene->move(ids, std::span<const Box3d>(boxes));
        });
    }
    void append_remove(std::size_t first, std::size_t count) {
        calls_.emplace_back([=](Observed& observed) {
            observed.scene->remove(std::span(observed.ids).subspan(first, count));
            const auto begin = observed.ids.begin() + std::ptrdiff_t(first);
            observed.ids.erase(begin, begin + std::ptrdiff_t(count));
        });
    }
    void append_set_traits(std::size_t first, std::size_t count) {
        calls_.emplace_back([=](Observed& observed) {
            observed.scene->set_traits(std::span(observed.ids).subspan(first, count),
                                       std::vector<Traits>{{2, 3, true}});
        });
    }
    void append_step() {
        calls_.emplace_back([](Observed& observed) {
            const StepResult& step = observed.scene->step();
            observed.see(step.began);
            observed.see(step.ended);
        });
    }
    void append_lists() {
        calls_.emplace_back([](Observed& observed) { observed.see(observed.scene->pairs()); });
        calls_.emplace_back([](Observed& observed) { observed.see(observed.scene->persisting()); });
    }
    void append_queries() {
        const Box3d box = some_boxes(1)[0];
        calls_.emplace_back([=](Observed& observed) { observed.see(observed.scene->overlaps(box), std::identity()); });
        calls_.emplace_back([=](Observed& observed) {
            observed.see(observed.scene->all_hits(Ray{{0, 0, 0}, {1, 1, 1}}),
                         [](const RayHit& hit) { return hit.index; });
        });
        calls_.emplace_back([=](Observed& observed) {
            observed.see(observed.scene->nearest(box, 5), [](const Neighbor& neighbor) { return neighbor.index; });
        });
    }

    EveryAllocation() {
        append_add(first_objects, {}, {});
        append_step();
        append_lists();
        append_queries();
        append_move(3, 3, false);
        append_queries();
        append_step();
        append_add(more_objects, std::vector<double>(more_objects, 0.25), {{1, 3, false}});
        append_move(9, 2, true);
        append_remove(20, 5);
        append_queries();
        append_step();
        append_lists();
        append_step();
        append_set_traits(30, 4);
        append_add(more_objects, {}, {});
        append_step();
        append_queries();
        append_move(0, first_objects, false);
        append_step();
        append_lists();
        calls_.emplace_back(
            [](Observed& observed) { EXPECT_GT(observed.scene->octants().home_octants().size(), first_objects); });
    }

    Observed make_scene() const {
        SceneOptions options{.threads = std::get<0>(GetParam()), .precision = Precision::float64};
        options.slack = std::get<1>(GetParam());
        Observed observed;
        observed.scene.emplace(options);
        return observed;
    }

    std::mt19937 random_{1};
    std::vector<Call> calls_;
};

TEST_P(EveryAllocation, OfASceneMayFail) {
    Observed expected = make_scene();
    for (const Call& call : calls_) call(expected);
    std::uint64_t failures = 0;
    for (std::size_t failing = 0; failing < calls_.size() && !HasFailure(); ++failing) {
        SCOPED_TRACE("call " + std::to_string(failing));
        failures += fail_every_allocation(
            [&] {
                Observed observed = make_scene();
                for (std::size_t i = 0; i < failing; ++i) calls_[i](observed);
                return observed;
            },
            calls_[failing],
            [&](Observed& observed, bool failed) {
                // What the failed call has left behind must suffice for a query. Octants read all arrays of the scene.
                if (failed) {
                    EXPECT_EQ(observed.scene->octants().home_octants().size(), observed.scene->indices());
                }
                if (failed) (void)observed.scene->overlaps(Box3d{{0, 0, 0}, {9, 9, 9}});
                for (std::size_t i = failing + (failed ? 0 : 1); i < calls_.size(); ++i) calls_[i](observed);
                EXPECT_EQ(observed.pairs, expected.pairs);
                EXPECT_EQ(observed.answers, expected.answers);
            });
    }
    EXPECT_GT(failures, 10 * calls_.size());
}

TEST(EveryAllocationOfAScene, MayFailWhenTheSceneIsMade) {
    fail_every_allocation([] { return std::optional<Scene>(); }, [](auto& scene) { scene.emplace(SceneOptions{2}); },
                          [](auto& scene, bool failed) { EXPECT_EQ(scene.has_value(), !failed); });
}

INSTANTIATE_TEST_SUITE_P(, EveryAllocation,
                         ::testing::Values(std::tuple(1u, 0.0), std::tuple(2u, 0.0), std::tuple(2u, 0.25)));

}  // namespace
}  // namespace octopair::test
