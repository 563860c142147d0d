// Tests the server's limits: each refusal is an Error{resource_limit} with the name and value of the limit. The next
// job within the limit is done.
#include <gtest/gtest.h>

#include <limits>

#include "engine/jobs.hpp"
#include "processes/leftovers.hpp"
#include "service/gate.hpp"
#include "service/raw_call.hpp"
#include "service/raw_socket.hpp"
#include "service/served.hpp"
#include "support/kinds.hpp"

namespace octopair::test {
namespace {

using std::chrono::minutes;
using std::chrono::seconds;

Served::Change limited(const std::function<void(service::ServerLimits&)>& change) {
    return [change](service::ServerOptions& options) { change(options.limits); };
}

std::uint64_t count(const Served& served, const std::vector<Box3f>& boxes) {
    return served.client()->count_pairs({boxes});
}

TEST(ServedLimits, OfObjects) {
    const Served served(limited([](auto& limits) { limits.objects = 100; }));
    const std::vector<Box3f> few(100), many(101), half(51);
    expect_refused("objects", 100, [&] { (void)count(served, many); });
    const auto join = [&] { (void)served.client()->count_pairs(Join{{half}, {half}}); };
    expect_refused("objects", 100, join);
    EXPECT_EQ(count(served, few), 4950u);
    EXPECT_TRUE(served.comes_to_rest());
}

TEST(ServedLimits, OfInput) {
    const Served served(limited([](auto& limits) { limits.input_bytes = 2400; }));
    const std::vector<Box3f> few(100), many(101);
    const std::vector<double> padding(100);
    expect_refused("input_bytes", 2400, [&] { (void)count(served, many); });
    const auto padded = [&] { (void)served.client()->count_pairs({std::span(few), padding}); };
    expect_refused("input_bytes", 2400, padded);
    EXPECT_EQ(count(served, few), 4950u);
    EXPECT_TRUE(served.comes_to_rest());
}

TEST(ServedLimits, OfObjectsThatNoMachineHas) {
    constexpr std::uint64_t largest32 = std::numeric_limits<std::uint32_t>::max();
    constexpr std::uint64_t largest64 = std::numeric_limits<std::uint64_t>::max();
    for (const bool limits : {true, false}) {
        const Served served(limited([&](auto& all) {
            if (!limits) all.objects = all.input_bytes = 0;
        }));
        const auto channel = open_channel(served.address());
        // For the last numbers, the number of bytes overflows to a small value.
        for (const std::uint64_t objects : {largest32, largest32 + 1, largest64, largest64 / 24 + 1,
                                            std::uint64_t(1) << 61, std::uint64_t(1) << 63}) {
            for (const bool join : {false, true}) {
                auto spec = spec_of(objects);
                if (join) spec.mutable_second()->set_objects(largest64 - objects + 2);
                SCOPED_TRACE(std::to_string(objects) + (join ? " and a second set; the sum overflows" : ""));
                RawCall call(channel);
                (void)call.write(upload_of(&spec, bytes_of_boxes(1)));
                const grpc::Status status = call.finish();
                EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED) << status.error_message();
                EXPECT_FALSE(failure_in(status).limit().empty());
                const auto small = call_small(channel, upload_of(&spec, bytes_of_boxes(1)));
                EXPECT_EQ(small.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED) << small.error_message();
            }
        }
        check_serves(served.address());
        EXPECT_TRUE(served.comes_to_rest());
    }
}

TEST(ServedLimits, OfPairsKept) {
    const Served served(limited([](auto& limits) { limits.pairs = 3000; }));
    const std::vector<Box3f> crowd(100);
    const auto engine = served.client();
    PairList list;
    const auto call = [&](std::optional<std::uint64_t> most) {
        (void)engine->find_pairs({crowd}, list, {.limit = most});
    };
    expect_refused("pairs", 3000, [&] { call({}); });
    expect_refused("pairs", 3000, [&] { call(3001); });
    EXPECT_EQ(list.size(), 0u);
    call(3000);
    EXPECT_EQ(list.size(), 3000u);
    EXPECT_EQ(count(served, crowd), 4950u);
    EXPECT_TRUE(served.comes_to_rest());
}

TEST(ServedLimits, OfMemory) {
    const Served served(limited([](auto& limits) { limits.memory_bytes = 8'000'000; }));
    const std::vector<Box3f> many(100'000), crowd(2000);  // the pairs of `crowd` exceed the limit
    expect_refused("memory_bytes", 8'000'000, [&] { (void)count(served, many); });
    EXPECT_TRUE(served.comes_to_rest());
    PairList list;
    const auto call = [&] { (void)served.client()->find_pairs({crowd}, list); };
    expect_refused("memory_bytes", 8'000'000, call);
    EXPECT_TRUE(served.comes_to_rest());
    EXPECT_EQ(count(served, crowd), 1'999'000u);
}

class GatedLimits : public ::testing::Test {
protected:
    Served serve(const std::function<void(service::ServerLimits&)>& change) {
        return Served([&](service::ServerOptions& options) {
            options.engine = gated_engines(gate_);
            options.engine_widths.instant = 0;  // instant jobs would block gRPC's threads at the gate
            options.stall = std::chrono::hours(10);
            change(options.limits);
        });
    }
    void expect_jobs_refused(const Served& served, const std::string& limit) {
        std::vector<std::unique_ptr<Engine>> engines;
        std::vector<Job> jobs;
        for (int i = 0; i < 3; ++i) {
            engines.push_back(served.client());
            jobs.push_back(engines.back()->submit(touching_boxes));
        }
        ASSERT_TRUE(comes_true([&] { return served.load().jobs == 3; }, minutes(1)));
        const std::vector<Box3f> many(60'000);
        expect_refused(limit, 3, [&] { (void)count(served, touching_boxes); });
        expect_refused(limit, 3, [&] { (void)count(served, many); });
        jobs.pop_back();
        ASSERT_TRUE(comes_true([&] { return served.load().jobs == 2; }, minutes(1)));
        gate_.open();
        EXPECT_EQ(count(served, touching_boxes), 1u);
        for (Job& job : jobs) EXPECT_EQ(job.summary().pairs, 1u);
        EXPECT_TRUE(served.comes_to_rest());
    }

    Gate gate_;
};

TEST_F(GatedLimits, OfJobs) {
    expect_jobs_refused(serve([](auto& limits) { limits.jobs = 3; }), "jobs");
}

TEST_F(GatedLimits, OfJobsOfAClient) {
    expect_jobs_refused(serve([](auto& limits) { limits.jobs_per_client = 3; }), "jobs_per_client");
}

TEST_F(GatedLimits, OfTime) {
    const Served served = serve([](auto& limits) { limits.job_seconds = 0.3; });
    const std::vector<Box3f> many(60'000);
    for (const auto& boxes : {touching_boxes, many}) {
        EXPECT_EQ(error_of(ErrorCode::resource_limit, [&] { (void)count(served, boxes); }),
                  "job_seconds: the job ran longer than 0.3 s, the limit of the server");
    }
    gate_.open();
    check_serves(served.address());
    EXPECT_TRUE(served.comes_to_rest());
}

TEST(ServedLimits, OfTimeDoNotCountTheQueue) {
    Gate gate;
    const Served served([&](service::ServerOptions& options) {
        options.engine = gated_engines(gate);
        options.engine_widths = {1, 1, 0};
        options.limits.job_seconds = 2;
    });
    const auto first = served.client(), second = served.client();
    Job before = first->submit(touching_boxes);
    ASSERT_TRUE(gate.wait_for(1));
    Job job = second->submit(touching_boxes);
    EXPECT_EQ(code_of([&] { (void)before.summary(); }), ErrorCode::resource_limit);
    ASSERT_TRUE(gate.wait_for(1));
    gate.open();
    EXPECT_EQ(job.summary().pairs, 1u);
}

class ConnectionLimits : public ::testing::TestWithParam<bool> {};

TEST_P(ConnectionLimits, SayWhy) {
    const Served served([&](service::ServerOptions& options) {
        options.limits.connections = 3;
        if (!GetParam()) options.listen = service::parse_address("127.0.0.1:0");
    });
    std::vector<std::unique_ptr<Engine>> engines;
    for (int i = 0; i < 3; ++i) engines.push_back(served.client());
    RawSocket beyond(served.address());
    (void)beyond.send(http2_preface);
    const std::string frames = beyond.receive(minutes(1));
    EXPECT_TRUE(has_text(frames, "at most 3 connections"));
    const auto call = [&] { (void)connect(served.address(), {.connect_timeout = seconds(2)}); };
    for (int i = 0; i < 4; ++i) {
        expect_error(ErrorCode::resource_limit, "no more connections", call);
    }
    EXPECT_EQ(engines[0]->count_pairs(objects_of(touching_boxes)), 1u);
    engines.pop_back();
    check_serves(served.address());
}

INSTANTIATE_TEST_SUITE_P(, ConnectionLimits, ::testing::Bool(),
                         [](const auto& one) { return std::string(one.param ? "Unix" : "Tcp"); });

TEST(ServedLimits, OfConnectionsForgetWhatWasClosed) {
    const Served served(limited([](auto& limits) { limits.connections = 5; }));
    for (int i = 0; i < 100; ++i) check_serves(served.address());
    EXPECT_LE(served.load().connections, 5u);
    const Served unlimited(limited([](auto& limits) { limits.connections = 0; }));
    for (int i = 0; i < 100; ++i) check_serves(unlimited.address());
    EXPECT_LT(unlimited.load().connections, 100u);
}

}  // namespace
}  // namespace octopair::test
