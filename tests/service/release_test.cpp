// Tests JobClient::release() if the answer of its first attempt is lost: codes decide, and no words of a message.
#include <grpcpp/security/server_credentials.h>
#include <grpcpp/server.h>
#include <grpcpp/server_builder.h>
#include <gtest/gtest.h>

#include "io/temporary.hpp"
#include "octopair/job_client.hpp"
#include "service/protocol/octopair.grpc.pb.h"
#include "service/protocol/status.hpp"

namespace octopair::test {
namespace {

grpc::Status failure(const std::string& message, v1::FailureDetail detail = v1::NO_DETAIL) {
    v1::Failure failure;
    failure.set_code(v1::BAD_INPUT);
    failure.set_message(message);
    failure.set_detail(detail);
    return service::status_of(failure);
}

/// A server whose first answer to Release is lost. It gives `again` to the next Release, and `question` to Status.
class LossyServer final : public v1::Octopair::Service {
public:
    LossyServer(grpc::Status again, grpc::Status question) : again_(std::move(again)), question_(std::move(question)) {
        grpc::ServerBuilder builder;
        builder.AddListeningPort(address(), grpc::InsecureServerCredentials());
        builder.RegisterService(this);
        server_ = builder.BuildAndStart();
    }

    std::string address() const { return "unix:" + folder_.file("socket"); }
    grpc::Status Release(grpc::ServerContext*, const v1::JobName*, v1::JobReport*) override {
        return releases_++ == 0 ? grpc::Status(grpc::StatusCode::UNAVAILABLE, "the connection is lost") : again_;
    }
    grpc::Status Status(grpc::ServerContext*, const v1::JobName*, v1::JobReport*) override { return question_; }

private:
    const TemporaryDirectory folder_;
    grpc::Status again_, question_;
    int releases_ = 0;
    std::unique_ptr<grpc::Server> server_;
};

void release_from(const LossyServer& server) {
    JobClient(server.address()).release("6f1c0c1e-2f0a-4d7b-8a3e-5b9d1c2e3f40");
}

TEST(Release, IsDoneIfTheJobIsGoneAtTheNextAttempt) {
    release_from({failure("the job is unknown here", v1::NO_SUCH_JOB), grpc::Status::OK});
}

TEST(Release, IsDoneIfAnOlderServerDoesNotSeeTheJob) {
    release_from({failure("the job is unknown here"), failure("the job is unknown here")});
}

TEST(Release, FailsIfTheJobStays) {
    for (const std::string words : {"there is no job for this, it has not ended", "job x has not ended"}) {
        const LossyServer server(failure(words), grpc::Status::OK);
        EXPECT_EQ(error_of(ErrorCode::bad_input, [&] { release_from(server); }), words);
    }
}

}  // namespace
}  // namespace octopair::test
