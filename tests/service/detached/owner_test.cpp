// Tests that only the owner of a job has access to the job.
#include <sys/stat.h>

#include "service/detached/detached_server.hpp"

namespace octopair::test {
namespace {

TEST(Owner, AloneSeesAJob) {
    const TemporaryDirectory files;
    write_file(files.file("tokens"), "anna annas-secret-token\nbert berts-secret-token\n");
    ASSERT_EQ(::chmod(files.file("tokens").c_str(), 0600), 0);
    DetachedServer server([&](service::ServerOptions& options) { options.token_file = files.file("tokens"); });
    const auto anna = server.client("annas-secret-token"), bert = server.client("berts-secret-token");
    const std::vector<Box3f> boxes = {{{0, 0, 0}, {1, 1, 1}}, {{1, 0, 0}, {2, 1, 1}}};
    Work work(Objects{boxes});
    work.terms.id = some_id;
    (void)submit(*anna, work);
    for (int i = 0; i < 2; ++i) {
        const auto refused = [&](const auto& call) {
            EXPECT_EQ(error_of(ErrorCode::bad_input, call), "there is no job " + some_id);
        };
        PairList pairs;
        refused([&] { bert->status(some_id); });
        refused([&] { bert->wait(some_id, std::chrono::seconds(10)); });
        refused([&] { bert->cancel(some_id); });
        refused([&] { bert->release(some_id); });
        refused([&] { bert->result(some_id, pairs); });
        EXPECT_TRUE(bert->list().empty());
        EXPECT_EQ(anna->list().size(), 1u);
        expect_result(*anna, some_id, work);
        server.restart();
    }
    (void)submit(*bert, work);
    anna->release(some_id);
    expect_result(*bert, some_id, work);
}

}  // namespace
}  // namespace octopair::test
