// Tests a server under a supervisor like systemd: reports of its state, and a listening socket that outlives the server.
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <array>
#include <atomic>
#include <cstring>
#include <thread>

#include "base/descriptor.hpp"
#include "service/detached/detached_server.hpp"
#include "service/server_program.hpp"

namespace octopair::test {
namespace {

sockaddr_un unix_address(const std::string& path) {
    sockaddr_un name{};
    name.sun_family = AF_UNIX;
    std::memcpy(name.sun_path, path.c_str(), path.size() + 1);
    return name;
}

/// Socket to which a program reports its state.
class Reports {
public:
    Reports() : socket_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
        const sockaddr_un name = unix_address(path());
        EXPECT_EQ(::bind(socket_.number(), reinterpret_cast<const sockaddr*>(&name), sizeof name), 0);
    }
    std::string path() const { return folder_.file("notify"); }

    /// Returns the next report, or "" after a minute without one.
    std::string next(int milliseconds = 60'000) const {
        pollfd watched = {socket_.number(), POLLIN, 0};
        if (::poll(&watched, 1, milliseconds) <= 0) return {};
        std::array<char, 1024> text{};
        const ssize_t size = ::recv(socket_.number(), text.data(), text.size(), 0);
        return {text.data(), std::size_t(std::max<ssize_t>(0, size))};
    }

private:
    TemporaryDirectory folder_;
    Descriptor socket_;
};

TEST(Supervised, ReportsThatItIsReadyWorksAndStops) {
    const Reports reports;
    ServerProgram program({.environment = "NOTIFY_SOCKET='" + reports.path() + "' WATCHDOG_USEC=400000"});
    EXPECT_EQ(reports.next(), "READY=1") << program.log();
    for (int i = 0; i < 3; ++i) EXPECT_EQ(reports.next(), "WATCHDOG=1");
    program.signal(SIGSTOP);
    while (!reports.next(300).empty()) {
    }
    EXPECT_EQ(reports.next(1000), "") << "a stopped server reports nothing";
    program.signal(SIGCONT);
    EXPECT_EQ(reports.next(), "WATCHDOG=1");
    program.signal(SIGTERM);
    std::string last;
    while (last != "STOPPING=1" && !(last = reports.next()).empty()) {
    }
    EXPECT_EQ(last, "STOPPING=1");
    EXPECT_EQ(program.wait(), 0);
}

/// Programs that take a listening socket over, one after the other.
class PassedSocket : public ::testing::Test {
protected:
    /// Returns the setting of a server that takes over the descriptor `number`.
    ServerProgram::Setting taking_over(int number, const std::string& arguments = {}) const {
        return {.arguments = "--engine local --threads 2 --state '" + folder_.file("state") + "' " + arguments,
                .before = "exec 3<&" + std::to_string(number) + "; export LISTEN_FDS=1 LISTEN_PID=$$;",
                .listen = "systemd"};
    }

    Descriptor listening(const std::string& path) const {
        Descriptor socket(::socket(AF_UNIX, SOCK_STREAM, 0));
        const sockaddr_un name = unix_address(path);
        EXPECT_EQ(::bind(socket.number(), reinterpret_cast<const sockaddr*>(&name), sizeof name), 0);
        EXPECT_EQ(::listen(socket.number(), 100), 0);
        return socket;
    }

    TemporaryDirectory folder_;
};

TEST_F(PassedSocket, LosesNothingWhenTheServerIsRestarted) {
    const std::string path = folder_.file("socket"), address = "unix:" + path;
    const Descriptor socket = listening(path);
    auto program = std::make_unique<ServerProgram>(taking_over(socket.number()));
    const auto boxes = make_boxes("uniform", 2000, 1);
    const Work work(Objects{boxes});
    const std::vector<Pair> expected = pairs_here(work);
    std::atomic<int> done = 0;
    std::vector<std::vector<std::string>> submitted(3);
    std::vector<std::jthread> clients;
    for (auto& ids : submitted) {
        clients.emplace_back([&](const std::stop_token& stop) {
            while (!stop.stop_requested()) {
                PairList pairs;  // a new connection each time: its first call waits for the next server, too
                connect(address, {.connect_timeout = std::chrono::seconds(60)})->find_pairs({boxes}, pairs);
                EXPECT_EQ(pairs.to_vector(), expected);
                ids.push_back(JobClient(address).submit({boxes}));
                ++done;
            }
        });
    }
    for (int restart = 0; restart < 5; ++restart) {
        const int before = done;
        ASSERT_TRUE(comes_true([&] { return done > before + 10; })) << program->log();
        program->signal(SIGTERM);
        EXPECT_EQ(program->wait(), 0) << program->log();
        EXPECT_TRUE(std::filesystem::exists(path)) << "the socket is not the server's";
        program = std::make_unique<ServerProgram>(taking_over(socket.number()));
    }
    clients.clear();
    JobClient client(address);
    std::size_t jobs = 0;
    for (const auto& ids : submitted) {
        for (const std::string& id : ids) expect_done(client, id);
        jobs += ids.size();
        EXPECT_TRUE(same_bytes(pairs_there(client, ids.back()), expected));
    }
    EXPECT_EQ(client.list().size(), jobs);
}

TEST_F(PassedSocket, MayBeOfTcp) {
    Descriptor socket(::socket(AF_INET, SOCK_STREAM, 0));
    sockaddr_in name{};
    name.sin_family = AF_INET;
    name.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    ASSERT_EQ(::bind(socket.number(), reinterpret_cast<const sockaddr*>(&name), sizeof name), 0);
    ASSERT_EQ(::listen(socket.number(), 100), 0);
    socklen_t size = sizeof name;
    ASSERT_EQ(::getsockname(socket.number(), reinterpret_cast<sockaddr*>(&name), &size), 0);
    const ServerProgram program(taking_over(socket.number()));
    const std::string address = "127.0.0.1:" + std::to_string(ntohs(name.sin_port));
    const auto boxes = make_boxes("uniform", 1000, 1);
    EXPECT_GT(connect(address, {.connect_timeout = std::chrono::seconds(60)})->count_pairs({boxes}), 0u);
    EXPECT_TRUE(has_text(program.log(), "started address=" + address));
}

TEST_F(PassedSocket, ThatOtherMachinesReachNeedsProtection) {
    const Descriptor socket(::socket(AF_INET, SOCK_STREAM, 0));
    sockaddr_in name{};
    name.sin_family = AF_INET;
    ASSERT_EQ(::bind(socket.number(), reinterpret_cast<const sockaddr*>(&name), sizeof name), 0);
    ASSERT_EQ(::listen(socket.number(), 100), 0);
    ServerProgram program(taking_over(socket.number()));
    EXPECT_EQ(program.wait(), 2);
    EXPECT_TRUE(has_text(program.log(), "other machines can reach it; that needs TLS"));
}

TEST_F(PassedSocket, MustBeOneListeningSocket) {
    const auto refusal = [&](const std::string& before) {
        ServerProgram program({.before = before, .listen = "systemd"});
        EXPECT_EQ(program.wait(), 2);
        return program.log();
    };
    EXPECT_TRUE(has_text(refusal(""), "--listen systemd: systemd passed 0 sockets"));
    EXPECT_TRUE(has_text(refusal("exec 3</dev/null 4</dev/null; export LISTEN_FDS=2 LISTEN_PID=$$;"),
                         "systemd passed 2 sockets"));
    EXPECT_TRUE(has_text(refusal("exec 3</dev/null; export LISTEN_FDS=1 LISTEN_PID=$$;"), "not a listening socket"));
}

}  // namespace
}  // namespace octopair::test
