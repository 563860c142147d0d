// Tests `octopair serve` killed repeatedly while jobs are queued, running and streamed. Every result is right and
// complete, without repetitions.
#include <csignal>

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <thread>

#include "base/test_hooks.hpp"
#include "service/detached/detached_server.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

class ServeProgram {
public:
    ServeProgram() { start(); }
    ServeProgram(const ServeProgram&) = delete;
    ServeProgram& operator=(const ServeProgram&) = delete;
    ~ServeProgram() { kill(); }

    std::string address() const { return "unix:" + folder_.file("socket"); }

    void start() {
        std::string program = OCTOPAIR_PROGRAM, verb = "serve", listen = "--listen=" + address(),
                    state = "--state=" + folder_.file("state"), threads = "--threads=2";
        char* const words[] = {program.data(), verb.data(), listen.data(), state.data(), threads.data(), nullptr};
        ASSERT_EQ(::posix_spawn(&id_, program.c_str(), nullptr, nullptr, words, environ), 0);
    }

    void kill() {
        ::kill(id_, SIGKILL);
        (void)::waitpid(id_, nullptr, 0);
    }

private:
    TemporaryDirectory folder_;
    pid_t id_ = 0;
};

/// A receiver that pauses in the middle of its input, once for every kill.
class SlowReader {
public:
    void take(std::span<const Pair> pairs) {
        pairs_.insert(pairs_.end(), pairs.begin(), pairs.end());
        const int stop = stops_++;
        while (stop < kills && kills_ <= stop) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    /// Returns whether the reader waits for the next kill.
    bool waits() const { return stops_ > kills_; }
    void killed() { ++kills_; }
    const std::vector<Pair>& pairs() const { return pairs_; }

    static constexpr int kills = 3;

private:
    std::vector<Pair> pairs_;
    std::atomic<int> stops_ = 0, kills_ = 0;
};

TEST(Killed, LosesAndRepeatsNothing) {
    ServeProgram server;
    JobClient client(server.address(), {.patience = std::chrono::minutes(2)});
    const std::vector<Box3f> heap(scaled(4000, 2));  // 64 MB of pairs
    // Counting takes seconds. Builds with test hooks check each counted pair, so their crowd is smaller.
    const std::vector<Box3f> crowd(has_test_hooks ? scaled(50'000, 2) : 150'000);
    const std::vector<Box3f> scene = make_boxes("dense", scaled(400'000, 10), 1);
    const Work of_heap(Objects{heap}), of_scene(Objects{scene});
    const std::string streamed = submit(client, of_heap);
    expect_done(client, streamed);
    const std::string running = client.submit({crowd}, {}, {.count_only = true});
    const std::string queued = submit(client, of_scene);
    SlowReader reader;
    std::thread reading([&] { client.result(streamed, [&](std::span<const Pair> pairs) { reader.take(pairs); }); });
    for (int round = 0; round < SlowReader::kills; ++round) {
        EXPECT_TRUE(comes_true([&] {
            return reader.waits() && client.status(running).state == JobState::running &&
                   client.status(queued).state == JobState::queued;
        })) << round;
        server.kill();
        reader.killed();
        server.start();
    }
    reading.join();
    EXPECT_TRUE(same_bytes(reader.pairs(), pairs_here(of_heap)));
    expect_result(client, streamed, of_heap);
    const JobStatus counted = client.wait(running, std::chrono::minutes(5));
    EXPECT_EQ(counted.summary.pairs, std::uint64_t(crowd.size()) * (crowd.size() - 1) / 2);
    expect_result(client, queued, of_scene);
    EXPECT_EQ(client.list().size(), 3u);
}

TEST(Killed, WhileAJobIsSubmittedTakesItOnce) {
    ServeProgram server;
    JobClient client(server.address(), {.patience = std::chrono::minutes(2)});
    const auto boxes = make_boxes("uniform", scaled(1000000, 10), 1);
    Work work(Objects{boxes});
    work.terms.id = some_id;
    int rounds = 3;
    work.options.progress = [&](double done) {
        if (done < 0.4 || rounds == 0) return;
        --rounds;
        server.kill();
        server.start();
    };
    EXPECT_EQ(submit(client, work), some_id);
    EXPECT_EQ(rounds, 0);
    EXPECT_EQ(client.list().size(), 1u);
    work.options.progress = {};
    expect_result(client, some_id, work);
}

}  // namespace
}  // namespace octopair::test
