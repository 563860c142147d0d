// Tests detached jobs during shutdown: the server waits for running jobs and leaves queued jobs for the next server.

#include "service/detached/detached_server.hpp"
#include "service/server/jobs/job_scheduler.hpp"
#include "service/server/jobs/server_job.hpp"
#include "service/server/jobs/uploaded_input.hpp"

namespace octopair::test {
namespace {

TEST(Drained, WaitsForWhatRuns) {
    DetachedServer server([](service::ServerOptions& options) { options.grace = std::chrono::hours(1); });
    const auto client = server.client();
    const auto boxes = make_boxes("dense", 600000, 1);
    const std::string id = client->submit({boxes});
    ASSERT_TRUE(comes_true([&] { return client->status(id).state != JobState::queued; }));
    server.drain();
    EXPECT_EQ(server.files(".result").size(), 1u);
    server.restart();
    EXPECT_EQ(int(client->status(id).state), int(JobState::done));
}

TEST(Drained, LeavesWhatOutlastsItsGrace) {
    DetachedServer server([](service::ServerOptions& options) { options.grace = std::chrono::seconds(0); });
    const auto client = server.client();
    // Counting all pairs of a million equal boxes takes hours.
    const std::vector<Box3f> same(1'000'000, Box3f{{0, 0, 0}, {1, 1, 1}});
    Work work(Objects{same});
    work.terms.count_only = true;
    const std::string id = submit(*client, work);
    ASSERT_TRUE(comes_true([&] { return client->status(id).state == JobState::running; }));
    server.drain();
    server.stop();
    EXPECT_EQ(server.files(".job").size(), 1u);
    EXPECT_EQ(server.files().size(), 1u);
    EXPECT_FALSE(has_text(server.log(), "cancelled"));
    server.start();
    EXPECT_TRUE(comes_true([&] { return client->status(id).state == JobState::running; }));
    EXPECT_EQ(int(client->cancel(id).state), int(JobState::cancelled));
    EXPECT_EQ(server.files(".result").size(), 1u);
}

class NoRecord final : public service::JobRecord {
public:
    std::string hash() const override { return "hash"; }
    std::optional<service::Budget::Reservation> ask_memory() override { return service::Budget::Reservation(); }
    std::unique_ptr<service::UploadedInput> load(const std::shared_ptr<Engine>& engine,
                                                 const std::stop_token&) const override {
        return std::make_unique<service::UploadedInput>(v1::JobSpec(), engine);
    }
    void end(const v1::JobReport&) override {}
    void wait_for_room(const service::NoRoomError&, std::chrono::duration<double>) override {}
    bool has_room() override { return true; }
    void run_on_disk_queue(std::function<void()> task) override { task(); }
};

/// Tests jobs without objects in their own scheduler.
class DrainedScheduler : public ::testing::Test {
protected:
    std::shared_ptr<service::ServerJob> queued_job(bool detached) {
        service::ServerJob::Parts parts;
        if (detached)
            parts.record = std::make_shared<NoRecord>();
        else
            parts.input = std::make_unique<service::UploadedInput>(parts.spec, engine_);
        parts.pairs = std::make_shared<service::PairsInMemory>(memory_, 0);
        auto job = std::make_shared<service::ServerJob>(std::move(parts));
        job->queue();
        return job;
    }
    static std::unique_ptr<Engine> make(unsigned width) { return make_local_engine(width); }

    service::Budget memory_{"memory_bytes", "bytes of memory", 0};
    const std::shared_ptr<Engine> engine_ = make_local_engine(1);
};

TEST_F(DrainedScheduler, BeginNoDetachedJobs) {
    const auto before = queued_job(true), held = queued_job(true), attached = queued_job(false);
    service::JobScheduler engine_widths({make, make}, {1, 1, 0});
    engine_widths.add(before);
    EXPECT_TRUE(comes_true([&] { return before->ended(); }));
    engine_widths.hold_detached();
    engine_widths.add(held);
    engine_widths.add(attached);
    EXPECT_TRUE(comes_true([&] { return attached->ended(); }));
    EXPECT_EQ(int(held->state()), int(v1::QUEUED));
}

TEST_F(DrainedScheduler, RunNoDetachedJobsAtOnce) {
    const auto detached = queued_job(true), attached = queued_job(false);
    service::JobScheduler engine_widths({make, make}, {1, 1, 1});
    engine_widths.hold_detached();
    engine_widths.add(attached);
    EXPECT_TRUE(attached->ended());
    engine_widths.add(detached);
    EXPECT_EQ(int(detached->state()), int(v1::QUEUED));
}

}  // namespace
}  // namespace octopair::test
