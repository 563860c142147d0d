// Tests when connections of an address wait whose earlier connection was cut.
#include "service/server/net/connection_watch.hpp"

#include <gtest/gtest.h>
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
        refuse_calls(address, port, terms_.max_refused_calls + 1);
        EXPECT_EQ(watch_.unknown(), 0u);
    }
    std::size_t ready_after(std::chrono::milliseconds time) {
        now_ += time;
        return watch_.take_ready(now_).size();
    }

    const ConnectionWatch::Terms terms_;
    ConnectionWatch watch_{terms_};
    ConnectionWatch::Clock::time_point now_ = ConnectionWatch::Clock::now();
    std::vector<Descriptor> others_;
};

TEST_F(PacedConnections, WaitForNothingAtFirst) {
    for (int port = 1; port <= 20; ++port) connect("a", port);
    EXPECT_EQ(ready_after(0ms), 20u);
    refuse_calls("a", 1, terms_.max_refused_calls);
    connect("a", 21);
    EXPECT_EQ(ready_after(0ms), 1u);
    EXPECT_EQ(watch_.waiting(), 0u);
}

TEST_F(PacedConnections, FollowEachOtherSlowlyAfterACut) {
    get_cut("a", 1);
    for (int port = 2; port <= 4; ++port) connect("a", port);
    EXPECT_EQ(watch_.waiting(), 3u);
    EXPECT_EQ(ready_after(0ms), 0u);
    EXPECT_EQ(ready_after(terms_.interval - 1ms), 0u);
    EXPECT_EQ(ready_after(1ms), 1u);
    EXPECT_EQ(ready_after(terms_.interval / 2), 0u);
    EXPECT_EQ(ready_after(terms_.interval), 1u);
    EXPECT_EQ(ready_after(terms_.interval), 1u);
    EXPECT_EQ(watch_.waiting(), 0u);
    EXPECT_EQ(watch_.make_known(name("a", 4), "client"), ConnectionWatch::Admission::known_now);
}

TEST_F(PacedConnections, OfOtherAddressesDoNotWait) {
    get_cut("a", 1);
    connect("a", 2);
    connect("b", 1);
    EXPECT_EQ(ready_after(0ms), 1u);
    EXPECT_EQ(watch_.make_known(name("b", 1), "client"), ConnectionWatch::Admission::known_now);
}

TEST_F(PacedConnections, DoNotWaitWhenTheCutIsLongAgo) {
    get_cut("a", 1);
    now_ += terms_.remembered + 1ms;
    (void)watch_.check(now_);
    for (int port = 2; port <= 9; ++port) connect("a", port);
    EXPECT_EQ(ready_after(0ms), 8u);
}

}  // namespace
}  // namespace octopair::service
