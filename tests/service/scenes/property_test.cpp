// Tests remote scenes on random histories. Every call is also made to a local scene. Ids and results must be equal, and
// brute force checks both. Sometimes the server restarts, a step is cancelled, or the memory of a call runs out.
#include <gtest/gtest.h>

#include <random>
#include <thread>

#include "scene/history.hpp"
#include "service/scenes/scene_server.hpp"
#include "support/at_allocation.hpp"
#include "support/cases.hpp"
#include "support/kinds.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

constexpr std::uint64_t histories_per_kind = scaled(10, 5);

/// A local and a remote scene that must stay equal.
class TwinScene {
public:
    TwinScene() = default;
    TwinScene(const SceneOptions& options, SceneServer& server, std::uint64_t seed)
        : server_(&server),
          random_(seed),
          local_(std::in_place, options),
          remote_(server.scene({options.precision, options.margin})) {}

    void add(const Objects& objects, std::span<ObjectId> ids, std::span<const Traits> traits) {
        local_->add(objects, ids, traits);
        std::vector<ObjectId> given(ids.size());
        make([&] { remote_->add(objects, given, traits); });
        EXPECT_EQ(std::vector(ids.begin(), ids.end()), given);
    }
    void move(std::span<const ObjectId> ids, const Boxes& boxes) {
        local_->move(ids, boxes);
        make([&] { remote_->move(ids, boxes); });
    }
    void sweep(std::span<const ObjectId> ids, const Boxes& boxes) {
        local_->sweep(ids, boxes);
        make([&] { remote_->sweep(ids, boxes); });
    }
    void remove(std::span<const ObjectId> ids) {
        local_->remove(ids);
        make([&] { remote_->remove(ids); });
    }
    void set_traits(std::span<const ObjectId> ids, std::span<const Traits> traits) {
        local_->set_traits(ids, traits);
        make([&] { remote_->set_traits(ids, traits); });
    }

    const StepResult& step() {
        const std::uint64_t what = random_() % 12;
        if (what == 0) {
            server_->go();
            server_->come();
        }
        const StepResult& expected = local_->step();
        const StepResult& found = what == 1 ? step_twice() : what > 8 ? step_without_memory() : remote_->step();
        EXPECT_EQ(std::vector(found.began.begin(), found.began.end()),
                  std::vector(expected.began.begin(), expected.began.end()));
        EXPECT_EQ(std::vector(found.ended.begin(), found.ended.end()),
                  std::vector(expected.ended.begin(), expected.ended.end()));
        EXPECT_EQ(found.persisting, expected.persisting);
        EXPECT_EQ(remote_->size(), local_->size());
        EXPECT_EQ(remote_->indices(), local_->indices());
        return found;
    }

    /// Makes a step that was told to stop before it began.
    const StepResult& step(const std::stop_token& stop) {
        EXPECT_THROW((void)local_->step(stop), Error);
        return remote_->step(stop);
    }

    const PairList& pairs() { return remote_->pairs(); }
    const PairList& persisting() { return remote_->persisting(); }
    std::uint64_t size() const { return remote_->size(); }
    std::uint64_t indices() const { return remote_->indices(); }
    bool contains(ObjectId id) const { return remote_->contains(id); }
    /// Returns the number of calls, without steps, that failed in an allocation.
    std::uint64_t failures() const { return failures_; }
    /// Returns the number of steps that failed in an allocation.
    std::uint64_t failed_steps() const { return failed_steps_; }

private:
    /// Makes a call of the remote scene, which does not use the network. Before it succeeds, it may fail in allocations.
    template <typename Call>
    void make(Call&& call) {
        const std::uint64_t size = remote_->size(), indices = remote_->indices();
        while (random_() % 4 == 0) {
            try {
                const AtAllocation failure(random_() % (1u << random_() % 5), fail_allocation,
                                           AtAllocation::Threads::this_one);
                return call();
            } catch (const std::bad_alloc&) {
                ++failures_;
                EXPECT_EQ(remote_->size(), size);
                EXPECT_EQ(remote_->indices(), indices);
            }
        }
        call();
    }

    /// Makes a step and cancels it at a random moment. Repeats the step if it was cancelled.
    const StepResult& step_twice() {
        const std::vector<Pair> before = remote_->pairs().to_vector();
        std::stop_source stop;
        const std::jthread canceller([&, pause = std::chrono::microseconds(random_() % 600)] {
            std::this_thread::sleep_for(pause);
            stop.request_stop();
        });
        try {
            return remote_->step(stop.get_token());
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::cancelled) << error.what();
            EXPECT_EQ(remote_->pairs().to_vector(), before);
        }
        return remote_->step();
    }

    /// Makes a step in which an allocation of this thread fails. Repeats the step if it failed.
    const StepResult& step_without_memory() {
        const std::vector<Pair> before = remote_->pairs().to_vector();
        try {
            const AtAllocation failure(random_() % (1u << random_() % 9), fail_allocation,
                                       AtAllocation::Threads::this_one);
            return remote_->step();
        } catch (const Error& error) {
            ++failed_steps_;
            EXPECT_EQ(error.code(), ErrorCode::resource_limit) << error.what();
            EXPECT_EQ(remote_->pairs().to_vector(), before);
        }
        return remote_->step();
    }

    SceneServer* server_ = nullptr;
    std::mt19937_64 random_;
    std::optional<Scene> local_;
    std::optional<RemoteScene> remote_;
    std::uint64_t failures_ = 0;
    std::uint64_t failed_steps_ = 0;
};

class RemoteSceneProperty : public ::testing::TestWithParam<std::string> {};

TEST_P(RemoteSceneProperty, EveryStepIsThatOfALocalScene) {
    SceneServer server;
    const std::uint64_t count = case_count(histories_per_kind);
    std::uint64_t failures = 0, failed_steps = 0;
    for (std::uint64_t i = 0; i < count; ++i) {
        const std::uint64_t seed = case_seed(GetParam(), i);
        SCOPED_TRACE("OCTOPAIR_TEST_SEED=" + std::to_string(seed));
        History<TwinScene> history(GetParam(), seed,
                                   [&](const SceneOptions& options) { return TwinScene(options, server, seed); });
        history.run();
        if (HasFailure()) return;
        failures += history.scene().failures();
        failed_steps += history.scene().failed_steps();
    }
    // Only some calls lack memory, and not all of these fail. So a few histories may have none that failed.
    EXPECT_TRUE(count < 10 || (failures > 0 && failed_steps > 0));
}

INSTANTIATE_TEST_SUITE_P(Kinds, RemoteSceneProperty, ::testing::ValuesIn(all_kind_names()), param_name);

}  // namespace
}  // namespace octopair::test
