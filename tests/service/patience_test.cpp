// Tests servers that do not exist or do not answer: calls end when the patience is over, and not earlier.
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <cstring>
#include <thread>

#include "base/descriptor.hpp"
#include "engine/jobs.hpp"
#include "io/temporary.hpp"
#include "processes/leftovers.hpp"
#include "service/gate.hpp"
#include "service/served.hpp"
#include "support/kinds.hpp"

namespace octopair::test {
namespace {

using std::chrono::milliseconds;

/// A server that listens and never answers.
class Mute {
public:
    explicit Mute(const std::string& path) : socket_(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
        sockaddr_un name{};
        name.sun_family = AF_UNIX;
        std::memcpy(name.sun_path, path.c_str(), path.size() + 1);
        EXPECT_EQ(::bind(socket_.number(), reinterpret_cast<const sockaddr*>(&name), sizeof name), 0);
        EXPECT_EQ(::listen(socket_.number(), 1000), 0);
    }

private:
    Descriptor socket_;
};

TEST(ServedPatience, EndsWithoutAServer) {
    const TemporaryDirectory folder;
    for (const std::string& address : {"unix:" + folder.file("nobody"), std::string("127.0.0.1:1")}) {
        const auto call = [&] { (void)connect(address, {.patience = milliseconds(300)}); };
        expect_error(ErrorCode::engine_failed, address, call);
    }
}

TEST(ServedPatience, EndsAtAServerThatNeverAnswers) {
    const TemporaryDirectory folder;
    const Mute mute(folder.file("mute"));
    const auto call = [&] { (void)connect("unix:" + folder.file("mute"), {.patience = milliseconds(2500)}); };
    EXPECT_EQ(code_of(call), ErrorCode::engine_failed);
}

TEST(ServedPatience, WaitsForAServerThatComesLater) {
    Served served;
    served.stop();
    std::jthread later([&] {
        std::this_thread::sleep_for(milliseconds(400));
        served.start();
    });
    check_serves(served.address());
}

TEST(ServedPatience, EndsWhenAServerStaysAway) {
    Gate gate;
    Served served([&](service::ServerOptions& options) {
        options.engine = gated_engines(gate);
        options.engine_widths.instant = 0;  // instant jobs would block gRPC's threads at the gate
    });
    const auto engine = served.client(milliseconds(500));
    Job job = engine->submit(touching_boxes);
    ASSERT_TRUE(gate.wait_for(1));
    served.stop();
    EXPECT_EQ(code_of([&] { (void)job.summary(); }), ErrorCode::engine_failed);
    served.start();
    gate.open();
    // With a patience of 500 ms, a call may end again before the server answers.
    const auto answers = [&] {
        std::uint64_t pairs = 0;
        (void)code_of([&] { pairs = engine->count_pairs(objects_of(touching_boxes)); });
        return pairs == 1;
    };
    EXPECT_TRUE(comes_true(answers, std::chrono::minutes(1)));
}

/// For example a proxy whose server is gone: it takes calls, and ends each with UNAVAILABLE.
TEST(ServedPatience, EndsAtAServerThatRefusesEachCall) {
    Gate gate;
    Served served([&](service::ServerOptions& options) {
        options.engine = gated_engines(gate);
        options.engine_widths.instant = 0;
    });
    const auto engine = served.client(), other = served.client(milliseconds(500));
    Job job = engine->submit(touching_boxes);
    ASSERT_TRUE(gate.wait_for(1));
    std::jthread drain([&] { served.server().drain(std::chrono::seconds(30)); });
    const auto is_refused = [&] {
        return code_of([&] { (void)connect(served.address(), {.connect_timeout = milliseconds(100)}); }) ==
               ErrorCode::engine_failed;
    };
    ASSERT_TRUE(comes_true(is_refused, std::chrono::seconds(20)));
    const std::vector<Box3f> many = make_boxes("uniform", 100'000, 1);  // a stream of messages
    const auto begun = std::chrono::steady_clock::now();
    EXPECT_EQ(code_of([&] { (void)other->count_pairs({many}); }), ErrorCode::engine_failed);
    EXPECT_LT(std::chrono::steady_clock::now() - begun, std::chrono::seconds(20));
    gate.open();
}

/// A name without an address counts as a server that does not answer, not as one that answered once.
TEST(ServedPatience, EndsAtANameWithoutAddress) {
    const auto begun = std::chrono::steady_clock::now();
    const ClientOptions options = {.connect_timeout = milliseconds(100), .patience = std::chrono::hours(1)};
    EXPECT_EQ(code_of([&] { (void)connect("no-such-host.invalid:1", options); }), ErrorCode::engine_failed);
    EXPECT_LT(std::chrono::steady_clock::now() - begun, std::chrono::minutes(1));
}

TEST(ServedPatience, CanBeStopped) {
    Served served;
    const auto engine = served.client(std::chrono::hours(10));
    served.stop();
    Job job = engine->submit(touching_boxes);
    std::this_thread::sleep_for(milliseconds(100));
    job.cancel();
    ASSERT_TRUE(job.wait_for(std::chrono::minutes(1)));
    EXPECT_EQ(job.state(), JobState::cancelled);
}

TEST(ServedPatience, WrongAddressesAreRefused) {
    for (const char* address : {"",
                                "unix:",
                                "localhost",
                                "localhost:",
                                ":1",
                                "localhost:65536",
                                "localhost:1x",
                                "::1:80",
                                "[:]:80",
                                "[::1%]:80",
                                "[::1 ]:80",
                                "[::g]:80",
                                "local/host:80",
                                "local\nhost:80",
                                "user@host:80",
                                "127.1:80",
                                "127.0.0.01:80",
                                "127.0.0.256:80",
                                "0x7f.0.0.1:80",
                                "2130706433:80",
                                "127.0.0.1.:80"}) {
        SCOPED_TRACE(address);
        EXPECT_EQ(code_of([&] { (void)connect(address); }), ErrorCode::usage);
    }
    using namespace std::string_literals;
    for (const std::string& address : {"unix:a\0b"s, "[::1\0]:80"s, "::1\0:80"s})
        EXPECT_EQ(code_of([&] { (void)connect(address); }), ErrorCode::usage);
    EXPECT_EQ(
        error_of(ErrorCode::usage, [] { (void)connect("local\x1B[1m:80"); }),
        "address 'local?[1m:80' has a character in its host that no host name can have; give unix:PATH or HOST:PORT");
}

}  // namespace
}  // namespace octopair::test
