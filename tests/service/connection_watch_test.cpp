// Tests when connections of an address wait whose earlier connection was cut, and which resets lead to a cut.
#include "service/server/net/connection_watch.hpp"

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <array>

namespace octopair::service {
namespace {

using namespace std::chrono_literals;

class PacedConnections : public ::testing::Test {
protected:
    /// Connects from a port of an address. Keeps the other end of the connection open.
    void connect(const std::string& address, int port) {
        std::array<int, 2> ends{};
        ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()), 0);
        others_.emplace_back(ends[1]);
        watch_.add(Descriptor(ends[0]), {name(address, port), address}, now_);
    }
    static std::string name(const std::string& address, int port) { return address + ":" + std::to_string(port); }
    void refuse_calls(const std::string& address, int port, std::uint64_t calls) {
        for (std::uint64_t i = 0; i < calls; ++i) watch_.note_refused(name(address, port), now_);
    }
    /// Connects and makes as many refused calls as lead to a cut.
    void get_cut(const std::string& address, int port) {
        connect(address, port);
        ASSERT_EQ(ready_after(0ms), 1u);
        refuse_calls(address, port, limits_.max_refused_calls + 1);
        EXPECT_EQ(watch_.unknown(), 0u);
    }
    std::size_t ready_after(std::chrono::milliseconds time) {
        now_ += time;
        return watch_.take_ready(now_).size();
    }

    const ConnectionLimits limits_;
    ConnectionWatch watch_{limits_};
    ConnectionWatch::Clock::time_point now_ = ConnectionWatch::Clock::now();
    std::vector<Descriptor> others_;
};

TEST_F(PacedConnections, WaitForNothingAtFirst) {
    for (int port = 1; port <= 20; ++port) connect("a", port);
    EXPECT_EQ(ready_after(0ms), 20u);
    refuse_calls("a", 1, limits_.max_refused_calls);
    connect("a", 21);
    EXPECT_EQ(ready_after(0ms), 1u);
    EXPECT_EQ(watch_.waiting(), 0u);
}

TEST_F(PacedConnections, FollowEachOtherSlowlyAfterACut) {
    get_cut("a", 1);
    for (int port = 2; port <= 4; ++port) connect("a", port);
    EXPECT_EQ(watch_.waiting(), 3u);
    EXPECT_EQ(ready_after(0ms), 0u);
    EXPECT_EQ(ready_after(limits_.interval - 1ms), 0u);
    EXPECT_EQ(ready_after(1ms), 1u);
    EXPECT_EQ(ready_after(limits_.interval / 2), 0u);
    EXPECT_EQ(ready_after(limits_.interval), 1u);
    EXPECT_EQ(ready_after(limits_.interval), 1u);
    EXPECT_EQ(watch_.waiting(), 0u);
    EXPECT_EQ(watch_.make_known(name("a", 4), {"client", 4}, now_), ConnectionWatch::Admission::known_now);
}

TEST_F(PacedConnections, OfOtherAddressesDoNotWait) {
    get_cut("a", 1);
    connect("a", 2);
    connect("b", 1);
    EXPECT_EQ(ready_after(0ms), 1u);
    EXPECT_EQ(watch_.make_known(name("b", 1), {"client", 1}, now_), ConnectionWatch::Admission::known_now);
}

TEST_F(PacedConnections, DoNotWaitWhenTheCutIsLongAgo) {
    get_cut("a", 1);
    now_ += limits_.remembered + 1ms;
    (void)watch_.check(now_);
    for (int port = 2; port <= 9; ++port) connect("a", port);
    EXPECT_EQ(ready_after(0ms), 8u);
}

/// Connections over TCP, because resets of closed connections do not count.
class ResettingConnections : public ::testing::Test {
protected:
    ResettingConnections() : listener_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
        sockaddr_in any{};
        any.sin_family = AF_INET;
        any.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        socklen_t size = sizeof(any);
        EXPECT_EQ(::bind(listener_.number(), reinterpret_cast<sockaddr*>(&any), size), 0);
        EXPECT_EQ(::listen(listener_.number(), 16), 0);
        EXPECT_EQ(::getsockname(listener_.number(), reinterpret_cast<sockaddr*>(&address_), &size), 0);
    }

    /// Connects, and makes a first call. Returns the number of the connection.
    std::uint64_t connect(const std::string& client, ConnectionWatch::Admission expected) {
        Descriptor other(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
        EXPECT_EQ(::connect(other.number(), reinterpret_cast<sockaddr*>(&address_), sizeof(address_)), 0);
        Descriptor connection(::accept4(listener_.number(), nullptr, nullptr, SOCK_CLOEXEC));
        const std::uint64_t number = others_.size() + 1;
        const std::string peer = "peer " + std::to_string(number);
        watch_.add(std::move(connection), {peer, "address"}, now_);
        now_ += limits_.interval;
        for (Descriptor& ready : watch_.take_ready(now_)) connections_.push_back(std::move(ready));
        others_.push_back(std::move(other));
        EXPECT_TRUE(watch_.note_begin(number, now_));
        EXPECT_EQ(watch_.make_known(peer, {client, number}, now_), expected);
        watch_.note_end(number, false, now_);
        return number;
    }
    std::uint64_t connect(const std::string& client) { return connect(client, ConnectionWatch::Admission::known_now); }
    /// Returns whether the server has ended a connection.
    bool is_cut(std::uint64_t number) const {
        char byte = 0;
        return ::recv(others_.at(number - 1).number(), &byte, 1, MSG_DONTWAIT) >= 0 || errno != EAGAIN;
    }
    void reset_calls(std::uint64_t number, double calls) {
        for (double i = 0; i < calls; ++i) {
            EXPECT_TRUE(watch_.note_begin(number, now_));
            watch_.note_end(number, true, now_);
        }
    }

    const ConnectionLimits limits_;
    ConnectionWatch watch_{limits_};
    ConnectionWatch::Clock::time_point now_ = ConnectionWatch::Clock::now();
    Descriptor listener_;
    sockaddr_in address_{};
    std::vector<Descriptor> connections_, others_;
};

TEST_F(ResettingConnections, AreCutForCallsThatDoNotEnd) {
    const std::uint64_t one = connect("anna"), other = connect("anna");
    for (double i = 0; i < limits_.max_open_calls; ++i) EXPECT_TRUE(watch_.note_begin(one, now_));
    watch_.note_end(one, false, now_);
    EXPECT_TRUE(watch_.note_begin(one, now_));
    EXPECT_FALSE(is_cut(one));
    EXPECT_FALSE(watch_.note_begin(one, now_));
    EXPECT_TRUE(is_cut(one));
    EXPECT_FALSE(is_cut(other));
    EXPECT_TRUE(watch_.note_begin(other, now_));
}

/// gRPC does not tell of the ends of some calls.
TEST_F(ResettingConnections, AreNotCutForCallsWhoseEndIsNotTold) {
    const std::uint64_t anna = connect("anna");
    for (double i = 0; i < 3 * limits_.max_open_calls; ++i) {
        EXPECT_TRUE(watch_.note_begin(anna, now_));
        now_ += 1s;
    }
    EXPECT_FALSE(is_cut(anna));
}

TEST_F(ResettingConnections, AreCutForManyResets) {
    const std::uint64_t anna = connect("anna"), berta = connect("berta");
    reset_calls(berta, limits_.max_resets);
    reset_calls(anna, limits_.max_resets);
    EXPECT_FALSE(is_cut(anna));
    reset_calls(anna, 1);
    EXPECT_TRUE(is_cut(anna));
    EXPECT_FALSE(is_cut(berta));
    EXPECT_EQ(watch_.check(now_), 1u);
}

TEST_F(ResettingConnections, AreNotCutForSlowResets) {
    const std::uint64_t anna = connect("anna");
    for (int second = 0; second < 20; ++second) {
        reset_calls(anna, limits_.resets_per_second);
        now_ += 1s;
    }
    EXPECT_FALSE(is_cut(anna));
}

TEST_F(ResettingConnections, AreNotCutForThoseOfOthersOfTheirClient) {
    const std::uint64_t good = connect("anna"), bad = connect("anna");
    reset_calls(bad, limits_.max_resets + 1);
    EXPECT_TRUE(is_cut(bad));
    reset_calls(good, limits_.tolerated_resets);
    EXPECT_FALSE(is_cut(good));
    reset_calls(good, 1);
    EXPECT_TRUE(is_cut(good));
}

TEST_F(ResettingConnections, AreAdmittedAgainAfterAPause) {
    reset_calls(connect("anna"), limits_.max_resets + 1);
    EXPECT_TRUE(is_cut(connect("anna", ConnectionWatch::Admission::paused)));
    EXPECT_FALSE(is_cut(connect("berta")));
    now_ += limits_.pause;
    const std::uint64_t again = connect("anna");
    EXPECT_FALSE(is_cut(again));
    reset_calls(again, limits_.max_resets - 10);
    EXPECT_TRUE(is_cut(again)) << "the earlier resets are forgotten";
}

TEST_F(ResettingConnections, DoNotCountCallsThatEndWithTheirConnection) {
    const std::uint64_t closed = connect("anna"), open = connect("anna");
    others_.at(closed - 1) = {};
    reset_calls(closed, limits_.max_resets);
    reset_calls(open, limits_.tolerated_resets + 1);
    EXPECT_FALSE(is_cut(open));
}

}  // namespace
}  // namespace octopair::service
