// Tests how a server ends, and which server may take its place.
#include <filesystem>
#include <future>
#include <thread>
#include <utility>

#include "cli/program.hpp"
#include "service/metrics_page.hpp"
#include "service/protocol/octopair.grpc.pb.h"

namespace octopair::test {
namespace {

class Drain : public ::testing::Test {
protected:
    service::ServerOptions patient() const {
        service::ServerOptions options = options_at("unix:" + folder_.file("socket"));
        options.grace = std::chrono::hours(1);
        return options;
    }
    std::string address() const { return "unix:" + folder_.file("socket"); }

    TemporaryDirectory folder_;
};

TEST_F(Drain, WaitsForNoIdleConnection) {
    service::Server server(patient(), silent());
    const auto engine = connect(address(), {});
    PairList pairs;
    engine->find_pairs({std::vector<Box3f>(3)}, pairs);
    server.drain();
    ClientOptions hasty{.patience = std::chrono::milliseconds(100)};
    EXPECT_NE(error_of(ErrorCode::engine_failed, [&] { connect(address(), hasty); }), "");
}

TEST_F(Drain, WaitsForNoUpload) {
    service::Server server(patient(), silent());
    const auto channel = grpc::CreateChannel(address(), grpc::InsecureChannelCredentials());
    grpc::GenericStub stub(channel);
    grpc::ClientContext context;
    grpc::CompletionQueue queue;
    void* tag = nullptr;
    bool ok = false;
    const auto call = stub.PrepareCall(&context, "/octopair.v1.Octopair/Detect", &queue);
    call->StartCall(nullptr);
    ASSERT_TRUE(queue.Next(&tag, &ok) && ok);
    // The server answers Describe, the next call of this connection, after it has received the call Detect.
    grpc::ClientContext other;
    octopair::v1::ServerDescription description;
    ASSERT_TRUE(octopair::v1::Octopair::NewStub(channel)->Describe(&other, {}, &description).ok());
    server.drain();
    grpc::Status status;
    call->Finish(&status, nullptr);
    ASSERT_TRUE(queue.Next(&tag, &ok));
    EXPECT_EQ(status.error_code(), grpc::StatusCode::UNAVAILABLE) << status.error_message();
}

/// A client that reads slowly gets the complete result of a running job.
TEST_F(Drain, LetsResultsReachTheirClients) {
    service::Server server(patient(), silent());
    constexpr std::uint64_t boxes = 3000;
    std::promise<void> arrived, go_on;
    const auto released = go_on.get_future().share();
    std::uint64_t received = 0;
    std::thread client([&] {
        const auto engine = connect(address(), {});
        const std::vector<Box3f> same(boxes, Box3f{{0, 0, 0}, {1, 1, 1}});
        (void)engine->stream_pairs({same}, [&](std::span<const Pair> pairs) {
            if (received == 0) arrived.set_value();
            received += pairs.size();
            released.wait();
        });
    });
    arrived.get_future().wait();
    const auto ended = std::async(std::launch::async, [&] { server.drain(); });
    EXPECT_EQ(ended.wait_for(std::chrono::milliseconds(200)), std::future_status::timeout);
    go_on.set_value();
    client.join();
    ended.wait();
    EXPECT_EQ(received, boxes * (boxes - 1) / 2);
}

/// Returns the answer of gRPC's health service: 1 is SERVING and 2 is NOT_SERVING. Returns 0 if the call fails.
int health(const std::shared_ptr<grpc::Channel>& channel) {
    grpc::ByteBuffer answer;
    grpc::Slice bytes;
    if (!call_raw(channel, "/grpc.health.v1.Health/Check", "", answer).ok()) return 0;
    if (!answer.DumpToSingleSlice(&bytes).ok() || bytes.size() != 2) return 0;
    return bytes.begin()[1];  // the message has one field
}

TEST_F(Drain, IsToldByTheHealthServiceWhileJobsEnd) {
    service::Server server(patient(), silent());
    const auto channel = grpc::CreateChannel(address(), grpc::InsecureChannelCredentials());
    EXPECT_EQ(health(channel), 1);
    std::promise<void> arrived, go_on;
    std::jthread client([&] {
        const std::vector<Box3f> same(3000, Box3f{{0, 0, 0}, {1, 1, 1}});
        bool first = true;
        (void)connect(address(), {})->stream_pairs({same}, [&](std::span<const Pair>) {
            if (!std::exchange(first, false)) return;
            arrived.set_value();
            go_on.get_future().wait();
        });
    });
    arrived.get_future().wait();
    const auto ended = std::async(std::launch::async, [&] { server.drain(); });
    const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(1);
    int last = 1;
    while (last == 1 && std::chrono::steady_clock::now() < end) last = health(channel);
    go_on.set_value();
    EXPECT_EQ(last, 2);
}

TEST_F(Drain, CancelsWhatIsLeftAfterItsGrace) {
    service::ServerOptions options = patient();
    options.grace = std::chrono::seconds(1);
    options.metrics = service::parse_address("localhost:0");
    std::ostringstream log;
    service::Server server(options, log_to(log));
    ClientOptions hasty{.patience = std::chrono::milliseconds(100)};
    const auto engine = connect(address(), hasty);
    // Counting all pairs of a million equal boxes takes hours.
    const std::vector<Box3f> same(1'000'000, Box3f{{0, 0, 0}, {1, 1, 1}});
    auto refused = std::async(std::launch::async,
                              [&] { return error_of(ErrorCode::engine_failed, [&] { engine->count_pairs({same}); }); });
    EXPECT_TRUE(page_has(log, "octopair_jobs{state=\"running\"} 1"));
    server.drain();
    EXPECT_TRUE(refused.get().starts_with(address() + ": no server answers"));
}

/// Shell functions: `serve N ARGUMENT...` starts server number N and waits until it listens or has ended.
constexpr const char* functions = R"(
    serve() {
        n=$1; shift
        "$P" serve --listen unix:socket --threads 1 "$@" 2>log$n & child=$!
        for i in $(seq 1200); do
            grep -qs started log$n && return
            kill -0 $child 2>/dev/null || return
            sleep 0.05
        done
    }
    says() { for i in $(seq 1200); do grep -qs "$2" log$1 && return; sleep 0.05; done; echo "no $2 in log$1"; }
    )";

class ServeProgram : public ProgramTest {
protected:
    ServeProgram() { save_boxes("a.npy", {0, 10, 0.5}); }
    Outcome script(const std::string& lines) const { return shell(functions + lines); }
    static constexpr const char* detect = "\"$P\" detect a.npy --engine unix:socket --quiet --patience 5\n";
};

TEST_F(ServeProgram, EndsOnASignal) {
    for (const std::string name : {"TERM", "INT"}) {
        const Outcome outcome = script("serve 1\n" + std::string(detect) + "kill -" + name + " $child; wait $child");
        EXPECT_EQ(outcome.status, 0) << content("log1");
        EXPECT_EQ(outcome.out, "a,b\n0,2\n");
        EXPECT_FALSE(std::filesystem::exists(file("socket")));
    }
}

TEST_F(ServeProgram, SecondSignalKills) {
    ASSERT_EQ(run("generate dense --objects 1000000 --output b.npy --quiet").status, 0);
    const Outcome outcome = script(R"sh(
        serve 1 --grace 3600
        "$P" detect b.npy --margin 1000 --count-only --engine unix:socket --quiet --patience 0.1 2>/dev/null & client=$!
        until set -- $(cat /proc/$child/stat) && [ "${14}" -gt 50 ]; do sleep 0.05; done
        kill -TERM $child
        says 1 stopping
        kill -TERM $child
        wait $child; echo $?
        wait $client; echo $?
        )sh");
    EXPECT_EQ(outcome.out, "143\n6\n") << outcome.err << content("log1");
}

TEST_F(ServeProgram, SecondServerIsRefused) {
    const Outcome outcome = script("serve 1; first=$child; serve 2; wait $child; echo $?\n" + std::string(detect) +
                                   "kill $first; wait $first; echo $?");
    EXPECT_EQ(outcome.out, "4\na,b\n0,2\n0\n") << content("log1") << content("log2");
    EXPECT_TRUE(has_text(content("log2"), "another server listens there"));
}

TEST_F(ServeProgram, SocketOfADeadServerIsTaken) {
    const Outcome outcome = script(
        "serve 1; kill -9 $child; wait $child 2>/dev/null; test -S socket || echo gone\n"
        "serve 2\n" +
        std::string(detect) + "kill $child; wait $child; echo $?");
    EXPECT_EQ(outcome.out, "a,b\n0,2\n0\n") << content("log1") << content("log2");
}

}  // namespace
}  // namespace octopair::test
