// Tests jobs that wait for their turn or for memory. Callers can cancel such jobs or wait for them. The next server
// runs the jobs that a server left unfinished.
#include <atomic>
#include <thread>

#include "service/detached/detached_server.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

/// Returns boxes for some tenths of a second of work, more than a small job may have.
std::vector<Box3f> many_boxes() { return make_boxes("dense", 1500000, 1); }

class Waiting : public DetachedTest {};

TEST_F(Waiting, IsForMemory) {
    const std::uint64_t one = 15000 * (24 + 80);
    const DetachedServer server([&](service::ServerOptions& options) { options.limits.memory_bytes = one + one / 2; });
    const auto client = server.client();
    const auto boxes = make_boxes("uniform", 15000, 1), more = make_boxes("uniform", 25000, 2);
    std::vector<std::string> ids;
    ids.reserve(8);
    for (int i = 0; i < 8; ++i) ids.push_back(client->submit({boxes}));
    for (const auto& id : ids) expect_done(*client, id);
    expect_error(ErrorCode::resource_limit, "bytes of memory", [&] { client->submit({more}); });
}

TEST_F(Waiting, EndsWithTheTimeOrTheJob) {
    const auto boxes = many_boxes();
    const std::string id = client_->submit({boxes});
    EXPECT_FALSE(client_->wait(id, std::chrono::milliseconds(1)).ended());
    EXPECT_FALSE(client_->wait(id, std::chrono::seconds(-1)).ended());
    expect_done(*client_, id);
}

TEST_F(Waiting, CanBeCancelled) {
    // Counting all pairs of a million equal boxes takes hours.
    const std::vector<Box3f> same(1'000'000, Box3f{{0, 0, 0}, {1, 1, 1}});
    const JobTerms count{.count_only = true};
    const std::string running = client_->submit({same}, {}, count), queued = client_->submit({same}, {}, count);
    ASSERT_TRUE(comes_true([&] { return client_->status(running).state == JobState::running; }));
    EXPECT_EQ(client_->status(queued).queued_before, 0u);
    expect_error(ErrorCode::bad_input, "has not ended", [&] { client_->release(queued); });
    for (const auto& id : {queued, running}) EXPECT_EQ(int(client_->cancel(id).state), int(JobState::cancelled));
    PairList pairs;
    (void)error_of(ErrorCode::cancelled, [&] { client_->result(running, pairs); });
    EXPECT_EQ(server_.files(".result").size(), 2u);
    client_->release(queued);
    EXPECT_EQ(server_.files().size(), 2u);
}

TEST_F(Waiting, HoldsACallOfItsClient) {
    const DetachedServer server([](service::ServerOptions& options) { options.limits.calls_per_client = 4; });
    const auto client = server.client();
    const std::vector<Box3f> same(1'000'000, Box3f{{0, 0, 0}, {1, 1, 1}});
    const std::string id = client->submit({same}, {}, {.count_only = true});
    std::vector<std::jthread> waits;
    for (int i = 0; i < 4; ++i)
        waits.emplace_back([&](const std::stop_token& stop) {
            while (!stop.stop_requested()) {  // the status call below may have taken the last place
                try {
                    (void)client->wait(id, std::chrono::minutes(2), stop);
                } catch (const Error& error) {
                    EXPECT_TRUE(error.code() == ErrorCode::cancelled || error.code() == ErrorCode::resource_limit)
                        << error.what();
                }
            }
        });
    const auto is_refused = [&] {
        try {
            (void)client->status(id);
            return false;
        } catch (const Error& error) {
            return std::string(error.what()).starts_with("calls_per_client: a client may have 4 calls");
        }
    };
    EXPECT_TRUE(comes_true(is_refused));
    waits.clear();
    EXPECT_TRUE(comes_true([&] { return !is_refused(); }));
    (void)client->cancel(id);
}

TEST_F(Waiting, GoesOnWithTheNextServer) {
    const auto boxes = many_boxes();
    const Work work(Objects{boxes});
    const std::string running = submit(*client_, work);
    ASSERT_TRUE(comes_true([&] { return client_->status(running).state != JobState::queued; }));
    const std::string queued = submit(*client_, work), gone = submit(*client_, work);
    EXPECT_EQ(int(client_->cancel(gone).state), int(JobState::cancelled));
    server_.restart();
    EXPECT_EQ(int(client_->status(gone).state), int(JobState::cancelled));
    const auto expected = pairs_here(work);
    for (const auto& id : {running, queued}) EXPECT_TRUE(same_bytes(pairs_there(*client_, id), expected));
}

TEST_F(Waiting, AttachedJobsAreSeen) {
    const auto boxes = many_boxes();
    std::atomic<bool> ended = false;
    std::thread caller([&] {
        (void)error_of(ErrorCode::cancelled,
                       [&] { (void)connect(server_.address())->stream_pairs({boxes}, [](std::span<const Pair>) {}); });
        ended = true;
    });
    std::vector<JobStatus> jobs;
    EXPECT_TRUE(comes_true([&] { return !(jobs = client_->list()).empty() || ended; }));
    ASSERT_EQ(jobs.size(), 1u);
    EXPECT_FALSE(jobs.front().detached);
    PairList pairs;
    expect_error(ErrorCode::bad_input, "not detached", [&] { client_->result(jobs.front().id, pairs); });
    (void)client_->cancel(jobs.front().id);
    caller.join();
}

TEST(WaitingAtNobody, EndsWithTheTimeForConnecting) {
    const TemporaryDirectory folder;
    JobClient client("unix:" + folder.file("nobody"),
                     {.connect_timeout = std::chrono::milliseconds(100), .patience = std::chrono::hours(1)});
    expect_error(ErrorCode::engine_failed, "no server answers", [&] { (void)client.list(); });
}

TEST(WaitingAtFirst, IsPatientWithAServerThatWasThere) {
    DetachedServer server;
    const std::vector<Box3f> crowd(scaled(60'000, 6));  // a second of work
    const std::string id = server.client()->submit({crowd}, {}, {.count_only = true});
    JobClient client(server.address(), {.connect_timeout = std::chrono::milliseconds(100)});
    std::thread away([&] {
        std::this_thread::sleep_for(std::chrono::milliseconds(300));
        server.stop();
        std::this_thread::sleep_for(std::chrono::seconds(1));
        server.start();
    });
    expect_done(client, id);
    away.join();
}

TEST(WaitingAtFirst, RefusesTokensThatCannotBeSent) {
    for (const char* const token : {"0123456789abcdef\n", "0123456789abcd\xc3\xa9"}) {
        (void)error_of(ErrorCode::usage, [&] { const JobClient client("unix:nobody", {.token = token}); });
    }
}

}  // namespace
}  // namespace octopair::test
