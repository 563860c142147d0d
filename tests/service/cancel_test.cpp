// Tests cancelled calls and clients that disconnect: at each stage the server's job ends and its memory is free again.
#include <gtest/gtest.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>

#include "engine/jobs.hpp"
#include "processes/leftovers.hpp"
#include "service/gate.hpp"
#include "service/raw_call.hpp"
#include "service/served.hpp"
#include "support/kinds.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

using std::chrono::minutes;

/// Puts the engines behind the gate. Sets the stall timeout so long that no stalled call ends.
Served::Change patient(Gate& gate) {
    return [&gate](service::ServerOptions& options) {
        options.engine = gated_engines(gate);
        options.engine_widths = {1, 1, 0};
        options.stall = std::chrono::hours(10);
    };
}

class ServedCancel : public ::testing::Test {
protected:
    /// Cancels a job with `boxes` when `reached` holds. Expects that the job ends and its memory is freed.
    void expect_cancelled(const std::vector<Box3f>& boxes, const std::function<bool()>& reached) {
        const auto engine = served_.client();
        Job job = engine->submit(boxes);
        ASSERT_TRUE(comes_true(reached, minutes(1)));
        job.cancel();
        ASSERT_TRUE(job.wait_for(minutes(1)));
        EXPECT_EQ(job.state(), JobState::cancelled);
        EXPECT_TRUE(served_.comes_to_rest());
    }
    void expect_serves() {
        gate_.open();
        check_serves(served_.address());
    }

    Gate gate_;
    const Served served_{patient(gate_)};
    const std::vector<Box3f> few_ = make_boxes("dense", 100, 1);
    const std::vector<Box3f> many_ = make_boxes("dense", 30'000, 1);
};

TEST_F(ServedCancel, WhileUploading) {
    const std::vector<Box3f> boxes = make_boxes("uniform", scaled(3'000'000, 10), 1);
    expect_cancelled(boxes, [&] { return served_.load().jobs == 1; });
    expect_serves();
}

TEST_F(ServedCancel, WhileQueued) {
    const auto other = served_.client();
    for (const auto& boxes : {few_, many_}) {
        const Job before = other->submit(boxes);
        ASSERT_TRUE(gate_.wait_for(1));
        const auto engine = served_.client();
        Job job = engine->submit(boxes);
        ASSERT_TRUE(comes_true([&] { return served_.load().jobs == 2; }, minutes(1)));
        job.cancel();
        ASSERT_TRUE(job.wait_for(minutes(1)));
        EXPECT_TRUE(comes_true([&] { return served_.load().jobs == 1; }, minutes(1)));
    }
    EXPECT_TRUE(served_.comes_to_rest());
    expect_serves();
}

TEST_F(ServedCancel, WhileRunning) {
    for (const auto& boxes : {few_, many_}) {
        expect_cancelled(boxes, [&] { return gate_.wait_for(1); });
    }
    expect_serves();
}

TEST_F(ServedCancel, WhileStreaming) {
    const std::vector<Box3f> crowd(2000);  // 16 MB of pairs
    gate_.open();
    const auto engine = served_.client();
    std::stop_source stop;
    std::uint64_t received = 0;
    const PairSink sink = [&](std::span<const Pair> pairs) {
        received += pairs.size();
        stop.request_stop();
    };
    const auto call = [&] { (void)engine->stream_pairs({crowd}, sink, {}, stop.get_token()); };
    EXPECT_EQ(code_of(call), ErrorCode::cancelled);
    EXPECT_GT(received, 0u);
    EXPECT_LT(received, std::uint64_t(1999 * 1000));
    EXPECT_TRUE(served_.comes_to_rest());
    expect_serves();
}

TEST_F(ServedCancel, BeforeItBegins) {
    const auto engine = served_.client();
    const auto call = [&] { (void)engine->count_pairs({few_}, {}, requested_stop()); };
    EXPECT_EQ(code_of(call), ErrorCode::cancelled);
    EXPECT_TRUE(served_.comes_to_rest());
}

TEST_F(ServedCancel, OfAnUploadThatStandsStill) {
    const auto channel = open_channel(served_.address());
    const auto spec = spec_of(1000);
    for (const std::uint64_t objects : {0, 1, 999}) {
        RawCall call(channel);
        ASSERT_TRUE(call.write(upload_of(&spec, bytes_of_boxes(objects))));
        // The server takes the slot of a job before its memory, so that one of them does not imply the other.
        ASSERT_TRUE(comes_true([&] { return served_.load().memory_bytes > 0; }, minutes(1)));
        EXPECT_EQ(served_.load().jobs, 1u);
        call.cancel();
        EXPECT_TRUE(served_.comes_to_rest());
    }
    expect_serves();
}

/// `octopair detect` as a client that a test can kill.
class ClientProgram {
public:
    ClientProgram(const std::string& input, const std::string& address) {
        std::string words[] = {OCTOPAIR_PROGRAM,    "detect", input, "--engine", address, "--output",
                               input + ".pairs.npy"};
        std::vector<char*> arguments;
        for (std::string& word : words) arguments.push_back(word.data());
        arguments.push_back(nullptr);
        EXPECT_EQ(::posix_spawn(&id_, OCTOPAIR_PROGRAM, nullptr, nullptr, arguments.data(), environ), 0);
    }
    ~ClientProgram() { kill(); }
    ClientProgram(const ClientProgram&) = delete;
    ClientProgram& operator=(const ClientProgram&) = delete;

    void stop() const { (void)::kill(id_, SIGSTOP); }
    void kill() {
        if (id_ <= 0) return;
        (void)::kill(id_, SIGKILL);
        int status = 0;
        EXPECT_EQ(::waitpid(id_, &status, 0), id_);
        EXPECT_TRUE(WIFSIGNALED(status)) << "the client ended before it was killed";
        id_ = 0;
    }

private:
    pid_t id_ = 0;
};

class ServedKilledClient : public ServedCancel {
protected:
    std::string save(const std::vector<Box3f>& boxes) {
        const std::string path = folder_.file("boxes.npy");
        write_file(path, npy_of(io::NpyType::float32, {boxes.size(), 6}, boxes));
        return path;
    }

    TemporaryDirectory folder_;
};

TEST_F(ServedKilledClient, WhileItUploads) {
    ClientProgram client(save(make_boxes("uniform", scaled(2'000'000, 10), 1)), served_.address());
    ASSERT_TRUE(comes_true([&] { return served_.load().jobs == 1; }, minutes(1)));
    client.kill();
    EXPECT_TRUE(served_.comes_to_rest());
    expect_serves();
}

TEST_F(ServedKilledClient, WhileItsJobIsQueuedOrRuns) {
    const std::string input = save(many_);
    ClientProgram first(input, served_.address());
    ASSERT_TRUE(gate_.wait_for(1));
    ClientProgram second(input, served_.address());
    ASSERT_TRUE(comes_true([&] { return served_.load().jobs == 2; }, minutes(1)));
    second.kill();
    EXPECT_TRUE(comes_true([&] { return served_.load().jobs == 1; }, minutes(1)));
    first.kill();
    EXPECT_TRUE(served_.comes_to_rest());
    expect_serves();
}

TEST_F(ServedKilledClient, WhileItDoesNotReadItsResult) {
    std::vector<Box3f> boxes(3000);  // 36 MB of pairs
    while (boxes.size() < 50'000) boxes.push_back({{float(boxes.size()), 0, 0}, {float(boxes.size()), 0, 0}});
    ClientProgram client(save(boxes), served_.address());
    ASSERT_TRUE(gate_.wait_for(1));
    client.stop();
    gate_.open();
    ASSERT_TRUE(comes_true([&] { return served_.load().jobs == 0; }, minutes(1)));
    EXPECT_GT(served_.load().memory_bytes, std::uint64_t(30) << 20) << "the unread result is not kept";
    client.kill();
    EXPECT_TRUE(served_.comes_to_rest());
    expect_serves();
}

}  // namespace
}  // namespace octopair::test
