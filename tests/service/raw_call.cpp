#include "service/raw_call.hpp"

#include <grpcpp/create_channel.h>
#include <grpcpp/security/credentials.h>

#include <chrono>
#include <stdexcept>

#include "io/temporary.hpp"
#include "service/protocol/job_spec.hpp"
#include "service/protocol/messages.hpp"

namespace octopair::test {

namespace {

std::string path_of(const std::string& method) { return "/octopair.v1.Octopair/" + method; }

}  // namespace

std::shared_ptr<grpc::Channel> open_channel(const std::string& address) {
    grpc::ChannelArguments arguments;
    arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
    arguments.SetMaxReceiveMessageSize(-1);
    arguments.SetMaxSendMessageSize(-1);
    return grpc::CreateCustomChannel(address, grpc::InsecureChannelCredentials(), arguments);
}

RawCall::RawCall(const std::shared_ptr<grpc::Channel>& channel, const std::string& method) : stub_(channel) {
    context_.set_wait_for_ready(true);
    call_ = stub_.PrepareCall(&context_, path_of(method), &queue_);
    call_->StartCall(this);
    (void)step();
}

RawCall::~RawCall() {
    context_.TryCancel();
    if (!over_) (void)finish();
}

bool RawCall::step() {
    void* tag = nullptr;
    bool ok = false;
    const auto deadline = std::chrono::system_clock::now() + std::chrono::minutes(1);
    if (queue_.AsyncNext(&tag, &ok, deadline) != grpc::CompletionQueue::GOT_EVENT) {
        context_.TryCancel();
        (void)queue_.Next(&tag, &ok);
        throw std::runtime_error("a step of the call took longer than a minute");
    }
    return ok;
}

bool RawCall::write(const grpc::ByteBuffer& message) {
    call_->Write(message, this);
    return step();
}

bool RawCall::writes_done() {
    call_->WritesDone(this);
    return step();
}

std::optional<grpc::ByteBuffer> RawCall::read() {
    grpc::ByteBuffer message;
    call_->Read(&message, this);
    if (!step()) return {};
    return message;
}

grpc::Status RawCall::finish() {
    over_ = true;
    while (read()) {
    }
    grpc::Status status;
    call_->Finish(&status, this);
    (void)step();
    return status;
}

grpc::Status call_small(const std::shared_ptr<grpc::Channel>& channel, const grpc::ByteBuffer& question,
                        grpc::ByteBuffer* answer) {
    grpc::ClientContext context;
    context.set_wait_for_ready(true);
    context.set_deadline(std::chrono::system_clock::now() + std::chrono::minutes(1));
    grpc::CompletionQueue queue;
    grpc::GenericStub stub(channel);
    grpc::ByteBuffer unread;
    grpc::Status status;
    const auto call = stub.PrepareUnaryCall(&context, path_of("DetectSmall"), question, &queue);
    call->StartCall();
    call->Finish(answer != nullptr ? answer : &unread, &status, nullptr);
    void* tag = nullptr;
    bool ok = false;
    (void)queue.Next(&tag, &ok);
    return status;
}

v1::JobSpec spec_of(std::uint64_t objects) {
    v1::JobSpec spec;
    spec.set_id(service::new_id());
    spec.mutable_first()->set_objects(objects);
    return spec;
}

grpc::ByteBuffer upload_of(const v1::JobSpec* spec, const std::string& data) {
    v1::Upload message;
    if (spec != nullptr) *message.mutable_spec() = *spec;
    return service::pack(message, grpc::Slice(data));
}

std::string bytes_of_boxes(std::uint64_t objects) {
    std::vector<Box3f> boxes;
    boxes.reserve(objects);
    for (std::uint64_t i = 0; i < objects; ++i) boxes.push_back({{2 * float(i), 0, 0}, {2 * float(i) + 1, 1, 1}});
    return bytes_of(boxes);
}

grpc::ByteBuffer buffer_of(const std::string& bytes) {
    const grpc::Slice slice(bytes);
    return {&slice, 1};
}

v1::Failure failure_in(const grpc::Status& status) {
    v1::Failure failure;
    (void)failure.ParseFromString(status.error_details());
    return failure;
}

}  // namespace octopair::test
