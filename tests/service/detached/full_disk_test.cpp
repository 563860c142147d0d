// Tests a state folder on a full disk: jobs that do not fit are refused, and everything else works.
#include <sched.h>
#include <sys/mount.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "service/detached/detached_server.hpp"

namespace octopair::test {
namespace {

/// Mounts a disk of 3 MB at a folder, for this process only. Returns the reason if that is not permitted, or an empty
/// text.
std::string mount_small_disk(const std::string& folder) {
    std::filesystem::create_directory(folder);
    if (::unshare(CLONE_NEWNS) == 0 && ::mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
        ::mount("tmpfs", folder.c_str(), "tmpfs", 0, "size=3m,mode=700") == 0) {
        return {};
    }
    return std::string("this process may not mount: ") + std::strerror(errno);
}

/// A server whose state folder is on a disk of its own.
class FullDisk : public ::testing::Test {
protected:
    void SetUp() override {
        if (const std::string why = mount_small_disk(disk_); !why.empty()) GTEST_SKIP() << why;
        server_.emplace([&](service::ServerOptions& options) { options.state_folder = disk_; });
        client_ = server_->client();
    }
    void TearDown() override {
        if (!server_) return;
        client_.reset();
        server_.reset();
        EXPECT_EQ(::umount(disk_.c_str()), 0);
    }

    const TemporaryDirectory folder_;
    const std::string disk_ = folder_.file("disk");
    std::optional<DetachedServer> server_;
    std::unique_ptr<JobClient> client_;
};

TEST_F(FullDisk, RefusesWhatDoesNotFit) {
    const auto boxes = make_boxes("uniform", 50'000, 1), many = make_boxes("uniform", 200'000, 1);
    const Work work(Objects{boxes});
    const auto refused = [&](const std::vector<Box3f>& objects) {
        expect_error(ErrorCode::io_failed, "No space left", [&] { client_->submit({objects}); });
    };
    refused(many);
    const std::vector<Box3f> heap(2000);  // a small input with a result of 16 MB
    const std::string too_large = client_->submit({heap});
    const std::string status = failure_of(*client_, too_large, ErrorCode::io_failed);
    EXPECT_EQ(status, "the result does not fit on the server's disk, which has 3145728 bytes in all");
    const std::string id = submit(*client_, work);
    expect_result(*client_, id, work);
    refused(many);
    expect_result(*client_, id, work);
    client_->release(id);
    expect_served(*client_, work);
}

/// A job whose result finds no room runs again when there is. Its readers receive each pair once.
TEST_F(FullDisk, WaitsForRoomForAResult) {
    const std::string filler = disk_ + "/filler";
    write_file(filler, std::string(2'000'000, 'x'));
    const std::vector<Box3f> heap(600);  // its result has 1.4 MB
    const Work work(Objects{heap});
    const std::string id = submit(*client_, work);
    ASSERT_TRUE(comes_true([&] { return client_->status(id).waits_for_room; }));
    EXPECT_EQ(int(client_->status(id).state), int(JobState::queued));
    std::vector<Pair> read;
    std::jthread reader([&] { read = pairs_there(*client_, id); });
    const Work small(Objects{std::span(heap).first(30), {}});
    const std::string other = submit(*client_, small);
    EXPECT_TRUE(same_bytes(pairs_there(*client_, other), pairs_here(small))) << "later jobs do not wait";
    std::filesystem::remove(filler);
    reader.join();
    EXPECT_TRUE(same_bytes(read, pairs_here(work)));
    EXPECT_FALSE(client_->status(id).waits_for_room);
    EXPECT_TRUE(has_text(server_->log(), "job " + id + ": waits for room for its result: "));
    EXPECT_TRUE(has_text(server_->log(), "No space left"));
    EXPECT_FALSE(has_text(server_->log(), disk_)) << "messages do not name the server's folders";
}

/// Fills the disk of a folder, but for this number of blocks of 4 KiB. Returns the path of the file.
std::string fill(const std::string& disk, std::uint64_t free_blocks) {
    constexpr std::size_t block = 4096;
    const std::string filler = disk + "/filler";
    std::ofstream file(filler, std::ios::binary);
    while (file.write(std::string(block, 'x').data(), block).flush()) {
    }
    file.close();
    std::filesystem::resize_file(filler, std::filesystem::file_size(filler) / block * block - free_blocks * block);
    return filler;
}

/// Jobs that found no room for small results run as soon as the disk has room for these, though it is nearly full.
TEST_F(FullDisk, DoesNotMakeSmallResultsWaitForMuchRoom) {
    const std::vector<Box3f> heap(200);  // its input has 5 KB, its result 159 KB
    const Work work(Objects{heap});
    constexpr std::uint64_t jobs = 8, blocks_of_input = 3, blocks_of_result = 42;
    const std::string filler = fill(disk_, jobs * blocks_of_input);
    std::vector<std::string> ids;
    for (std::uint64_t i = 0; i < jobs; ++i) {
        ids.push_back(submit(*client_, work));
        ASSERT_TRUE(comes_true([&] { return client_->status(ids.back()).waits_for_room; })) << i;
    }
    std::filesystem::resize_file(filler, std::filesystem::file_size(filler) - jobs * blocks_of_result * 4096);
    for (const std::string& id : ids) expect_result(*client_, id, work);
}

class FullState : public ::testing::Test {
protected:
    static constexpr std::uint64_t most = 4'000'000;
    DetachedServer server_{[](service::ServerOptions& options) { options.limits.state_bytes = most; }};
    std::unique_ptr<JobClient> client_ = server_.client();
    std::vector<Box3f> heap_ = std::vector<Box3f>(900);  // its result has 3.2 MB
};

TEST_F(FullState, MakesAResultWaitUntilOthersAreReleased) {
    const Work work(Objects{heap_});
    const std::string first = submit(*client_, work);
    expect_done(*client_, first);
    const std::string second = submit(*client_, work);
    ASSERT_TRUE(comes_true([&] { return client_->status(second).waits_for_room; }));
    client_->release(first);
    expect_result(*client_, second, work);
}

TEST_F(FullState, EndsAJobThatCanNeverHaveRoom) {
    heap_.resize(1100);  // 4.8 MB
    const std::string id = client_->submit({heap_});
    const std::string status = failure_of(*client_, id, ErrorCode::resource_limit);
    EXPECT_TRUE(has_text(status, "state_bytes: the server has 4000000"));
}

TEST_F(FullState, LetsAWaitingJobBeCancelled) {
    const std::string first = client_->submit({heap_});
    expect_done(*client_, first);
    const std::string second = client_->submit({heap_});
    ASSERT_TRUE(comes_true([&] { return client_->status(second).waits_for_room; }));
    EXPECT_EQ(int(client_->cancel(second).state), int(JobState::cancelled));
    client_->release(second);
    EXPECT_EQ(client_->list().size(), 1u);
}

TEST_F(FullState, LeavesAWaitingJobToTheNextServer) {
    const Work work(Objects{heap_});
    const std::string first = submit(*client_, work);
    expect_done(*client_, first);
    const std::string second = submit(*client_, work);
    ASSERT_TRUE(comes_true([&] { return client_->status(second).waits_for_room; }));
    server_.restart();
    ASSERT_TRUE(comes_true([&] { return client_->status(second).waits_for_room; }));
    client_->release(first);
    expect_result(*client_, second, work);
}

}  // namespace
}  // namespace octopair::test
