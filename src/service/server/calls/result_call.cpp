// The call Result: streams the pairs of a detached job.
#include "service/server/calls/call_handlers.hpp"

#include <atomic>
#include <memory>

#include "service/protocol/messages.hpp"
#include "service/protocol/octopair.pb.h"
#include "service/server/calls/download_call.hpp"
#include "service/server/server_context.hpp"

namespace octopair::service {

namespace {

class ResultCall final : public DownloadCall<grpc::ServerWriteReactor<grpc::ByteBuffer>>,
                         public std::enable_shared_from_this<ResultCall> {
public:
    using DownloadCall::DownloadCall;

    void start(grpc::ByteBuffer request) {
        if (!begin(shared_from_this(), Right::read)) return;
        try {
            server().server_log.received(request.Length());
            v1::ResultRequest asked;
            if (!unpack(request, asked)) throw Error(ErrorCode::bad_input, "the message cannot be parsed");
            job_ = server().find(caller(), {}, asked.id());
            check(asked);
            // A piece stays in memory until the client has read it.
            piece_ = server().memory.take(piece_bytes, caller().name);
            send(job_, asked.offset());
        } catch (...) {
            refuse(status_of_exception());
        }
    }

private:
    void check(const v1::ResultRequest& asked) const {
        if (!job_->detached()) {
            throw Error(ErrorCode::bad_input,
                        "job " + asked.id() + " is not detached: only the call that submitted it receives its result");
        }
        if (!asked.hash().empty() && asked.hash() != job_->input_hash()) {
            throw Error(ErrorCode::bad_input,
                        "job " + asked.id() +
                            " has another hash than the job of the earlier pieces; read its result from the start");
        }
    }

    void done() override {
        if (job_) server().server_log.result_sent(*job_, {caller().name, context().peer()}, sent());
    }

    void pump_soon() override {
        if (scheduled_.exchange(true)) return;
        server().result_reader.add(caller().name, [self = shared_from_this()] {
            self->scheduled_ = false;
            self->pump();
        });
    }

    void handle_stall(bool) override {
        if (!server().draining || !job_ || job_->ended()) return;
        refuse({grpc::StatusCode::UNAVAILABLE, "the server is going down"});
    }

    std::shared_ptr<ServerJob> job_;
    Budget::Reservation piece_;
    std::atomic<bool> scheduled_ = false;  // the reader will call pump()
};

}  // namespace

grpc::ServerWriteReactor<grpc::ByteBuffer>* start_result(ServerContext& server, grpc::CallbackServerContext& context,
                                                         const grpc::ByteBuffer& request) {
    const auto call = std::make_shared<ResultCall>(server, context);
    call->start(request);
    return call.get();
}

}  // namespace octopair::service
