// Tests jobs that are submitted and collected. Every call finds the pairs of the local engine, and each id runs only
// one job.
#include "service/detached/detached_server.hpp"

namespace octopair::test {
namespace {

class Submitted : public DetachedTest {};

TEST_F(Submitted, FindsWhatTheLocalEngineFinds) {
    const auto boxes = make_boxes("clustered", 30000, 1), others = make_boxes("clustered", 500, 2);
    const auto wide = make_double_boxes("uniform", 3000, 3);
    const std::vector<double> padding(3000, 0.01);
    const Objects first{boxes}, second{others}, padded{std::span(wide), padding};
    const std::vector<Work> works = {Work(first), Work(first, second),
                                     Work(padded, {.order = Order::octal, .margin = 0.02}),
                                     Work(first, {.limit = 1000}), Work(Objects{std::span(boxes).first(0), {}})};
    std::vector<std::string> ids;
    for (const auto& work : works) ids.push_back(submit(*client_, work));
    for (std::size_t i = 0; i < works.size(); ++i) {
        EXPECT_TRUE(same_bytes(pairs_there(*client_, ids[i]), pairs_here(works[i]))) << i;
    }
}

TEST_F(Submitted, CountsAlone) {
    const auto boxes = make_boxes("dense", 5000, 1);
    Work work(Objects{boxes});
    work.terms.count_only = true;
    const std::string id = submit(*client_, work);
    PairList pairs;
    EXPECT_EQ(client_->result(id, pairs).pairs, pairs_here(work).size());
    EXPECT_EQ(pairs.size(), 0u);
    EXPECT_TRUE(client_->status(id).count_only);
}

TEST_F(Submitted, IsTheSameJobUnderItsName) {
    const auto boxes = make_boxes("uniform", 5000, 1);
    Work work(Objects{boxes});
    work.terms.id = some_id;
    EXPECT_EQ(submit(*client_, work), some_id);
    EXPECT_EQ(submit(*client_, work), some_id);
    (void)client_->wait(some_id, std::chrono::minutes(1));
    EXPECT_EQ(submit(*client_, work), some_id);
    EXPECT_EQ(client_->list().size(), 1u);
    EXPECT_EQ(server_.files(".job").size(), 1u);
    work.options.margin = 1;
    expect_error(ErrorCode::bad_input, "other input", [&] { submit(*client_, work); });
    EXPECT_TRUE(comes_true([&] { return server_.files(".part").empty(); }));
}

TEST_F(Submitted, NeedsAStateFolder) {
    const DetachedServer server([](service::ServerOptions& options) { options.state_folder.clear(); });
    const std::vector<Box3f> boxes(3);
    expect_error(ErrorCode::usage, "state folder", [&] { server.client()->submit({boxes}); });
}

TEST_F(Submitted, RefusesWhatIsNoJob) {
    const std::vector<Box3f> boxes(3);
    const std::vector<double> padding(2);
    expect_error(ErrorCode::bad_input, "padding", [&] { client_->submit({std::span(boxes), padding}); });
    (void)error_of(ErrorCode::bad_input, [&] { client_->submit({boxes}, {}, {.id = "x"}); });
    EXPECT_TRUE(client_->list().empty());
}

TEST_F(Submitted, FailsForInvalidBoxes) {
    const std::vector<Box3f> boxes = {{{0, 0, 0}, {1, 1, 1}}, {{1, 0, 0}, {0, 1, 1}}};
    const std::string id = client_->submit({boxes});
    const JobStatus status = client_->wait(id, std::chrono::minutes(1));
    ASSERT_EQ(int(status.state), int(JobState::failed));
    PairList pairs;
    const std::string words = error_of(ErrorCode::bad_input, [&] { client_->result(id, pairs); });
    EXPECT_EQ(words, status.error->what());
    EXPECT_TRUE(has_text(words, "object 1"));
}

}  // namespace
}  // namespace octopair::test
