// Tests that the server's log reports detached jobs in the same way as other jobs.
#include <unistd.h>

#include "service/detached/detached_server.hpp"
#include "service/metrics_page.hpp"
#include "service/raw_call.hpp"

namespace octopair::test {
namespace {

void show_metrics(service::ServerOptions& options) { options.metrics = service::parse_address("localhost:0"); }

TEST(DetachedServerLog, CountsJobs) {
    const DetachedServer server(show_metrics);
    const auto client = server.client();
    const auto boxes = make_boxes("uniform", 1000, 1);
    const std::string id = client->submit({boxes});
    EXPECT_EQ(pairs_there(*client, id), pairs_here(Work(Objects{boxes})));
    EXPECT_TRUE(page_has(server.words(), "octopair_jobs_ended_total{outcome=\"done\"} 1"));
    for (const std::string state : {"uploading", "queued", "running"}) {
        EXPECT_TRUE(page_has(server.words(), "octopair_jobs{state=\"" + state + "\"} 0"));
    }
    EXPECT_TRUE(page_has(server.words(), "octopair_memory_bytes 0"));
    const std::string page = metrics_page(server.log());
    for (const std::string direction : {"received", "sent"}) {
        EXPECT_FALSE(has_text(page, "octopair_" + direction + "_bytes_total 0\n"));
    }
    EXPECT_TRUE(has_text(server.log(), "job ended"));
}

/// Each call that makes, reads or ends a job has a line, and each connection.
TEST(DetachedServerLog, HasALineForEachCallAboutAJob) {
    const DetachedServer server;
    const auto client = server.client();
    const std::vector<Box3f> boxes(3), same(1'000'000);
    const std::string id = client->submit({boxes}), endless = client->submit({same}, {}, {.count_only = true});
    (void)pairs_there(*client, id);
    (void)client->cancel(endless);
    client->release(id);
    (void)client->submit({boxes}, {}, {.id = some_id});
    (void)error_of(ErrorCode::bad_input, [&] { client->submit({same}, {}, {.id = some_id}); });
    const auto has = [&](const std::string& line) { return server.log().find(line) != std::string::npos; };
    const std::string owner = ",\"owner\":\"local\"", job = "{\"id\":\"" + id + "\"" + owner;
    for (const std::string& line :
         {"submit\x1f" + job + ",\"peer\":\"unix:\",\"objects\":3,\"bytes\":72}",
          "result\x1f" + job + ",\"client\":\"local\",\"peer\":\"unix:\",\"offset\":0,\"bytes\":",
          "release\x1f" + job + ",\"client\":\"local\",\"peer\":\"unix:\"}",
          "cancel\x1f{\"id\":\"" + endless + "\"" + owner, std::string("call failed\x1f{\"client\":\"local\""),
          "connected\x1f{\"peer\":\"unix:user=" + std::to_string(::geteuid()) +
              ",process=" + std::to_string(::getpid())})
        EXPECT_TRUE(comes_true([&] { return has(line); })) << line << " is not in\n" << server.log();
    EXPECT_TRUE(has(",\"outcome\":\"complete\"}"));
}

TEST(DetachedServerLog, CountsRefusals) {
    const DetachedServer server([](service::ServerOptions& options) {
        show_metrics(options);
        options.limits.objects = 2;
    });
    const auto boxes = make_boxes("uniform", 3, 1);
    EXPECT_NE(error_of(ErrorCode::resource_limit, [&] { server.client()->submit({boxes}); }), "");
    EXPECT_TRUE(page_has(server.words(), "octopair_refusals_total{limit=\"objects\"} 1"));
}

/// Complete messages that hold almost no data.
TEST(DetachedServerLog, CountsUploadsThatStall) {
    const DetachedServer server([](service::ServerOptions& options) {
        show_metrics(options);
        options.stall = std::chrono::seconds(1);
    });
    const auto spec = spec_of(100'000);
    RawCall call(open_channel(server.address()), "Submit");
    ASSERT_TRUE(call.write(upload_of(&spec, {})));
    EXPECT_TRUE(comes_true([&] {
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
        return !call.write(upload_of(nullptr, "x"));
    }));
    const grpc::Status status = call.finish();
    EXPECT_EQ(failure_in(status).limit(), "stall_seconds") << status.error_message();
    EXPECT_TRUE(page_has(server.words(), "octopair_refusals_total{limit=\"stall_seconds\"} 1"));
    EXPECT_TRUE(comes_true([&] { return server.files().empty(); }));
}

}  // namespace
}  // namespace octopair::test
