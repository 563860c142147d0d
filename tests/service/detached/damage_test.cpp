// Tests damaged files of the state folder: the affected job reports the file, and all other jobs are served.

#include "service/detached/detached_server.hpp"

namespace octopair::test {
namespace {

class Damage : public ::testing::Test {
protected:
    /// Submits a job, waits for its end, stops the server, and then changes the bytes of the job's file in place.
    template <typename Change>
    void damage(const std::string& ending, const Change& change) {
        id_ = submit(*client_, work_);
        (void)client_->wait(id_, std::chrono::minutes(1));
        server_.stop();
        file_ = server_.files(ending).at(0);
        std::string bytes = read_file(file_);
        change(bytes);
        write_file(file_, bytes);
    }

    /// Expects that a message for the client names the damaged file, without its folder.
    void expect_names_file(const std::string& message) const {
        const std::string name = std::filesystem::path(file_).filename().string();
        EXPECT_TRUE(message.starts_with(name + ": damaged: ")) << message;
        EXPECT_FALSE(has_text(message, server_.state()));
    }

    void expect_failed() {
        server_.start();
        const std::string status = failure_of(*client_, id_, ErrorCode::io_failed);
        expect_names_file(status);
        expect_served();
        client_->release(id_);
        EXPECT_TRUE(comes_true([&] { return server_.files(".job").size() == 1; }));
    }

    void expect_served() { test::expect_served(*client_, work_); }

    void forget_result() { std::filesystem::remove(server_.files(".result").at(0)); }

    DetachedServer server_;
    std::unique_ptr<JobClient> client_ = server_.client();
    const std::vector<Box3f> boxes_ = make_boxes("uniform", 2000, 1);
    const Work work_{Objects{boxes_}};
    std::string id_, file_;
};

TEST_F(Damage, OfAnInput) {
    damage(".job", [](std::string& bytes) { bytes[bytes.size() / 2] = char(bytes[bytes.size() / 2] ^ 1); });
    forget_result();
    expect_failed();
}

TEST_F(Damage, OfAJobsEnd) {
    damage(".job", [](std::string& bytes) { bytes.back() = char(bytes.back() ^ 1); });
    expect_failed();
}

TEST_F(Damage, OfAJobThatWasCut) {
    damage(".job", [](std::string& bytes) { bytes.resize(bytes.size() / 2); });
    expect_failed();
}

TEST_F(Damage, OfAJobsBeginningIsMended) {
    damage(".job", [](std::string& bytes) { bytes[40] = char(bytes[40] ^ 1); });
    forget_result();
    server_.start();
    expect_result(*client_, id_, work_);
}

TEST_F(Damage, OfAJobThatCannotBeNamed) {
    damage(".job", [](std::string& bytes) { bytes = "nothing"; });
    server_.start();
    EXPECT_TRUE(client_->list().empty());
    EXPECT_TRUE(has_text(server_.log(), file_));
    expect_served();
}

TEST_F(Damage, OfAResultsEnd) {
    damage(".result", [](std::string& bytes) { bytes[bytes.size() - 30] = char(bytes[bytes.size() - 30] ^ 1); });
    expect_failed();
}

TEST_F(Damage, OfAResultThatWasCut) {
    damage(".result", [](std::string& bytes) { bytes.resize(10); });
    expect_failed();
}

TEST_F(Damage, OfPairs) {
    damage(".result", [](std::string& bytes) { bytes[100] = char(bytes[100] ^ 1); });
    server_.start();
    EXPECT_EQ(int(client_->status(id_).state), int(JobState::done));
    PairList pairs;
    const std::string words = error_of(ErrorCode::io_failed, [&] { client_->result(id_, pairs); });
    expect_names_file(words);
    EXPECT_EQ(pairs.size(), 0u);
    expect_served();
}

}  // namespace
}  // namespace octopair::test
