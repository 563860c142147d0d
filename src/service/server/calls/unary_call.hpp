// Unary: a call with one request and one answer, which the server answers at once.
#pragma once

#include <grpcpp/server_context.h>
#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/server_callback.h>

#include <utility>

#include "octopair/error.hpp"
#include "service/protocol/messages.hpp"
#include "service/protocol/status.hpp"
#include "service/server/server_context.hpp"

namespace octopair::service {

/// Parses a request. Throws: Error{bad_input}, which becomes INVALID_ARGUMENT.
template <typename Request>
Request parsed(grpc::ByteBuffer bytes) {
    Request request;
    if (!unpack(bytes, request)) throw Error(ErrorCode::bad_input, "the message cannot be parsed");
    return request;
}

/// A unary call that is answered at once.
struct Unary {
    ServerContext& server;
    grpc::CallbackServerContext& context;
    const grpc::ByteBuffer& request;
    grpc::ByteBuffer& response;
};

/// Admits the caller, sends the message that `answer(caller, request)` returns, and finishes the call. An exception of `answer` becomes
/// the status of the call.
template <typename Request, typename Answer>
grpc::ServerUnaryReactor* answer_at_once(const Unary& call, Right right, Answer&& answer) {
    grpc::ServerUnaryReactor* const reactor = call.context.DefaultReactor();
    Admission admission;
    grpc::Status status = call.server.admit(call.context, right, admission);
    try {
        if (status.ok()) call.response = pack(answer(std::as_const(admission.caller), parsed<Request>(call.request)));
    } catch (...) {
        status = status_of_exception();
    }
    reactor->Finish(status);
    return reactor;
}

}  // namespace octopair::service
