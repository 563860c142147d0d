// Tests connections of strangers over TCP: silent ones, and those that send much before they make a call, do not keep clients out.
#include <gtest/gtest.h>
#include <sys/socket.h>

#include <filesystem>
#include <thread>

#include "engine/jobs.hpp"
#include "processes/leftovers.hpp"
#include "service/guarded.hpp"
#include "service/raw_socket.hpp"
#include "service/served.hpp"
#include "service/server_program.hpp"

namespace octopair::test {
namespace {

using std::chrono::seconds;

class Strangers : public ::testing::Test {
protected:
    Strangers() { write_secret(folder_.file("tokens"), "anna 0123456789abcdef\n"); }

    Served::Change with(std::uint64_t connections, seconds stall = seconds(60)) const {
        return [this, connections, stall](service::ServerOptions& options) {
            options.listen = service::parse_address("127.0.0.1:0");
            options.token_file = folder_.file("tokens");
            options.limits.connections = connections;
            options.stall = stall;  // also the time for the first call, if it is less than 10 s
        };
    }
    static ClientOptions anna() {
        ClientOptions options{.token = "0123456789abcdef", .token_in_clear = true};
        return options;
    }

    TemporaryDirectory folder_;
};

TEST_F(Strangers, SilentConnectionsLeaveRoomForClients) {
    const Served served(with(40));
    std::vector<std::unique_ptr<RawSocket>> silent;
    for (int i = 0; i < 200; ++i) silent.push_back(std::make_unique<RawSocket>(served.address()));
    std::vector<std::unique_ptr<Engine>> engines;
    for (int i = 0; i < 20; ++i) {
        engines.push_back(connect(served.address(), anna()));
        silent.push_back(std::make_unique<RawSocket>(served.address()));
    }
    for (const auto& engine : engines) EXPECT_EQ(engine->count_pairs(objects_of(touching_boxes)), 1u);
}

TEST_F(Strangers, ConnectionsWithoutACallAreCut) {
    const Served served(with(40, seconds(1)));
    RawSocket silent(served.address()), greeting(served.address());
    ASSERT_TRUE(greeting.send(std::string(http2_preface) + http2_frame({settings_frame}, "")));
    const auto engine = connect(served.address(), anna());
    EXPECT_TRUE(silent.is_closed_within(seconds(20)));
    EXPECT_TRUE(greeting.is_closed_within(seconds(20))) << "gRPC alone would wait for five minutes";
    EXPECT_TRUE(comes_true([&] { return served.load().connections <= 1; }, seconds(20)));
    std::this_thread::sleep_for(seconds(2));
    EXPECT_EQ(engine->count_pairs(objects_of(touching_boxes)), 1u) << "a client that was admitted stays";
}

/// gRPC reads a new connection on the thread that hands it over, as long as it has data. So that thread must not be the one that cuts
/// connections. The header is a number with endless zeros, which gRPC reads again from its start with each frame.
TEST_F(Strangers, ABurstDoesNotDelayClients) {
    // In a program of its own, whose listener has no other gRPC threads to help it.
    const ServerProgram program(
        {.arguments = "--engine local --threads 2 --tokens '" + folder_.file("tokens") + "'", .listen = "127.0.0.1:0"});
    const std::string before = "started address=";
    const auto has_started = [&] {
        return std::filesystem::exists(program.file("log")) && program.log().find(before) != std::string::npos;
    };
    ASSERT_TRUE(comes_true(has_started, seconds(60)));
    std::string address = program.log().substr(program.log().find(before) + before.size());
    address.resize(address.find(' '));
    constexpr char continuation_frame = 9;
    const std::string zeros(16'000, '\x80'), more = http2_frame({continuation_frame, 0, 3}, zeros);
    for (int round = 0; round < 2; ++round) {
        const RawSocket socket(address);
        ASSERT_TRUE(socket.send(std::string(http2_preface) + http2_frame({settings_frame}, "") +
                                http2_frame({headers_frame, 0, 3}, "\x40\x7f" + zeros)));
        for (int sent = 0; sent < 240 && ::send(socket.number(), more.data(), more.size(), MSG_NOSIGNAL) > 0; ++sent) {
        }
        const auto begun = std::chrono::steady_clock::now();
        EXPECT_EQ(connect(address, anna())->count_pairs(objects_of(touching_boxes)), 1u);
        EXPECT_LT(std::chrono::steady_clock::now() - begun, seconds(2));
    }
}

TEST_F(Strangers, ManyRefusedCallsAreCut) {
    const Served served(with(40));
    RawSocket socket(served.address());
    ASSERT_TRUE(socket.send(std::string(http2_preface) + http2_frame({settings_frame}, "")));
    bool open = true;
    std::uint32_t stream = 1;
    for (; open && stream < 600; stream += 2)  // in all, less than half of the bytes that are allowed
        open = socket.send(grpc_head(stream, "Describe") +
                           http2_frame({reset_frame, 0, stream}, std::string("\0\0\0\10", 4)));
    open = open && !socket.is_closed_within(seconds(5));
    EXPECT_FALSE(open) << stream / 2 << " calls were taken";
    const auto engine = connect(served.address(), anna());
    for (int i = 0; i < 200; ++i) EXPECT_EQ(engine->count_pairs(objects_of(touching_boxes)), 1u);
}

TEST_F(Strangers, AClientHasItsShareOfTheConnections) {
    const Served served([&](service::ServerOptions& options) {
        with(40)(options);
        write_secret(folder_.file("tokens"), "anna 0123456789abcdef\nbert fedcba9876543210\n");
        options.limits.connections_per_client = 3;
    });
    std::vector<std::unique_ptr<Engine>> engines;
    for (int i = 0; i < 3; ++i) engines.push_back(connect(served.address(), anna()));
    expect_refused("connections_per_client", 3, [&] { (void)connect(served.address(), anna()); });
    ClientOptions bert = anna();
    bert.token = "fedcba9876543210";
    EXPECT_EQ(connect(served.address(), bert)->count_pairs(objects_of(touching_boxes)), 1u);
    engines.pop_back();
    std::unique_ptr<Engine> another;
    EXPECT_TRUE(comes_true(
        [&] {
            try {
                another = connect(served.address(), anna());
                return true;
            } catch (const Error&) {
                return false;
            }
        },
        seconds(20)));
    for (const auto& engine : engines) EXPECT_EQ(engine->count_pairs(objects_of(touching_boxes)), 1u);
}

/// A header that never ends: HEADERS without END_HEADERS, then CONTINUATION frames.
TEST_F(Strangers, AnEndlessHeaderIsCut) {
    const Served served(with(40));
    RawSocket socket(served.address());
    // A literal header (0x40) whose name has 2,000,000,000 bytes.
    const std::string name = std::string("\x40\x7f\x81\xa8\xd6\xb9\x07", 7) + std::string(16'000, 'x');
    ASSERT_TRUE(socket.send(std::string(http2_preface) + http2_frame({settings_frame}, "") +
                            http2_frame({headers_frame, 0, 1}, name)));
    constexpr char continuation_frame = 9;
    const std::string more = http2_frame({continuation_frame, 0, 1}, std::string(16'000, 'x'));
    std::uint64_t sent = 0;
    bool open = true;
    for (; open && sent < 64'000'000; sent += more.size()) {
        open = socket.send(more);
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    EXPECT_GT(sent, 100'000u) << "gRPC takes such a header";
    EXPECT_FALSE(open) << "the server takes more than 64 MB";
    EXPECT_EQ(connect(served.address(), anna())->count_pairs(objects_of(touching_boxes)), 1u);
}

}  // namespace
}  // namespace octopair::test
