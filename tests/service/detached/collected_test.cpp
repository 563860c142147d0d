// Tests results of detached jobs: reads from any offset, release, the retention time, and a restart of the server.
#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>
#include <grpcpp/create_channel.h>
#include <grpcpp/security/credentials.h>

#include <cstring>

#include "service/detached/detached_server.hpp"
#include "service/protocol/octopair.grpc.pb.h"
#include "service/protocol/status.hpp"

namespace octopair::test {
namespace {

class Collected : public ::testing::Test {
protected:
    struct Answer {
        std::vector<Pair> pairs;
        std::string hash;
    };

    /// Makes the call Result and returns its answer. Throws: the Error of the call's status.
    Answer ask(const std::string& id, std::uint64_t offset, const std::string& hash = {}) {
        v1::ResultRequest request;
        request.set_id(id);
        request.set_offset(offset);
        request.set_hash(hash);
        grpc::ClientContext context;
        const auto reader = stub_->Result(&context, request);
        Answer answer;
        for (v1::Download message; reader->Read(&message);) {
            if (message.has_head()) answer.hash = message.head().hash();
            const std::size_t had = answer.pairs.size();
            answer.pairs.resize(had + message.pairs().size() / sizeof(Pair));
            if (message.pairs().empty()) continue;
            std::memcpy(answer.pairs.data() + had, message.pairs().data(), message.pairs().size());
        }
        const grpc::Status status = reader->Finish();
        if (!status.ok()) service::throw_status(status, "test");
        return answer;
    }

    std::string done() {
        const std::string id = submit(*client_, work_);
        expect_done(*client_, id);
        return id;
    }

    DetachedServer server_;
    std::unique_ptr<JobClient> client_ = server_.client();
    std::unique_ptr<v1::Octopair::Stub> stub_ =
        v1::Octopair::NewStub(grpc::CreateChannel(server_.address(), grpc::InsecureChannelCredentials()));
    const std::vector<Box3f> boxes_ = make_boxes("dense", 100000, 1);
    const Work work_{Objects{boxes_}};
};

TEST_F(Collected, ComesFromAnyPlaceOn) {
    const std::string id = done();
    const std::vector<Pair> all = pairs_here(work_);
    ASSERT_GT(all.size(), 3u * 131072);  // more than three pieces
    const std::string hash = ask(id, 0).hash;
    for (const std::uint64_t offset :
         {std::uint64_t(0), std::uint64_t(1), std::uint64_t(131071), std::uint64_t(131072), std::uint64_t(200001),
          std::uint64_t(all.size() - 1), std::uint64_t(all.size())}) {
        const Answer answer = ask(id, offset, hash);
        EXPECT_TRUE(same_bytes(answer.pairs, {all.begin() + std::ptrdiff_t(offset), all.end()})) << offset;
        EXPECT_EQ(answer.hash, hash);
    }
}

TEST_F(Collected, IsRefusedBeyondItsEndOrForAnother) {
    const std::string id = done();
    const std::size_t all = pairs_here(work_).size();
    expect_error(ErrorCode::bad_input, std::to_string(all), [&] { ask(id, all + 1); });
    expect_error(ErrorCode::bad_input, "another", [&] { ask(id, 1, std::string(16, 'x')); });
    expect_error(ErrorCode::bad_input, "no job", [&] { ask(some_id, 0); });
}

TEST_F(Collected, StaysUntilItIsReleased) {
    const std::string id = done();
    const auto all = pairs_here(work_);
    for (int i = 0; i < 2; ++i) EXPECT_TRUE(same_bytes(pairs_there(*client_, id), all));
    EXPECT_EQ(server_.files().size(), 2u);
    client_->release(id);
    EXPECT_TRUE(server_.files().empty());
    EXPECT_TRUE(client_->list().empty());
    (void)error_of(ErrorCode::bad_input, [&] { client_->status(id); });
    EXPECT_EQ(client_->submit(work_.first, {}, {.id = id}), id);
    EXPECT_TRUE(same_bytes(pairs_there(*client_, id), all));
}

TEST_F(Collected, MayBeReleasedWhileItIsRead) {
    const std::vector<Box3f> heap(4000);  // 64 MB of pairs
    const std::string id = client_->submit({heap});
    expect_done(*client_, id);
    v1::ResultRequest request;
    request.set_id(id);
    grpc::ClientContext context;
    const auto reader = stub_->Result(&context, request);
    v1::Download message;
    ASSERT_TRUE(reader->Read(&message));
    client_->release(id);
    while (reader->Read(&message)) {
    }
    const grpc::Status status = reader->Finish();
    expect_error(ErrorCode::bad_input, "released", [&] { service::throw_status(status, "test"); });
    EXPECT_TRUE(server_.files().empty());
}

TEST_F(Collected, IsKeptForATimeThatBeginsAnewWithTheServer) {
    const std::string id = done();
    server_.stop();
    server_.options().keep = std::chrono::seconds(3600);
    server_.start();
    EXPECT_EQ(client_->list().size(), 1u);
    server_.stop();
    server_.options().keep = std::chrono::seconds(1);
    server_.start();
    EXPECT_TRUE(comes_true([&] { return client_->list().empty() && server_.files().empty(); }));
}

TEST_F(Collected, IsAsItWasAfterARestart) {
    const std::string id = done();
    const std::vector<Box3f> wrong = {{{1, 0, 0}, {0, 0, 0}}};
    const std::string failed = client_->submit({wrong});
    const JobStatus failure = client_->wait(failed, std::chrono::minutes(1));
    server_.restart();
    expect_result(*client_, id, work_);
    EXPECT_STREQ(client_->status(failed).error.value().what(), failure.error.value().what());
    EXPECT_EQ(client_->submit(work_.first, {}, {.id = id}), id);
    EXPECT_EQ(server_.files(".job").size(), 2u);
}

}  // namespace
}  // namespace octopair::test
