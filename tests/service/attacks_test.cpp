// Tests malicious or faulty clients: slow, silent, greedy, or with a wrong protocol. No such client holds the server's
// resources for long, and a valid job at the same time is done.
#include <gtest/gtest.h>

#include <thread>

#include "processes/leftovers.hpp"
#include "service/raw_call.hpp"
#include "service/raw_socket.hpp"
#include "service/served.hpp"
#include "service/server_program.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

using std::chrono::milliseconds;
using std::chrono::minutes;
using std::chrono::seconds;

void stall_soon(service::ServerOptions& options) { options.stall = seconds(1); }

class ServedAttacks : public ::testing::TestWithParam<bool> {
protected:
    const Served served_{[](service::ServerOptions& options) {
        stall_soon(options);
        if (!GetParam()) options.listen = service::parse_address("127.0.0.1:0");
    }};
};

INSTANTIATE_TEST_SUITE_P(, ServedAttacks, ::testing::Bool(),
                         [](const auto& one) { return std::string(one.param ? "Unix" : "Tcp"); });

std::string noise(std::size_t bytes) {
    std::string text;
    std::uint64_t state = 88172645463325252u;
    while (text.size() < bytes) {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        text += char(state >> 32);
    }
    return text;
}

TEST_P(ServedAttacks, OtherLanguages) {
    const std::string settings = http2_frame({settings_frame}, {});
    const std::string preface(http2_preface);
    for (const std::string& words :
         {noise(100'000), std::string("GET / HTTP/1.1\r\nHost: localhost\r\n\r\n"), std::string(70'000, '\0'),
          std::string("SSH-2.0-OpenSSH_9.2\r\n"), std::string("\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03", 11),
          preface + noise(100'000), preface + settings + http2_frame({9, 0, 0}, "x"),
          preface + settings + std::string("\xff\xff\xff\0\0\0\0\0\1", 9) + noise(100'000)}) {
        RawSocket socket(served_.address());
        (void)socket.send(words);
        EXPECT_TRUE(socket.is_closed_within(minutes(1))) << words.substr(0, 40);
    }
    check_serves(served_.address());
}

TEST_P(ServedAttacks, AByteNowAndThen) {
    RawSocket socket(served_.address());
    std::size_t sent = 0;
    const bool closed = comes_true(
        [&] {
            if (sent + 1 < http2_preface.size()) (void)socket.send(http2_preface.substr(sent++, 1));
            return socket.is_closed_within(milliseconds(100));
        },
        minutes(1));
    EXPECT_TRUE(closed);
    check_serves(served_.address());
}

TEST_P(ServedAttacks, SilenceIsNotWaitedFor) {
    RawSocket socket(served_.address());
    EXPECT_TRUE(socket.is_closed_within(minutes(1)));
}

/// A call whose message is never complete.
TEST_P(ServedAttacks, AByteNowAndThenOfAMessage) {
    RawSocket socket(served_.address());
    ASSERT_TRUE(socket.send(std::string(http2_preface) + http2_frame({settings_frame}, {}) + grpc_head(1, "Detect") +
                            http2_frame({data_frame, 0, 1}, grpc_prefix(1000))));
    std::string answer;
    const bool ended = comes_true(
        [&] {
            (void)socket.send(http2_frame({data_frame, 0, 1}, "x"));
            answer += socket.receive(milliseconds(100));
            return answer.find("stall_seconds") != std::string::npos;
        },
        minutes(1));
    EXPECT_TRUE(ended);
    check_serves(served_.address());
}

/// Complete messages that hold almost no data.
TEST_P(ServedAttacks, AnUploadOfAByteNowAndThen) {
    const auto spec = spec_of(100'000);
    const auto channel = open_channel(served_.address());
    for (const std::string& data : std::vector<std::string>{"x", ""}) {
        RawCall call(channel);
        ASSERT_TRUE(call.write(upload_of(&spec, {})));
        const bool ended = comes_true(
            [&] {
                std::this_thread::sleep_for(milliseconds(50));
                return !call.write(upload_of(nullptr, data));
            },
            seconds(30));
        EXPECT_TRUE(ended) << "the upload does not end";
        if (!ended) call.cancel();
        const grpc::Status status = call.finish();
        EXPECT_EQ(failure_in(status).limit(), "stall_seconds") << status.error_message();
        EXPECT_TRUE(served_.comes_to_rest());
    }
}

TEST_P(ServedAttacks, AResultThatNobodyReads) {
    const std::vector<Box3f> boxes(3000);  // 36 MB of pairs
    const auto channel = open_channel(served_.address());
    const auto spec = spec_of(boxes.size());
    RawCall call(channel);
    ASSERT_TRUE(call.write(upload_of(&spec, bytes_of(boxes))));
    ASSERT_TRUE(comes_true([&] { return served_.load().memory_bytes > 0; }, minutes(1)));
    EXPECT_TRUE(served_.comes_to_rest());
    check_serves(served_.address());
    EXPECT_FALSE(call.finish().ok());
}

/// Sends many frames that require an answer, and does not read the answers.
class Flood {
public:
    Flood(const std::string& address, std::string frames) : socket_(address), frames_(std::move(frames)) {
        (void)socket_.send(std::string(http2_preface) + http2_frame({settings_frame}, {}));
    }
    /// Sends until `most` bytes are sent, or the server accepts no more.
    void run(std::uint64_t most) {
        for (std::uint64_t sent = 0; sent < most && socket_.send(frames_); sent += frames_.size()) {
        }
    }

private:
    RawSocket socket_;
    std::string frames_;
};

std::string repeated(const std::string& frame, int times) {
    std::string all;
    for (int i = 0; i < times; ++i) all += frame;
    return all;
}

TEST(ServerAttacks, FloodsOfFramesTakeNoMemory) {
    ServerProgram server;
    const auto engine = connect(server.address(), {.patience = minutes(1)});
    const std::uint64_t before = server.memory();
    std::string resets;
    for (std::uint32_t stream = 1; stream < 2000; stream += 2) {
        resets += grpc_head(stream, "Detect") + http2_frame({reset_frame, 0, stream}, std::string("\0\0\0\x08", 4));
    }
    const std::uint64_t bytes = scaled(20'000'000, 10);
    std::vector<std::jthread> floods;
    for (const std::string& frames : {repeated(http2_frame({settings_frame}, std::string("\0\4\0\0\xff\xff", 6)), 1000),
                                      repeated(http2_frame({ping_frame}, "12345678"), 1000), resets}) {
        floods.emplace_back([&, frames] { Flood(server.address(), frames).run(bytes); });
    }
    const std::vector<Box3f> boxes(1000);
    for (int i = 0; i < 20; ++i) EXPECT_EQ(engine->count_pairs({boxes}), 499'500u);
    floods.clear();
    EXPECT_TRUE(server.lives());
    EXPECT_LT(server.memory(), before + (std::uint64_t(sanitized ? 1500 : 300) << 20));
    check_serves(server.address());
}

}  // namespace
}  // namespace octopair::test
