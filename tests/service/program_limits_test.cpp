// Tests a server with few descriptors or little memory: the server reports the shortage and keeps running.
#include <gtest/gtest.h>
#include <signal.h>

#include "engine/jobs.hpp"
#include "processes/leftovers.hpp"
#include "service/raw_socket.hpp"
#include "service/served.hpp"
#include "service/server_program.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

using std::chrono::milliseconds;
using std::chrono::minutes;
using std::chrono::seconds;

TEST(ServerProgramLimits, ConnectionsFitTheDescriptors) {
    if (sanitized) GTEST_SKIP() << "the sanitizer opens descriptors to check types";
    ServerProgram server({.before = "ulimit -n 296;"});
    const auto engine = connect(server.address(), {.patience = minutes(1)});
    std::vector<RawSocket> held;
    for (int i = 0; i < 100; ++i) held.emplace_back(server.address());
    EXPECT_TRUE(has_text(held.back().receive(minutes(1)), "at most 100 connections"));
    EXPECT_EQ(engine->count_pairs(objects_of(touching_boxes)), 1u);
}

TEST(ServerProgramLimits, OfDescriptors) {
    if (sanitized) GTEST_SKIP() << "the sanitizer opens descriptors to check types";
    ServerProgram server({.before = "ulimit -n 60;"});
    check_serves(server.address());
    const auto engine = connect(server.address(), {.patience = minutes(1)});
    std::vector<RawSocket> held;
    std::optional<ErrorCode> code;
    // The server ends connections that are silent for 10 s. A busy machine may need as long for this step.
    for (int attempt = 0; attempt < 3 && code != ErrorCode::resource_limit; ++attempt) {
        held.clear();
        for (int i = 0; i < 80; ++i) held.emplace_back(server.address());
        EXPECT_TRUE(has_text(held.back().receive(minutes(1)), "no more descriptors"));
        code = code_of([&] { (void)connect(server.address(), {.connect_timeout = seconds(2)}); });
    }
    EXPECT_EQ(code, ErrorCode::resource_limit);
    EXPECT_EQ(engine->count_pairs(objects_of(touching_boxes)), 1u);
    EXPECT_TRUE(server.lives());
    held.clear();
    check_serves(server.address());
}

TEST(ServerProgramLimits, OfAddressSpace) {
    if (sanitized) GTEST_SKIP() << "sanitizers map terabytes";
    // With a malloc arena for every thread, gRPC itself would run out of memory.
    ServerProgram server({.arguments = "--engine local --threads 1", .before = "export MALLOC_ARENA_MAX=2;"});
    check_serves(server.address());
    const auto engine = connect(server.address(), {.patience = milliseconds(300)});
    server.limit_memory(std::uint64_t(300) << 20);
    const std::vector<Box3f> many(20'000'000), crowd(20'000);  // 480 MB of boxes; 1.6 GB of pairs
    const auto too_many = [&] { (void)engine->count_pairs({many}, {.limit = 1}); };
    PairList list;
    const auto too_crowded = [&] { (void)engine->find_pairs({crowd}, list); };
    for (int i = 0; i < 2; ++i) {
        EXPECT_EQ(code_of(too_many), ErrorCode::resource_limit);
        EXPECT_EQ(code_of(too_crowded), ErrorCode::resource_limit);
        EXPECT_TRUE(server.lives()) << server.log();
        EXPECT_EQ(engine->count_pairs(objects_of(touching_boxes)), 1u);
    }
}

TEST(ServerProgramLimits, OfPairsThatArePutInOrder) {
    if (sanitized) GTEST_SKIP() << "the memory of the sanitizer would count";
    ServerProgram server({.arguments = "--engine local --threads 1 --max-memory 64M"});
    check_serves(server.address());
    const auto engine = connect(server.address(), {.patience = milliseconds(300)});
    const std::vector<Box3f> crowd(12'000);  // 576 MB of pairs
    PairList list;
    const auto call = [&] { (void)engine->find_pairs({crowd}, list, {Order::ascending}); };
    EXPECT_EQ(code_of(call), ErrorCode::resource_limit);
    EXPECT_LT(server.memory(), std::uint64_t(300) << 20);
}

TEST(ServerProgramLimits, EndsWhenAskedTo) {
    for (const int signal : {SIGTERM, SIGINT}) {
        ServerProgram server;
        check_serves(server.address());
        server.signal(signal);
        EXPECT_EQ(server.wait(), 0) << server.log();
    }
}

}  // namespace
}  // namespace octopair::test
