// Tests a server that is killed, stopped, or loses its workers while clients upload, wait and read. Every client gets
// the right pairs, each pair once.
#include <gtest/gtest.h>
#include <signal.h>

#include <atomic>
#include <thread>

#include "processes/leftovers.hpp"
#include "service/metrics_page.hpp"
#include "service/served.hpp"
#include "service/server_program.hpp"
#include "support/calls.hpp"
#include "support/compare.hpp"
#include "support/kinds.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

using std::chrono::milliseconds;
using std::chrono::minutes;

std::unique_ptr<Engine> client_of(const ServerProgram& server) {
    return connect(server.address(), {.patience = minutes(2)});
}

std::vector<Pair> right_pairs(const std::vector<Box3f>& boxes) { return listed_pairs(*make_local_engine(2), {boxes}); }

/// A streamed job whose sink waits when `hold_from` pairs have arrived.
class StreamedJob {
public:
    StreamedJob(const ServerProgram& server, const std::vector<Box3f>& boxes, std::uint64_t hold_from)
        : hold_from_(hold_from), engine_(client_of(server)) {
        job_ = engine_->submit_stream(boxes, [this](std::span<const Pair> pairs) {
            pairs_.insert(pairs_.end(), pairs.begin(), pairs.end());
            if (pairs_.size() < hold_from_) return;
            holding_ = true;
            while (pairs_.size() >= hold_from_) std::this_thread::sleep_for(milliseconds(2));
            holding_ = false;
        });
    }
    bool wait_until_held() {
        return comes_true([&] { return holding_ || job_.wait_for(milliseconds(0)); }, minutes(2)) && holding_;
    }
    /// Continues until `hold_from` pairs have arrived.
    void go_on(std::uint64_t hold_from) { hold_from_ = hold_from; }
    JobState state() const { return job_.state(); }
    std::vector<Pair> take() {
        go_on(~std::uint64_t(0));
        const Summary summary = job_.summary();
        EXPECT_EQ(summary.pairs, pairs_.size());
        return pairs_;
    }

private:
    std::atomic<std::uint64_t> hold_from_;
    std::atomic<bool> holding_ = false;
    std::vector<Pair> pairs_;
    std::unique_ptr<Engine> engine_;
    Job job_;
};

class ServerFaults : public ::testing::Test {
protected:
    const std::vector<Box3f> crowd_ = std::vector<Box3f>(2500);  // 25 MB of pairs
    const std::vector<Box3f> large_ = make_boxes("uniform", scaled(400'000, 4), 1);
    const std::vector<Box3f> small_ = make_boxes("clustered", 3000, 1);
    const std::vector<Pair> crowd_pairs_ = right_pairs(crowd_), large_pairs_ = right_pairs(large_),
                            small_pairs_ = right_pairs(small_);
};

TEST_F(ServerFaults, KillsWhileClientsUploadRunAndStream) {
    ServerProgram server;
    const std::vector<Box3f> heap(scaled(80'000, 8));  // takes long to count
    const std::uint64_t heap_pairs = heap.size() * (heap.size() - 1) / 2;
    const auto uploader = client_of(server), runner = client_of(server), other = client_of(server);
    for (int round = 0; round < 3; ++round) {
        SCOPED_TRACE(round);
        StreamedJob streaming(server, crowd_, 1);
        ASSERT_TRUE(streaming.wait_until_held());
        Job running = runner->submit_stream(heap, {});
        ASSERT_TRUE(comes_true([&] { return running.state() == JobState::running; }, minutes(1)));
        std::this_thread::sleep_for(milliseconds(100));
        server.signal(SIGSTOP);
        // The server accepts no more of this upload than fits into the socket.
        Job uploading = uploader->submit(large_);
        Job asking = other->submit(small_);
        std::this_thread::sleep_for(milliseconds(100));
        EXPECT_EQ(streaming.state(), JobState::running);
        EXPECT_EQ(running.state(), JobState::running);
        EXPECT_EQ(uploading.state(), JobState::running);
        server.kill_and_restart();
        EXPECT_TRUE(same_bytes(streaming.take(), crowd_pairs_));
        EXPECT_EQ(running.summary().pairs, heap_pairs);
        EXPECT_TRUE(same_bytes(uploading.take_pairs().to_vector(), large_pairs_));
        EXPECT_TRUE(same_bytes(asking.take_pairs().to_vector(), small_pairs_));
    }
}

TEST_F(ServerFaults, KillsOfOneStreamAgainAndAgain) {
    ServerProgram server;
    const std::uint64_t all = crowd_pairs_.size();
    StreamedJob streaming(server, crowd_, 1);
    for (const std::uint64_t next : {all / 4, all / 2, all}) {
        ASSERT_TRUE(streaming.wait_until_held());
        server.kill_and_restart();
        streaming.go_on(next);
    }
    EXPECT_TRUE(same_bytes(streaming.take(), crowd_pairs_));
}

TEST_F(ServerFaults, KillsAtAnyMoment) {
    ServerProgram server;
    std::atomic<bool> over = false;
    std::vector<std::jthread> clients;
    for (int i = 0; i < 4; ++i) {
        clients.emplace_back([&, i] {
            const auto engine = client_of(server);
            const auto& boxes = i == 0 ? crowd_ : i == 1 ? large_ : small_;
            const auto& pairs = i == 0 ? crowd_pairs_ : i == 1 ? large_pairs_ : small_pairs_;
            for (int n = 0; n < 3 || !over; ++n) {
                std::vector<Pair> found;
                const PairSink sink = [&](auto batch) { found.insert(found.end(), batch.begin(), batch.end()); };
                EXPECT_EQ(engine->stream_pairs({boxes}, sink).pairs, pairs.size());
                EXPECT_TRUE(same_bytes(found, pairs));
            }
        });
    }
    for (const int pause : {150, 400, 90, 700}) {
        std::this_thread::sleep_for(milliseconds(pause));
        server.kill_and_restart();
    }
    over = true;
}

TEST_F(ServerFaults, AStopThatEnds) {
    ServerProgram server;
    StreamedJob streaming(server, crowd_, 1);
    ASSERT_TRUE(streaming.wait_until_held());
    const auto engine = client_of(server);
    server.signal(SIGSTOP);
    Job job = engine->submit(large_);
    streaming.go_on(~std::uint64_t(0));
    std::this_thread::sleep_for(std::chrono::seconds(1));
    EXPECT_EQ(job.state(), JobState::running);
    EXPECT_EQ(streaming.state(), JobState::running);
    server.signal(SIGCONT);
    EXPECT_TRUE(same_bytes(job.take_pairs().to_vector(), large_pairs_));
    EXPECT_TRUE(same_bytes(streaming.take(), crowd_pairs_));
}

TEST_F(ServerFaults, OfItsWorkersAreMadeGood) {
    ServerProgram server({.arguments = "--engine processes --workers 2 --metrics localhost:0"});
    check_serves(server.address());
    const auto faults = [&] {
        const std::string page = metrics_page(server.log()), name = "\noctopair_worker_faults_total ";
        const std::size_t found = page.find(name);
        return found == std::string::npos ? -1 : std::stoi(page.substr(found + name.size()));
    };
    EXPECT_EQ(faults(), 0);
    const auto engine = client_of(server);
    const auto expect_right = [&](const std::vector<Box3f>& boxes, const std::vector<Pair>& pairs) {
        EXPECT_TRUE(same_bytes(listed_pairs(*engine, {boxes}), pairs));
    };
    const auto begin = std::chrono::steady_clock::now();
    expect_right(large_, large_pairs_);
    const auto whole = std::chrono::steady_clock::now() - begin;
    // Kills one worker per job, at several moments. With many kills per job, a busy machine might end no attempt
    // between two kills, and the job would fail.
    for (int i = 0; i < 8 || (faults() < 1 && i < 1000); ++i) {
        const std::jthread killer([&] {
            std::this_thread::sleep_for(whole * (i % 4 + 1) / 5);
            const auto workers = children_of(server.id());
            if (!workers.empty()) (void)::kill(workers[std::size_t(i) % workers.size()], SIGKILL);
        });
        expect_right(large_, large_pairs_);
        expect_right(small_, small_pairs_);
    }
    EXPECT_TRUE(server.lives());
    EXPECT_GE(faults(), 1);
}

}  // namespace
}  // namespace octopair::test
