// Tests very many connections and very many jobs. With OCTOPAIR_TEST_FULL=1: ten thousand connections and a hundred
// thousand jobs.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <atomic>
#include <cstdlib>
#include <thread>

#include "engine/jobs.hpp"
#include "processes/leftovers.hpp"
#include "service/raw_call.hpp"
#include "service/raw_socket.hpp"
#include "service/served.hpp"
#include "service/server_program.hpp"
#include "support/kinds.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

using std::chrono::minutes;

bool is_full() { return std::getenv("OCTOPAIR_TEST_FULL") != nullptr; }

constexpr std::uint64_t memory_bound = std::uint64_t(sanitized ? 2000 : 400) << 20;

/// Raises the limit on descriptors as far as the system permits. Returns the limit.
std::uint64_t raise_descriptors() {
    rlimit limit{};
    (void)::getrlimit(RLIMIT_NOFILE, &limit);
    limit.rlim_cur = limit.rlim_max;
    (void)::setrlimit(RLIMIT_NOFILE, &limit);
    (void)::getrlimit(RLIMIT_NOFILE, &limit);
    return limit.rlim_cur;
}

TEST(Floods, OfConnections) {
    const std::uint64_t step = std::min<std::uint64_t>(5000, raise_descriptors() - 200);
    const std::uint64_t all = is_full() ? 10'000 : scaled(4000, 2);
    ServerProgram server({.before = "ulimit -n 4000;"});
    const auto engine = connect(server.address(), {.patience = minutes(1)});
    const std::uint64_t before = server.memory();
    std::uint64_t refused = 0;
    for (std::uint64_t made = 0; made < all;) {
        std::vector<RawSocket> held;
        for (; made < all && held.size() < step; ++made) held.emplace_back(server.address());
        EXPECT_EQ(engine->count_pairs(objects_of(touching_boxes)), 1u);
        if (held.size() > 1000) {
            ASSERT_TRUE(held.back().is_closed_within(minutes(1)));
            ++refused;
        }
        EXPECT_LT(server.descriptors(), 1200u);
        EXPECT_LT(server.memory(), before + memory_bound);
    }
    EXPECT_GT(refused, 0u);
    EXPECT_TRUE(server.lives());
    check_serves(server.address());
    EXPECT_TRUE(comes_true([&] { return server.descriptors() < 100; }, minutes(1))) << server.descriptors();
}

TEST(Floods, OfSmallJobs) {
    ServerProgram server;
    const auto engine = connect(server.address(), {.patience = minutes(1)});
    const std::uint64_t each = (is_full() ? 100'000 : scaled(12'000, 12)) / 4;
    const std::vector<Box3f> boxes = make_boxes("dense", 20, 1);
    std::atomic<std::uint64_t> wrong = 0;
    std::vector<std::jthread> clients;
    const std::uint64_t before = server.memory();
    for (int i = 0; i < 4; ++i) {
        clients.emplace_back([&] {
            const auto own = connect(server.address(), {.patience = minutes(1)});
            const std::uint64_t right = make_local_engine(1)->count_pairs({boxes});
            for (std::uint64_t n = 0; n < each; ++n) wrong += own->count_pairs({boxes}) != right;
        });
    }
    const std::vector<Box3f> large = make_boxes("dense", scaled(200'000, 4), 1);
    EXPECT_EQ(engine->count_pairs({large}), make_local_engine(1)->count_pairs({large}));
    clients.clear();
    EXPECT_EQ(wrong, 0u);
    EXPECT_LT(server.memory(), before + memory_bound);
    EXPECT_LT(server.descriptors(), 100u);
}

/// Many simultaneous calls on one connection, all without progress.
TEST(Floods, OfCallsThatStandStill) {
    const Served served([](service::ServerOptions& options) { options.stall = std::chrono::seconds(2); });
    const auto channel = open_channel(served.address());
    const auto engine = served.client();
    const std::uint64_t most = service::ServerLimits().jobs_per_client;
    std::vector<std::unique_ptr<RawCall>> calls;
    std::uint64_t refused = 0;
    for (std::uint64_t i = 0; i < most + 20; ++i) {
        const auto spec = spec_of(1000);
        calls.push_back(std::make_unique<RawCall>(channel));
        (void)calls.back()->write(upload_of(&spec, {}));
    }
    for (const auto& call : calls) {
        const std::string limit = failure_in(call->finish()).limit();
        EXPECT_TRUE(limit == "jobs_per_client" || limit == "stall_seconds") << limit;
        refused += limit == "jobs_per_client";
    }
    EXPECT_EQ(refused, 20u);
    EXPECT_TRUE(served.comes_to_rest());
    EXPECT_EQ(engine->count_pairs(objects_of(touching_boxes)), 1u);
}

}  // namespace
}  // namespace octopair::test
