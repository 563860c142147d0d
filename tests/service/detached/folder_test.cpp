// Tests the state folder: its owner, its size limit, and the recovery after a crash.
#include <sys/stat.h>

#include "service/detached/detached_server.hpp"

namespace octopair::test {
namespace {

TEST(Folder, IsItsOwnersAndOneServers) {
    const DetachedServer server;
    struct stat status {};
    ASSERT_EQ(::stat(server.state().c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777, 0700u);
    expect_error(ErrorCode::io_failed, "another server", [&] {
        const DetachedServer other([&](service::ServerOptions& options) { options.state_folder = server.state(); });
    });
}

TEST(Folder, HasFilesForItsOwnerAlone) {
    const DetachedServer server;
    const auto client = server.client();
    const std::vector<Box3f> boxes(3);
    (void)client->wait(client->submit({boxes}), std::chrono::minutes(1));
    std::size_t files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(server.state())) {
        struct stat status {};
        ASSERT_EQ(::stat(entry.path().c_str(), &status), 0);
        EXPECT_EQ(status.st_mode & 0777, 0600u) << entry.path();
        ++files;
    }
    EXPECT_EQ(files, 4u) << "a job, its result, the lock and the version";
}

TEST(Folder, OtherKindsOfFilesDoNotStopTheServer) {
    DetachedServer server;
    server.stop();
    ASSERT_EQ(::mkfifo((server.state() + "/0000000000000007.job").c_str(), 0600), 0);
    ASSERT_EQ(::mkdir((server.state() + "/0000000000000008.job").c_str(), 0700), 0);
    server.start();
    const auto boxes = make_boxes("uniform", 1000, 1);
    const Work work(Objects{boxes});
    const auto client = server.client();
    EXPECT_TRUE(same_bytes(pairs_there(*client, submit(*client, work)), pairs_here(work)));
}

TEST(Folder, IsNotOneThatOthersMayUse) {
    const TemporaryDirectory folder;
    const std::string open = folder.file("open");
    std::filesystem::create_directory(open);
    ASSERT_EQ(::chmod(open.c_str(), 0755), 0);
    (void)error_of(ErrorCode::usage, [&] {
        const DetachedServer server([&](service::ServerOptions& options) { options.state_folder = open; });
    });
    struct stat status {};
    ASSERT_EQ(::stat(open.c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777, 0755u);
}

TEST(Folder, KeepsJobsBeyondTheLimitsOfToday) {
    DetachedServer server;
    const auto client = server.client();
    const std::vector<Box3f> crowd(60'000);  // seconds of work
    const auto boxes = make_boxes("uniform", 30'000, 1);
    const Work work(Objects{boxes});
    const std::string running = client->submit({crowd}, {}, {.count_only = true});
    const std::string queued = submit(*client, work);
    server.stop();
    server.options().limits.memory_bytes = 1 << 20;
    server.start();
    for (const std::string& id : {running, queued}) {
        const JobStatus status = client->status(id);
        ASSERT_EQ(int(status.state), int(JobState::failed));
        EXPECT_EQ(int(status.error.value().code()), int(ErrorCode::resource_limit));
    }
    const std::string small = client->submit({std::span(boxes).first(1000), {}});
    expect_done(*client, small);
    client->release(running);
    server.stop();
    server.options().limits.memory_bytes = 0;
    server.start();
    expect_result(*client, queued, work);
}

TEST(Folder, HoldsNoMoreThanItMay) {
    constexpr std::uint64_t most = 1 << 20;
    const DetachedServer server([](service::ServerOptions& options) { options.limits.state_bytes = most; });
    const auto client = server.client();
    const auto boxes = make_boxes("uniform", 20000, 1), many = make_boxes("uniform", 50000, 1);
    const auto refused = [&](const std::vector<Box3f>& objects) {
        expect_error(ErrorCode::resource_limit, std::to_string(most), [&] { client->submit({objects}); });
    };
    refused(many);
    const std::string id = client->submit({boxes});
    (void)client->wait(id, std::chrono::minutes(1));
    EXPECT_EQ(client->submit({boxes}, {}, {.id = id}), id);
    const std::string other = client->submit({std::span(boxes).first(16000), {}});
    (void)client->wait(other, std::chrono::minutes(1));
    refused(boxes);
    client->release(id);
    (void)client->submit({boxes});
}

TEST(Folder, HasNoRoomForAResult) {
    const DetachedServer server([](service::ServerOptions& options) { options.limits.state_bytes = 600 << 10; });
    const auto client = server.client();
    const auto boxes = make_boxes("coincident", 2000, 1);
    const std::string id = client->submit({boxes});
    (void)failure_of(*client, id, ErrorCode::resource_limit);
    EXPECT_TRUE(server.files(".part").empty());
}

/// Fixture with a finished job. The server has ended.
class FolderOfADoneJob : public ::testing::Test {
protected:
    FolderOfADoneJob() {
        (void)client_->wait(id_, std::chrono::minutes(1));
        server_.stop();
    }
    void expect_right_after_start() {
        server_.start();
        expect_result(*client_, id_, work_);
    }

    DetachedServer server_;
    const std::unique_ptr<JobClient> client_ = server_.client();
    const std::vector<Box3f> boxes_ = make_boxes("uniform", 1000, 1);
    const Work work_{Objects{boxes_}};
    const std::string id_ = submit(*client_, work_);
};

TEST_F(FolderOfADoneJob, IsCleanedOfWhatIsHalfWritten) {
    const std::vector<std::string> done = server_.files();
    write_file(server_.state() + "/0000000000000001.result.part", "half a result");
    write_file(server_.state() + "/0000000000000005.job.part", "half a job");
    write_file(server_.state() + "/0000000000000006.result", "of no job");
    write_file(server_.state() + "/notes.txt", "of a person");
    expect_right_after_start();
    EXPECT_EQ(server_.files().size(), done.size() + 1);
    EXPECT_EQ(server_.files(".txt").size(), 1u);
}

TEST_F(FolderOfADoneJob, FindsAnewWhatHasNoWholeResult) {
    const std::string result = server_.files(".result").at(0);
    std::filesystem::rename(result, result + ".part");
    expect_right_after_start();
}

}  // namespace
}  // namespace octopair::test
