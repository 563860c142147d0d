// Tests a state folder on a full disk: jobs that do not fit are refused, and everything else works.
#include <sched.h>
#include <sys/mount.h>

#include <cerrno>
#include <cstring>

#include "service/detached/detached_server.hpp"
#include "support/compare.hpp"

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

TEST(FullDisk, RefusesWhatDoesNotFit) {
    const test::TemporaryDirectory folder;
    const std::string disk = folder.file("disk");
    if (const std::string why = mount_small_disk(disk); !why.empty()) GTEST_SKIP() << why;
    {
        const DetachedServer server([&](service::ServerOptions& options) { options.state_folder = disk; });
        const auto client = server.client();
        const auto boxes = make_boxes("uniform", 50'000, 1), many = make_boxes("uniform", 200'000, 1);
        const Work work(Objects{std::span(boxes), {}});
        const auto refused = [&](const std::vector<Box3f>& objects) {
            const std::string words = test::error_of(ErrorCode::io_failed, [&] {
                client->submit({std::span(objects), {}});
            });
            EXPECT_NE(words.find("No space left"), std::string::npos) << words;
        };
        refused(many);
        const std::string id = submit(*client, work);
        EXPECT_TRUE(same_bytes(pairs_there(*client, id), pairs_here(work)));
        const std::vector<Box3f> heap(2000);  // a small input with a result of 16 MB
        const std::string too_large = client->submit({std::span(heap), {}});
        const JobStatus status = client->wait(too_large, std::chrono::minutes(1));
        ASSERT_EQ(int(status.state), int(JobState::failed));
        EXPECT_EQ(int(status.error.value().code()), int(ErrorCode::io_failed)) << status.error->what();
        refused(many);
        EXPECT_TRUE(same_bytes(pairs_there(*client, id), pairs_here(work)));
        client->release(id);
        const std::string again = submit(*client, work);
        EXPECT_TRUE(same_bytes(pairs_there(*client, again), pairs_here(work)));
    }
    EXPECT_EQ(::umount(disk.c_str()), 0);
}

}  // namespace
}  // namespace octopair::test
