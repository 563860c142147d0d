#include "service/client/scene_stream.hpp"

#include <grpcpp/channel.h>
#include <grpcpp/generic/generic_stub.h>

#include "service/client/connection.hpp"
#include "service/protocol/messages.hpp"
#include "service/protocol/octopair.pb.h"

namespace octopair::service {

SceneStream::SceneStream(Connection& connection) {
    connection.prepare(context_);
    call_ = grpc::GenericStub(connection.channel()).PrepareCall(&context_, "/octopair.v1.Octopair/Scene", &queue_);
    call_->StartCall(tag(Completion::started));
}

SceneStream::~SceneStream() {
    context_.TryCancel();
    queue_.Shutdown();
    void* completion = nullptr;
    bool ok = false;
    while (queue_.Next(&completion, &ok)) {
    }
}

void SceneStream::send(Bytes calls) {
    while (!started_ || writing_) wait();
    writing_ = true;
    call_->Write(pack(v1::SceneUpload(), grpc::Slice(calls.data(), calls.size())), tag(Completion::written));
}

grpc::ByteBuffer SceneStream::receive() {
    while (!received_) wait();
    grpc::ByteBuffer message;
    message.Swap(&in_);
    read();
    return message;
}

void SceneStream::read() {
    received_ = false;
    call_->Read(&in_, tag(Completion::read));
}

/// Waits for the next completion, and handles it. Throws: Ended.
void SceneStream::wait() {
    void* completion = nullptr;
    bool ok = false;
    if (finished_ || !queue_.Next(&completion, &ok)) throw Ended();
    handle(*static_cast<Completion*>(completion), ok);
    if (finished_) throw Ended();
}

void SceneStream::handle(Completion completion, bool ok) {
    const bool reads = completion == Completion::started || completion == Completion::read;
    if (completion == Completion::written) writing_ = false;  // after a failed write, the read fails as well
    if (completion == Completion::finished) finished_ = true;
    if (reads && !ok) {
        call_->Finish(&status_, tag(Completion::finished));
    } else if (completion == Completion::started) {
        started_ = true;
        read();
    } else if (completion == Completion::read) {
        received_ = true;
    }
}

}  // namespace octopair::service
