// FailingScene: a scene whose calls fail at random before they succeed. After each failure it tests that the call has changed
// nothing.
//
// A call fails because an allocation fails, or because room_for_pairs() refuses memory. Steps and queries are also cancelled: at an
// allocation, or, with test hooks, where they poll for a stop request.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <memory>
#include <optional>
#include <random>
#include <stop_token>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/test_hooks.hpp"
#include "octopair/octopair.hpp"
#include "support/at_allocation.hpp"

namespace octopair::test {

class FailingScene {
public:
    /// Numbers of calls that failed, by their cause.
    struct Failures {
        std::uint64_t allocations = 0, refusals = 0, stops = 0;

        void add(const Failures& other) {
            allocations += other.allocations;
            refusals += other.refusals;
            stops += other.stops;
        }
        /// Tests that calls failed by each cause.
        void expect_each() const {
            EXPECT_GT(allocations, 0U);
            EXPECT_GT(refusals, 0U);
            EXPECT_GT(stops, 0U);
        }
    };

    FailingScene() = default;
    /// `failing`: part of the attempts in which something fails, at most 0.5.
    FailingScene(SceneOptions options, std::uint64_t seed, double failing) : random_(seed), failing_(failing) {
        options.room_for_pairs = [refusal = refusal_](std::uint64_t) {
            if (refusal->left-- == 0) throw Refused{};
        };
        scene_.emplace(options);
    }

    void add(const Objects& objects, std::span<ObjectId> ids, std::span<const Traits> traits = {}) {
        make([&] { scene_->add(objects, ids, traits); });
    }
    void move(std::span<const ObjectId> ids, const Boxes& boxes) {
        make([&] { scene_->move(ids, boxes); });
    }
    void sweep(std::span<const ObjectId> ids, const Boxes& boxes) {
        make([&] { scene_->sweep(ids, boxes); });
    }
    void remove(std::span<const ObjectId> ids) {
        make([&] { scene_->remove(ids); });
    }
    void set_traits(std::span<const ObjectId> ids, std::span<const Traits> traits) {
        make([&] { scene_->set_traits(ids, traits); });
    }

    const StepResult& step() {
        const auto attempt = [&]() -> const StepResult& { return scene_->step(stop_->get_token()); };
        const StepResult& result = make(attempt, {.stoppable = true, .is_step = true});
        remember(result);
        if (chance(0.2)) {
            const Verification verification = scene_->verify();
            EXPECT_TRUE(verification.done && verification.not_checked.empty());
        }
        return result;
    }
    const StepResult& step(const std::stop_token& stop) { return scene_->step(stop); }
    const PairList& pairs() {
        return make([&]() -> const PairList& { return scene_->pairs(); });
    }
    const PairList& persisting() {
        return make([&]() -> const PairList& { return scene_->persisting(); });
    }
    const PairList& enlarged_pairs() {
        return make([&]() -> const PairList& { return scene_->enlarged_pairs(); });
    }

    /// Queries, with the arguments of Scene.
    template <typename... Arguments>
    auto overlaps(Arguments&&... arguments) {
        cancel_queries();
        return make([&] { return scene_->overlaps(arguments...); });
    }
    auto first_hit(const Ray& ray, std::uint32_t groups) {
        return make([&] { return scene_->first_hit(ray, groups); });
    }
    auto all_hits(const Ray& ray, std::uint32_t groups) {
        return make([&] { return scene_->all_hits(ray, groups); });
    }
    template <typename... Arguments>
    auto nearest(Arguments&&... arguments) {
        cancel_queries();
        return make([&] { return scene_->nearest(arguments...); });
    }

    std::uint64_t size() const { return scene_->size(); }
    std::uint64_t indices() const { return scene_->indices(); }
    bool contains(ObjectId id) const { return scene_->contains(id); }

    const Failures& failures() const { return failures_; }

private:
    struct Refused {};
    /// Number of calls of room_for_pairs() before one is refused; below 0: none is.
    struct Refusal {
        std::int64_t left = -1;
    };
    /// Objects and boxes, which a failed call must not change.
    struct Contents {
        std::uint64_t size, indices;
        std::vector<bool> exists;
        std::vector<double> bounds;  // of the boxes of objects that exist
        bool operator==(const Contents&) const = default;
    };

    bool chance(double part) { return std::uniform_real_distribution<>(0, 1)(random_) < part; }
    /// Returns a number that is often small.
    std::uint64_t some_number() { return random_() % (std::uint64_t(1) << random_() % 8); }

    struct CallKind {
        bool stoppable, is_step;
    };
    /// Makes a call, after attempts that fail. Returns the result of the first attempt that succeeds. The first attempt of the first step is
    /// refused memory for pairs: later steps rarely need more, so chance alone may refuse none.
    template <typename Call>
    std::invoke_result_t<Call> make(Call&& call, CallKind kind = {false, false}) {
        bool refused = kind.is_step && failing_ > 0 && !std::exchange(stepped_, true);
        while (refused || chance(failing_)) {
            const Contents before = contents();
            try {
                if (std::exchange(refused, false)) return disturbed(call, Disturbance::refusal, 0);
                const auto what = Disturbance(random_() % (kind.stoppable ? 4 : 2));
                return disturbed(call, what, some_number());
            } catch (const std::bad_alloc&) {
                ++failures_.allocations;
            } catch (const Refused&) {
                ++failures_.refusals;
            } catch (const Error& error) {
                const bool stopped = error.code() == ErrorCode::cancelled;
                EXPECT_TRUE(stopped || error.code() == ErrorCode::resource_limit) << error.what();
                ++(stopped ? failures_.stops : failures_.allocations);
            }
            EXPECT_TRUE(before == contents());
            if (chance(0.3)) {
                EXPECT_EQ(scene_->pairs().to_vector(), pairs_);
            }
        }
        return call();
    }

    /// Makes queries with a stop token, which may be cancelled while the scene builds their octree.
    void cancel_queries() {
        const std::vector<Box3d> places(3, Box3d{{0, 0, 0}, {0, 0, 0}});
        Answers<Neighbor> answers;
        const auto ask = [&] {
            scene_->nearest(places, NearestLimits{1}, answers, Scene::all_groups, stop_->get_token());
        };
        make(ask, {.stoppable = true, .is_step = false});
    }

    enum class Disturbance : std::uint8_t { allocation, refusal, stop_at_allocation, stop_at_poll };

    /// Makes a call in which something may fail, after about `number` things that do not.
    template <typename Call>
    std::invoke_result_t<Call> disturbed(Call& call, Disturbance what, std::uint64_t number) {
        struct Ending {
            FailingScene& scene;
            ~Ending() { scene.end_disturbance(); }
        } const ending{*this};
        std::optional<AtAllocation> at_allocation;
        if (what == Disturbance::allocation) {
            at_allocation.emplace(number, fail_allocation);
        } else if (what == Disturbance::refusal) {
            refusal_->left = std::int64_t(number % 3);
        } else if (what == Disturbance::stop_at_allocation) {
            at_allocation.emplace(number, [this] { stop_->request_stop(); });
        } else {
#ifdef OCTOPAIR_TEST_HOOKS
            test_hooks().polls_before_stop = std::int64_t(number);
#endif
        }
        return call();
    }
    void end_disturbance() {
        refusal_->left = -1;
        if (stop_->stop_requested()) *stop_ = std::stop_source();
#ifdef OCTOPAIR_TEST_HOOKS
        test_hooks().polls_before_stop = never_stopped;
#endif
    }

    Contents contents() const {
        Contents all{scene_->size(), scene_->indices(), {}, {}};
        std::visit(
            [&](const auto boxes) {
                for (std::uint32_t index = 0; index < all.indices; ++index) {
                    all.exists.push_back(scene_->exists(index));
                    if (!all.exists.back()) continue;
                    all.bounds.insert(all.bounds.end(), std::begin(boxes[index].min), std::end(boxes[index].min));
                    all.bounds.insert(all.bounds.end(), std::begin(boxes[index].max), std::end(boxes[index].max));
                }
            },
            scene_->boxes());
        return all;
    }

    void remember(const StepResult& step) {
        std::vector<Pair> kept, now;
        std::ranges::set_difference(pairs_, step.ended, std::back_inserter(kept));
        std::ranges::set_union(kept, step.began, std::back_inserter(now));
        pairs_ = std::move(now);
    }

    std::mt19937_64 random_;
    double failing_ = 0;
    std::shared_ptr<Refusal> refusal_ = std::make_shared<Refusal>();
    std::unique_ptr<std::stop_source> stop_ = std::make_unique<std::stop_source>();
    std::optional<Scene> scene_;
    std::vector<Pair> pairs_;  // of the last step
    Failures failures_;
    bool stepped_ = false;
};

}  // namespace octopair::test
