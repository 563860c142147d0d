#include "service/server/calls/result_call.hpp"

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
        if (!begin(shared_from_this())) return;
        try {
            server().server_log.received(request.Length());
            v1::ResultRequest asked;
            if (!unpack(request, asked)) throw Error(ErrorCode::bad_input, "a message that is none");
            job_ = server().jobs.find(owner(), asked.id());
            check(asked);
            piece_ = server().memory.take(piece_bytes);  // what is on its way to a client, even one that does not read
            send(job_, asked.offset());
        } catch (...) {
            refuse(status_of_exception());
        }
    }

private:
    void check(const v1::ResultRequest& asked) const {
        if (!job_->detached()) {
            throw Error(ErrorCode::bad_input,
                        "job " + asked.id() + " is not detached: its result goes to its own call");
        }
        if (!asked.hash().empty() && asked.hash() != job_->input_hash()) {
            throw Error(ErrorCode::bad_input, "job " + asked.id() + " is another one than the pieces before came from");
        }
    }

    void waits(bool) override {
        if (!server().draining || !job_ || job_->ended()) return;
        refuse({grpc::StatusCode::UNAVAILABLE, "the server is going down"});
    }

    std::shared_ptr<ServerJob> job_;
    Budget::Reservation piece_;
};

}  // namespace

grpc::ServerWriteReactor<grpc::ByteBuffer>* start_result(ServerContext& server, grpc::CallbackServerContext& context,
                                                         const grpc::ByteBuffer& request) {
    const auto call = std::make_shared<ResultCall>(server, context);
    call->start(request);
    return call.get();
}

}  // namespace octopair::service
