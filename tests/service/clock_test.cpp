// Tests changes of the system clock by a day, forward or back, while jobs run. Timeouts use a monotonic clock.
#include <gtest/gtest.h>

#include <filesystem>
#include <optional>
#include <thread>

#include "io/temporary.hpp"
#include "processes/leftovers.hpp"
#include "service/raw_call.hpp"
#include "service/served.hpp"
#include "service/server_program.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

using std::chrono::milliseconds;
using std::chrono::minutes;

constexpr const char* fake_time = "/usr/lib/x86_64-linux-gnu/faketime/libfaketimeMT.so.1";

class ServerClock : public ::testing::TestWithParam<const char*> {
protected:
    void SetUp() override {
        if (sanitized) GTEST_SKIP() << "a sanitizer must be loaded before libfaketime";
        ASSERT_TRUE(std::filesystem::exists(fake_time)) << "install the package faketime";
        write_file(folder_.file("time"), "+0");
    }
    /// Returns the setting of a server whose clock this test changes.
    ServerProgram::Setting setting() const {
        return {.environment = std::string("LD_PRELOAD=") + fake_time + " DONT_FAKE_MONOTONIC=1 FAKETIME_NO_CACHE=1 " +
                               "FAKETIME_TIMESTAMP_FILE='" + folder_.file("time") + "'"};
    }
    /// Removes the shared memory of faketime, which a killed server leaves behind.
    static void remove_leftovers(pid_t id) {
        for (const char* const name : {"/dev/shm/faketime_shm_", "/dev/shm/sem.faketime_sem_"}) {
            std::filesystem::remove(name + std::to_string(id));
        }
    }
    void TearDown() override {
        if (!server_) return;
        const pid_t id = server_->id();
        server_.reset();
        remove_leftovers(id);
    }
    ServerProgram& serve(const std::string& arguments) {
        ServerProgram::Setting with = setting();
        with.arguments += arguments;
        return server_.emplace(with);
    }
    void set_clock() const { write_file(folder_.file("time"), GetParam()); }

    const TemporaryDirectory folder_;
    std::optional<ServerProgram> server_;
};

INSTANTIATE_TEST_SUITE_P(, ServerClock, ::testing::Values("+1d", "-1d"),
                         [](const auto& one) { return std::string(one.param[0] == '+' ? "Forward" : "Back"); });

TEST_P(ServerClock, IsSetWhileAJobRuns) {
    ServerProgram& server = serve("");
    const auto engine = connect(server.address(), {.patience = minutes(1)});
    const std::vector<Box3f> heap(40'000);
    Job job = engine->submit_stream(heap, {});
    const auto channel = open_channel(server.address());
    const auto spec = spec_of(1000);
    RawCall upload(channel);
    ASSERT_TRUE(upload.write(upload_of(&spec, {})));
    std::this_thread::sleep_for(milliseconds(200));
    EXPECT_EQ(job.state(), JobState::running);
    set_clock();
    EXPECT_EQ(job.summary().pairs, heap.size() * (heap.size() - 1) / 2);
    // By default an upload may stall for a minute, which has not passed.
    ASSERT_TRUE(upload.write(upload_of(nullptr, bytes_of_boxes(1000))));
    EXPECT_TRUE(upload.finish().ok());
    check_serves(server.address());
    server.signal(SIGTERM);
    EXPECT_EQ(server.wait(), 0) << server.log();
}

TEST_P(ServerClock, WhatTakesTooLongStillEnds) {
    ServerProgram& server = serve(" --max-seconds 3 --stall 3");
    const auto engine = connect(server.address(), {.patience = minutes(1)});
    const std::vector<Box3f> heap(400'000);  // takes much longer than 3 s to count
    Job job = engine->submit_stream(heap, {});
    const auto channel = open_channel(server.address());
    const auto spec = spec_of(1000);
    RawCall upload(channel);
    ASSERT_TRUE(upload.write(upload_of(&spec, {})));
    while (job.state() == JobState::queued) std::this_thread::sleep_for(milliseconds(10));
    set_clock();
    ASSERT_TRUE(job.wait_for(minutes(2)));
    expect_error(ErrorCode::resource_limit, "job_seconds", [&] { (void)job.summary(); });
    EXPECT_EQ(failure_in(upload.finish()).limit(), "stall_seconds");
    check_serves(server.address());
}

}  // namespace
}  // namespace octopair::test
