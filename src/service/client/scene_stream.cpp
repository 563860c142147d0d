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
    call_->StartCall(tag(Event::started));
}

SceneStream::~SceneStream() {
    context_.TryCancel();
    queue_.Shutdown();
    void* event = nullptr;
    bool ok = false;
    while (queue_.Next(&event, &ok)) {
    }
}

void SceneStream::send(Bytes calls) {
    while (!started_ || writing_) wait();
    writing_ = true;
    call_->Write(pack(v1::SceneUpload(), grpc::Slice(calls.data(), calls.size())), tag(Event::written));
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
    call_->Read(&in_, tag(Event::read));
}

/// Waits for the next event, and handles it. Throws: Ended.
void SceneStream::wait() {
    void* event = nullptr;
    bool ok = false;
    if (finished_ || !queue_.Next(&event, &ok)) throw Ended();
    handle(*static_cast<Event*>(event), ok);
    if (finished_) throw Ended();
}

void SceneStream::handle(Event event, bool ok) {
    const bool reads = event == Event::started || event == Event::read;
    if (event == Event::written) writing_ = false;  // after a failed write, the read fails as well
    if (event == Event::finished) finished_ = true;
    if (reads && !ok) {
        call_->Finish(&status_, tag(Event::finished));
    } else if (event == Event::started) {
        started_ = true;
        read();
    } else if (event == Event::read) {
        received_ = true;
    }
}

}  // namespace octopair::service
