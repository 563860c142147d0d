// Tests state folders of other versions of octopair, and backups of state folders.
#include <thread>

#include "service/detached/detached_server.hpp"
#include "service/protocol/job_hash.hpp"
#include "service/protocol/job_spec.hpp"
#include "service/server/store/state_format.hpp"

namespace octopair::test {
namespace {

/// Writes the file of a job as a server with another algorithm version does. Returns the bytes of its input.
std::string write_foreign_job(const std::string& path, const Work& work, std::uint32_t algorithm) {
    const auto& boxes = std::get<std::span<const Box3f>>(work.first.boxes);
    const auto bytes = std::as_bytes(boxes);
    service::StoredSpec stored;
    stored.owner = "local";
    stored.algorithm = algorithm;
    stored.spec.set_id(some_id);
    stored.spec.mutable_first()->set_objects(boxes.size());
    service::JobHash hash(stored.spec, algorithm);
    hash.add(bytes);
    const std::string block = service::encode_block(stored);
    std::string input(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    write_file(path, block + input + service::encode_job_end(block, hash.digest()));
    return input;
}

class Upgraded : public ::testing::Test {
protected:
    Upgraded() { server_.stop(); }

    std::string job_file() const { return server_.state() + "/0000000000000001.job"; }

    DetachedServer server_;
    const std::vector<Box3f> boxes_ = make_boxes("uniform", 50'000, 1);
    const Work work_{Objects{boxes_}};
};

TEST_F(Upgraded, JobsOfOtherVersionsRunFromTheirInput) {
    for (const std::uint32_t algorithm : {0u, 7u}) {
        write_foreign_job(job_file(), work_, algorithm);
        server_.start();
        const auto client = server_.client();
        expect_result(*client, some_id, work_);
        Work again = work_;
        again.terms.id = some_id;
        EXPECT_EQ(submit(*client, again), some_id) << "the client submits the same job again";
        EXPECT_EQ(client->list().size(), 1u);
        server_.restart();
        EXPECT_TRUE(same_bytes(pairs_there(*client, some_id), pairs_here(work_))) << "its result stays";
        client->release(some_id);
        EXPECT_TRUE(server_.files().empty());
        server_.stop();
    }
}

TEST_F(Upgraded, ADamagedJobOfAnotherVersionStays) {
    const std::string input = write_foreign_job(job_file(), work_, 7);
    std::string bytes = read_file(job_file());
    bytes[bytes.find(input) + 1000] ^= 1;
    write_file(job_file(), bytes);
    server_.start();
    const JobStatus status = server_.client()->wait(some_id, std::chrono::minutes(1));
    ASSERT_EQ(int(status.state), int(JobState::failed));
    EXPECT_EQ(std::string(status.error.value().what()),
              "0000000000000001.job: damaged: the hash of the input does not match the submitted job");
    EXPECT_EQ(read_file(job_file()), bytes);
}

TEST_F(Upgraded, AnOlderFolderIsConverted) {
    const std::string version = server_.state() + "/version";
    EXPECT_EQ(read_file(version), "octopair state 2\n");
    std::filesystem::remove(version);
    write_file(version + ".part", "octo");
    server_.start();
    EXPECT_EQ(read_file(version), "octopair state 2\n");
}

TEST_F(Upgraded, ANewerFolderIsNotTouched) {
    write_foreign_job(job_file(), work_, 7);
    write_file(server_.state() + "/0000000000000002.job.part", "unfinished");
    write_file(server_.state() + "/version", "octopair state 3\n");
    const auto refusal = [&] { return error_of(ErrorCode::io_failed, [&] { server_.start(); }); };
    EXPECT_EQ(refusal(),
              server_.state() +
                  ": the state folder has version 3; this program uses version 2 or older. Nothing was changed");
    EXPECT_EQ(server_.files().size(), 2u);
    for (const char* text :
         {"", "octopair state 2", "octopair state x\n", "octopair state 0\n", "octopair state 2 3\n"}) {
        write_file(server_.state() + "/version", text);
        EXPECT_EQ(refusal(), server_.state() + "/version: damaged: it is not a version of a state folder") << text;
    }
    write_file(server_.state() + "/version", "octopair state 2\n");
    server_.start();
    expect_result(*server_.client(), some_id, work_);
}

class Backup : public DetachedTest {};

/// A copy of the folder of a running server has all jobs that were acknowledged before the copy began.
TEST_F(Backup, OfARunningServerIsComplete) {
    const auto boxes = make_boxes("uniform", 3000, 1);
    const Work work(Objects{boxes});
    const std::vector<Pair> expected = pairs_here(work);
    std::vector<std::string> before;
    for (int i = 0; i < 30; ++i) before.push_back(submit(*client_, work));
    std::jthread load([&](const std::stop_token& stop) {
        const auto other = server_.client();
        while (!stop.stop_requested()) {
            const std::string id = submit(*other, work);
            (void)other->wait(id, std::chrono::minutes(1));
            other->release(id);
        }
    });
    const std::string backup = server_.folder().file("backup");
    std::filesystem::create_directory(backup);
    for (const auto& entry : std::filesystem::directory_iterator(server_.state())) {
        std::error_code vanished;
        std::filesystem::copy_file(entry.path(), backup + "/" + entry.path().filename().string(), vanished);
    }
    load = {};
    std::filesystem::permissions(backup, std::filesystem::perms::owner_all);
    const DetachedServer restored([&](service::ServerOptions& options) { options.state_folder = backup; });
    const auto other = restored.client();
    for (const std::string& id : before) EXPECT_TRUE(same_bytes(pairs_there(*other, id), expected));
}

}  // namespace
}  // namespace octopair::test
