// Tests that watchers of a scene receive its boxes and pairs, and that they neither delay nor change the scene.
#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>
#include <grpcpp/create_channel.h>
#include <grpcpp/security/credentials.h>
#include <grpcpp/security/server_credentials.h>
#include <grpcpp/server.h>
#include <grpcpp/server_builder.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <future>
#include <thread>
#include <utility>

#include "io/temporary.hpp"
#include "octopair/client.hpp"
#include "octopair/scene_watcher.hpp"
#include "service/protocol/octopair.grpc.pb.h"
#include "service/scenes/scene_server.hpp"
#include "support/kinds.hpp"

namespace octopair::test {
namespace {

using namespace std::chrono_literals;

constexpr std::uint64_t all_pairs = 1'000'000;

template <typename Real>
std::vector<ObjectId> add_to(RemoteScene& scene, const std::vector<Box<Real>>& boxes) {
    std::vector<ObjectId> ids(boxes.size());
    scene.add(Objects{boxes}, ids);
    return ids;
}

class SceneWatching : public ::testing::Test {
protected:
    SceneWatcher watcher() const { return SceneWatcher(server_.address()); }
    std::string only_id() const {
        SceneWatcher watcher(server_.address());
        std::vector<SceneStatus> list;
        EXPECT_TRUE(comes_true([&] { return (list = watcher.list()).size() == 1; }));
        return list.empty() ? "" : list[0].id;
    }

    SceneServer server_;
};

/// Expects that a snapshot has the pairs of `scene`, and `boxes` at the indices of `ids`.
template <typename Real>
void expect_state(const SceneSnapshot& snapshot, RemoteScene& scene, std::span<const ObjectId> ids,
                  const std::vector<Box<Real>>& boxes) {
    ASSERT_TRUE(std::holds_alternative<std::vector<Box<Real>>>(snapshot.boxes));
    const auto& found = std::get<std::vector<Box<Real>>>(snapshot.boxes);
    ASSERT_EQ(found.size(), scene.indices());
    ASSERT_EQ(snapshot.exists.size(), scene.indices());
    EXPECT_EQ(std::count(snapshot.exists.begin(), snapshot.exists.end(), true), std::ptrdiff_t(scene.size()));
    for (std::size_t i = 0; i < ids.size(); ++i) {
        if (!scene.contains(ids[i])) continue;
        EXPECT_TRUE(snapshot.exists[ids[i].index]);
        EXPECT_EQ(std::memcmp(&found[ids[i].index], &boxes[i], sizeof boxes[i]), 0) << "object " << i;
    }
    EXPECT_EQ(snapshot.pairs, scene.pairs().size());
    EXPECT_EQ(snapshot.listed, scene.pairs().to_vector());
}

TEST_F(SceneWatching, AListHasTheRunningScenes) {
    SceneWatcher watcher(server_.address());
    EXPECT_TRUE(watcher.list().empty());
    RemoteScene scene = server_.scene({Precision::float64, 0.5});
    const auto ids = add_to(scene, make_double_boxes("uniform", 200, 1));
    (void)scene.step();
    scene.remove(std::span(ids).first(50));
    (void)scene.step();
    const std::vector<SceneStatus> list = watcher.list();
    ASSERT_EQ(list.size(), 1u);
    EXPECT_EQ(list[0].id.size(), 36u);
    EXPECT_EQ(list[0].owner, "") << "this client's own scene";
    EXPECT_EQ(list[0].precision, Precision::float64);
    EXPECT_EQ(list[0].margin, 0.5);
    EXPECT_EQ(list[0].objects, 150u);
    EXPECT_EQ(list[0].pairs, scene.pairs().size());
    EXPECT_EQ(list[0].steps, 2u);
    EXPECT_GT(list[0].step_seconds, 0);
    {
        RemoteScene other = server_.scene();
        (void)other.step();
        EXPECT_EQ(watcher.list().size(), 2u);
    }
    EXPECT_TRUE(comes_true([&] { return watcher.list().size() == 1; })) << "the other scene has ended";
}

TEST_F(SceneWatching, ASnapshotHasTheStateOfAnIdleScene) {
    RemoteScene scene = server_.scene();
    const auto boxes = make_boxes("clustered", 3000, 1);
    const auto ids = add_to(scene, boxes);
    const std::uint64_t began = scene.step().began.size();
    const std::string id = only_id();
    SceneWatcher watcher(server_.address());
    auto snapshot = watcher.next(id, 0, 60s, all_pairs);
    ASSERT_TRUE(snapshot);
    EXPECT_EQ(snapshot->step, 1u);
    EXPECT_EQ(snapshot->began, began);
    EXPECT_GT(snapshot->step_seconds, 0);
    EXPECT_GT(snapshot->pairs, 0u);
    expect_state(*snapshot, scene, ids, boxes);

    scene.remove(std::span(ids).first(1000));
    const std::uint64_t ended = scene.step().ended.size();
    snapshot = watcher.next(id, 1, 60s, all_pairs);
    ASSERT_TRUE(snapshot);
    EXPECT_EQ(snapshot->step, 2u);
    EXPECT_EQ(snapshot->ended, ended);
    EXPECT_FALSE(snapshot->exists[ids[0].index]);
    expect_state(*snapshot, scene, ids, boxes);
}

TEST_F(SceneWatching, Float64AndManyMessages) {
    RemoteScene scene = server_.scene({Precision::float64, 0});
    auto boxes = make_double_boxes("uniform", 60'001, 1);  // 2.9 MB of boxes
    const auto ids = add_to(scene, boxes);
    (void)scene.step();
    for (Box3d& box : boxes) {
        for (int axis = 0; axis < 3; ++axis) box.min[axis] -= 1e-9, box.max[axis] += 1e-9;
    }
    scene.sweep(ids, Boxes(std::span<const Box3d>(boxes)));
    (void)scene.step();
    SceneWatcher watcher(server_.address());
    const auto snapshot = watcher.next(only_id(), 1, 60s, all_pairs);
    ASSERT_TRUE(snapshot);
    EXPECT_EQ(snapshot->step, 2u);
    expect_state(*snapshot, scene, ids, boxes);
}

TEST_F(SceneWatching, ASnapshotListsAtMostSoManyPairs) {
    RemoteScene scene = server_.scene();
    (void)add_to(scene, std::vector<Box3f>(50, {{0, 0, 0}, {1, 1, 1}}));
    (void)scene.step();
    const std::string id = only_id();
    SceneWatcher watcher(server_.address());
    const std::vector<Pair> pairs = scene.pairs().to_vector();
    for (const std::size_t limit : {0u, 1u, 100u, 1225u, 2000u}) {
        const auto snapshot = watcher.next(id, 0, 60s, limit);
        ASSERT_TRUE(snapshot);
        EXPECT_EQ(snapshot->pairs, 1225u);
        const auto end = pairs.begin() + std::ptrdiff_t(std::min<std::size_t>(limit, 1225));
        EXPECT_EQ(snapshot->listed, std::vector(pairs.begin(), end));
    }
}

TEST_F(SceneWatching, AnEmptyScene) {
    RemoteScene scene = server_.scene();
    (void)scene.step();
    const auto snapshot = watcher().next(only_id(), 0, 60s, all_pairs);
    ASSERT_TRUE(snapshot);
    EXPECT_EQ(snapshot->exists.size(), 0u);
    EXPECT_EQ(snapshot->pairs, 0u);
}

TEST_F(SceneWatching, ThereIsNoNewerStep) {
    RemoteScene scene = server_.scene();
    (void)add_to(scene, make_boxes("uniform", 100, 1));
    (void)scene.step();
    const std::string id = only_id();
    SceneWatcher watcher(server_.address());
    const auto begin = std::chrono::steady_clock::now();
    EXPECT_FALSE(watcher.next(id, 1, 300ms, 0));
    EXPECT_GE(std::chrono::steady_clock::now() - begin, 300ms);
    EXPECT_FALSE(watcher.next(id, 1, 0ms, 0));
    EXPECT_FALSE(watcher.next(id, ~std::uint64_t(0), 0ms, 0));
    EXPECT_TRUE(watcher.next(id, 0, 60s, 0)) << "a watcher that left does not stop others";
}

TEST_F(SceneWatching, AWatcherWaitsForTheNextStep) {
    RemoteScene scene = server_.scene();
    const auto boxes = make_boxes("uniform", 100, 1);
    const auto ids = add_to(scene, boxes);
    (void)scene.step();
    const std::string id = only_id();
    std::optional<SceneSnapshot> snapshot;
    std::jthread thread([&] { snapshot = watcher().next(id, 1, 60s, all_pairs); });
    std::this_thread::sleep_for(50ms);
    scene.remove(std::span(ids).last(10));
    (void)scene.step();
    thread.join();
    ASSERT_TRUE(snapshot);
    EXPECT_EQ(snapshot->step, 2u);
    expect_state(*snapshot, scene, ids, boxes);
}

TEST_F(SceneWatching, UnknownAndEndedScenes) {
    SceneWatcher watcher(server_.address());
    const std::string unknown = "01234567-89ab-4def-8123-456789abcdef";
    const auto refusal = [&](const std::string& id) {
        return error_of(ErrorCode::bad_input, [&] { (void)watcher.next(id, 0, 60s, 0); });
    };
    EXPECT_EQ(refusal(unknown), "there is no scene " + unknown);
    EXPECT_EQ(refusal(""), "there is no scene ");
    EXPECT_EQ(refusal(std::string(1000, 'x')), "there is no scene " + std::string(36, 'x'));
    std::string id, answer;
    std::jthread thread;
    {
        RemoteScene scene = server_.scene();
        (void)scene.step();
        id = only_id();
        thread = std::jthread([&] {
            answer = error_of(ErrorCode::bad_input, [&] { (void)SceneWatcher(server_.address()).next(id, 1, 60s, 0); });
        });
        std::this_thread::sleep_for(50ms);
    }
    thread.join();
    EXPECT_EQ(answer, "there is no scene " + id) << "the scene ended while the watcher waited";
    EXPECT_EQ(refusal(id), "there is no scene " + id);
}

TEST_F(SceneWatching, AStopRequestEndsAWait) {
    RemoteScene scene = server_.scene();
    (void)scene.step();
    const std::string id = only_id();
    std::stop_source stop;
    std::jthread stopper([&] {
        std::this_thread::sleep_for(50ms);
        stop.request_stop();
    });
    (void)error_of(ErrorCode::cancelled, [&] { (void)watcher().next(id, 1, 600s, 0, stop.get_token()); });
}

/// A call that watches a scene, with a connection of its own, and never reads the answer.
class UnreadWatch {
public:
    UnreadWatch(const std::string& address, const std::string& id, std::uint64_t after_step)
        : calls_(v1::Octopair::NewStub(grpc::CreateChannel(address, grpc::InsecureChannelCredentials()))) {
        v1::WatchSceneRequest request;
        request.set_id(id);
        request.set_after_step(after_step);
        request.set_seconds(60);
        reader_ = calls_->WatchScene(&context_, request);
    }
    UnreadWatch(const UnreadWatch&) = delete;
    UnreadWatch& operator=(const UnreadWatch&) = delete;
    ~UnreadWatch() {
        context_.TryCancel();
        (void)reader_->Finish();
    }

    /// Waits until the server starts to send its answer.
    void wait_for_answer() { reader_->WaitForInitialMetadata(); }

private:
    grpc::ClientContext context_;
    std::unique_ptr<v1::Octopair::Stub> calls_;
    std::unique_ptr<grpc::ClientReader<v1::SceneSnapshot>> reader_;
};

/// Moves a scene's objects until the end of its life, and counts the steps.
class Stepper {
public:
    Stepper(const SceneServer& server, std::vector<Box3f> boxes)
        : boxes_(std::move(boxes)),
          scene_(server.scene()),
          thread_([this](const std::stop_token& stop) { run(stop); }) {}

    std::uint64_t steps() const { return steps_; }

private:
    void run(const std::stop_token& stop) {
        const std::vector<ObjectId> ids = add_to(scene_, boxes_);
        while (!stop.stop_requested()) {
            const auto& step = scene_.step();
            ++steps_;
            pairs_ = step.pairs();
            for (Box3f& box : boxes_) box.min[0] += 0.25F, box.max[0] += 0.25F;  // all by the same distance
            scene_.move(ids, Boxes(std::span<const Box3f>(boxes_)));
        }
    }

    std::vector<Box3f> boxes_;
    RemoteScene scene_;
    std::atomic<std::uint64_t> steps_ = 0, pairs_ = 0;
    std::jthread thread_;
};

TEST_F(SceneWatching, ManyWatchersOfARunningScene) {
    std::vector<Box3f> boxes;
    for (int i = 0; i < 1000; ++i) boxes.push_back({{0, float(i), 0}, {1, float(i) + 1, 1}});
    Stepper stepper(server_, boxes);
    const std::string id = only_id();
    std::vector<std::jthread> watchers;
    std::atomic<int> seen = 0;
    for (int i = 0; i < 20; ++i) {
        watchers.emplace_back([&] {
            SceneWatcher watcher(server_.address());
            std::uint64_t step = 0;
            for (int round = 0; round < 5; ++round) {
                const auto snapshot = watcher.next(id, step, 60s, all_pairs);
                ASSERT_TRUE(snapshot);
                ASSERT_GT(snapshot->step, step);
                step = snapshot->step;
                EXPECT_EQ(snapshot->pairs, 999u);
                EXPECT_EQ(snapshot->listed.size(), 999u);
                const auto& found = std::get<std::vector<Box3f>>(snapshot->boxes);
                ASSERT_EQ(found.size(), 1000u);
                for (const Box3f& box : found)
                    ASSERT_EQ(box.min[0], 0.25F * float(step - 1)) << "boxes of several steps";
                ++seen;
            }
        });
    }
    watchers.clear();
    EXPECT_EQ(seen, 100);
    const std::uint64_t steps = stepper.steps();
    EXPECT_TRUE(comes_true([&] { return stepper.steps() > steps + 10; }));
}

TEST_F(SceneWatching, WatchersThatDoNotReadKeepNoSceneWaiting) {
    const auto boxes = make_boxes("uniform", 200'000, 1);  // 4.8 MB, more than gRPC sends ahead
    RemoteScene scene = server_.scene();
    const auto ids = add_to(scene, boxes);
    (void)scene.step();
    const std::string id = only_id();
    std::vector<std::unique_ptr<UnreadWatch>> watchers;
    for (std::uint64_t i = 0; i < 20; ++i) {
        watchers.push_back(std::make_unique<UnreadWatch>(server_.address(), id, i));
        scene.move(std::span(ids).first(1), std::span(boxes).subspan(i % 2, 1));
        const StepResult& step = scene.step();
        EXPECT_LT(step.seconds, 30) << "less than the server's time for watchers that do not read";
    }
    watchers.clear();
    EXPECT_TRUE(watcher().next(id, 0, 60s, 0));
}

TEST_F(SceneWatching, AServerStopsDespiteAWatcherThatDoesNotRead) {
    RemoteScene scene = server_.scene();
    (void)add_to(scene, make_boxes("uniform", 200'000, 1));  // 4.8 MB, more than gRPC sends ahead
    (void)scene.step();
    UnreadWatch watch(server_.address(), only_id(), 0);
    watch.wait_for_answer();

    // The server lets this job end before it cancels calls. Until then, the watchdog ends the watch, whose write is in progress.
    std::promise<void> arrived, go_on;
    std::jthread client([&, released = go_on.get_future()] {
        const std::vector<Box3f> same(3000, Box3f{{0, 0, 0}, {1, 1, 1}});
        bool first = true;
        (void)connect(server_.address(), {})->stream_pairs({same}, [&](std::span<const Pair>) {
            if (std::exchange(first, false)) arrived.set_value();
            released.wait();
        });
    });
    arrived.get_future().wait();
    SceneWatcher other(server_.address(), {.patience = 0ms});
    const auto refuses = [&] {
        try {
            (void)other.list();
            return false;
        } catch (const Error&) {
            return true;
        }
    };
    EXPECT_FALSE(refuses());
    std::jthread drain([&] { server_.server().drain(10min); });
    EXPECT_TRUE(comes_true(refuses)) << "the server is going down";
    const std::uint64_t beats = server_.server().beats();
    EXPECT_TRUE(comes_true([&] { return server_.server().beats() >= beats + 2; }))
        << "the watchdog has ended the watch";
    go_on.set_value();
    drain.join();
    server_.go();
}

TEST_F(SceneWatching, AServerThatStopsEndsWaits) {
    RemoteScene scene = server_.scene();
    (void)scene.step();
    const std::string id = only_id();
    std::jthread thread([&] {
        ClientOptions options{.patience = 100ms};
        try {
            (void)SceneWatcher(server_.address(), options).next(id, 1, 600s, 0);
            ADD_FAILURE() << "a snapshot of an ended server";
        } catch (const Error& error) {
            EXPECT_TRUE(error.code() == ErrorCode::engine_failed || error.code() == ErrorCode::bad_input)
                << error.what();
        }
    });
    std::this_thread::sleep_for(50ms);
    server_.server().drain();
    server_.go();
}

TEST(SceneWatchingFaults, AServerWithoutTheCallsIsTooOld) {
    const TemporaryDirectory folder;
    const std::string address = "unix:" + folder.file("socket");
    v1::Octopair::Service service;  // answers UNIMPLEMENTED to all calls
    grpc::ServerBuilder builder;
    builder.AddListeningPort(address, grpc::InsecureServerCredentials());
    builder.RegisterService(&service);
    const auto server = builder.BuildAndStart();
    ASSERT_TRUE(server);
    SceneWatcher watcher(address);
    const std::string refusal = address + ": the server is too old: its version of octopair cannot show scenes";
    EXPECT_EQ(error_of(ErrorCode::usage, [&] { (void)watcher.list(); }), refusal);
    EXPECT_EQ(error_of(ErrorCode::usage, [&] { (void)watcher.next("x", 0, 1s, 0); }), refusal);
}

TEST(SceneWatchingLimits, ACopyThatDoesNotFitIsRefusedAndTheSceneGoesOn) {
    SceneServer server({.memory_bytes = 20'000'000});
    RemoteScene scene = server.scene();
    (void)add_to(scene, make_boxes("uniform", 100'000,
                                   1));  // 4.2 MB and 12 MB; the copy takes 2.4 MB, and as much must stay free
    (void)scene.step();
    SceneWatcher watcher(server.address());
    const std::string id = watcher.list().at(0).id;
    const std::string refusal = error_of(ErrorCode::resource_limit, [&] { (void)watcher.next(id, 0, 60s, 0); });
    EXPECT_TRUE(refusal.starts_with("memory_bytes: the server has 20000000 bytes of memory")) << refusal;
    (void)scene.step();
    EXPECT_EQ(watcher.list().at(0).steps, 2u);
}

TEST(SceneWatchingLimits, MemoryOfSnapshotsIsGivenBack) {
    SceneServer server;
    RemoteScene scene = server.scene();
    (void)add_to(scene, make_boxes("uniform", 10'000, 1));
    (void)scene.step();
    const std::uint64_t before = server.server().load().memory_bytes;
    SceneWatcher watcher(server.address());
    const std::string id = watcher.list().at(0).id;
    for (int i = 0; i < 5; ++i) EXPECT_TRUE(watcher.next(id, 0, 60s, 10));
    EXPECT_TRUE(comes_true([&] { return server.server().load().memory_bytes == before; }));
}

}  // namespace
}  // namespace octopair::test
