// Tests jobs that are submitted and collected. Every call finds the pairs of the local engine, and each id runs only
// one job.
#include "service/detached/detached_server.hpp"
#include "support/compare.hpp"

namespace octopair::test {
namespace {

TEST(Submitted, FindsWhatTheLocalEngineFinds) {
    const DetachedServer server;
    const auto client = server.client();
    const auto boxes = make_boxes("clustered", 30000, 1), others = make_boxes("clustered", 500, 2);
    const auto wide = make_double_boxes("uniform", 3000, 3);
    const std::vector<double> padding(3000, 0.01);
    const Objects first{std::span(boxes), {}}, second{std::span(others), {}}, padded{std::span(wide), padding};
    const std::vector<Work> works = {Work(first), Work(first, second),
                                     Work(padded, {.order = Order::octal, .margin = 0.02}),
                                     Work(first, {.limit = 1000}), Work(Objects{std::span(boxes).first(0), {}})};
    std::vector<std::string> ids;
    for (const auto& work : works) ids.push_back(submit(*client, work));
    for (std::size_t i = 0; i < works.size(); ++i) {
        EXPECT_TRUE(same_bytes(pairs_there(*client, ids[i]), pairs_here(works[i]))) << i;
    }
}

TEST(Submitted, CountsAlone) {
    const DetachedServer server;
    const auto client = server.client();
    const auto boxes = make_boxes("dense", 5000, 1);
    Work work(Objects{std::span(boxes), {}});
    work.terms.count_only = true;
    const std::string id = submit(*client, work);
    PairList pairs;
    EXPECT_EQ(client->result(id, pairs).pairs, pairs_here(work).size());
    EXPECT_EQ(pairs.size(), 0u);
    EXPECT_TRUE(client->status(id).count_only);
}

TEST(Submitted, IsTheSameJobUnderItsName) {
    const DetachedServer server;
    const auto client = server.client();
    const auto boxes = make_boxes("uniform", 5000, 1);
    Work work(Objects{std::span(boxes), {}});
    work.terms.id = some_id;
    EXPECT_EQ(submit(*client, work), some_id);
    EXPECT_EQ(submit(*client, work), some_id);
    (void)client->wait(some_id, std::chrono::minutes(1));
    EXPECT_EQ(submit(*client, work), some_id);
    EXPECT_EQ(client->list().size(), 1u);
    EXPECT_EQ(server.files(".job").size(), 1u);
    work.options.margin = 1;
    EXPECT_NE(test::error_of(ErrorCode::bad_input, [&] { submit(*client, work); }).find("other input"),
              std::string::npos);
    EXPECT_TRUE(comes_true([&] { return server.files(".part").empty(); }));
}

TEST(Submitted, NeedsAStateFolder) {
    const DetachedServer server([](service::ServerOptions& options) { options.state_folder.clear(); });
    const std::vector<Box3f> boxes(3);
    const std::string words = test::error_of(ErrorCode::usage, [&] {
        server.client()->submit({std::span(boxes), {}});
    });
    EXPECT_NE(words.find("state folder"), std::string::npos) << words;
}

TEST(Submitted, RefusesWhatIsNoJob) {
    const DetachedServer server;
    const auto client = server.client();
    const std::vector<Box3f> boxes(3);
    const std::vector<double> padding(2);
    EXPECT_NE(test::error_of(ErrorCode::bad_input,
                             [&] {
                                 client->submit({std::span(boxes), padding});
                             })
                  .find("padding"),
              std::string::npos);
    (void)test::error_of(ErrorCode::bad_input, [&] { client->submit({std::span(boxes), {}}, {}, {.id = "x"}); });
    EXPECT_TRUE(client->list().empty());
}

TEST(Submitted, FailsForInvalidBoxes) {
    const DetachedServer server;
    const auto client = server.client();
    const std::vector<Box3f> boxes = {{{0, 0, 0}, {1, 1, 1}}, {{1, 0, 0}, {0, 1, 1}}};
    const std::string id = client->submit({std::span(boxes), {}});
    const JobStatus status = client->wait(id, std::chrono::minutes(1));
    ASSERT_EQ(int(status.state), int(JobState::failed));
    PairList pairs;
    const std::string words = test::error_of(ErrorCode::bad_input, [&] { client->result(id, pairs); });
    EXPECT_EQ(words, status.error->what());
    EXPECT_NE(words.find("object 1"), std::string::npos) << words;
}

}  // namespace
}  // namespace octopair::test
