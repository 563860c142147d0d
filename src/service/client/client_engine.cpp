// The remote engine: runs every call as a job on the server.
//
// A job with small input and result uses one message each way. Other jobs use a stream. If the stream breaks, the client sends
// the whole job again with the same id. The server then omits the pairs that the client has received.
#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>
#include <grpcpp/completion_queue.h>
#include <grpcpp/generic/generic_stub.h>

#include <optional>

#include "base/stop.hpp"
#include "base/timed.hpp"
#include "engine/job_queue.hpp"
#include "engine/request.hpp"
#include "engine/ticket_lock.hpp"
#include "octopair/client.hpp"
#include "service/client/connection.hpp"
#include "service/client/raw_stream.hpp"
#include "service/client/received.hpp"
#include "service/client/uploader.hpp"
#include "service/protocol/errors.hpp"
#include "service/protocol/messages.hpp"
#include "service/protocol/status.hpp"

namespace octopair::service {

namespace {

/// Maximum size of an input that is sent in one message.
constexpr std::uint64_t max_small_bytes = piece_bytes;

bool wants_pairs(const detail::Output& output) { return output.list != nullptr || output.sink != nullptr; }

/// A call of the engine as a job on the server.
class RemoteJob {
public:
    RemoteJob(Connection& connection, const detail::Request& request, const detail::Output& output,
              const detail::Control& control);

    /// Returns the summary of the call. Throws: Error; what the sinks for pairs and progress throw.
    Summary run();

private:
    bool run_small();
    void raise_small_input();
    grpc::Status call_small();
    grpc::Status call_stream();
    void begin_attempt();

    Connection& connection_;
    const std::stop_token stop_;
    const bool pairs_wanted_;
    Uploader upload_;
    Received received_;
};

RemoteJob::RemoteJob(Connection& connection, const detail::Request& request, const detail::Output& output,
                     const detail::Control& control)
    : connection_(connection),
      stop_(control.stop),
      pairs_wanted_(wants_pairs(output)),
      upload_(spec_of(request, pairs_wanted_), arrays_of(request)),
      received_(connection.server(), output, control) {}

/// Runs the job with one message each way. Returns false if the input or the result is too large for one message.
/// Also returns false if the result is expected to be too large: the server would drop such a result after the search.
bool RemoteJob::run_small() {
    const std::uint64_t bytes = upload_.bytes();
    if (bytes > max_small_bytes || (pairs_wanted_ && bytes > connection_.small_input())) return false;
    try {
        connection_.call_with_retries(stop_, [&] { return call_small(); });
        return true;
    } catch (const LimitError& error) {
        if (error.name() != "message_bytes") throw;
        connection_.small_input() = bytes / 2;
        return false;
    }
}

void RemoteJob::raise_small_input() {
    auto& known = connection_.small_input();
    std::uint64_t before = known;
    while (before < upload_.bytes() && !known.compare_exchange_weak(before, upload_.bytes())) {
    }
}

grpc::Status RemoteJob::call_small() {
    grpc::ClientContext context;
    connection_.prepare(context);
    grpc::CompletionQueue queue;
    grpc::ByteBuffer answer;
    grpc::Status status;
    begin_attempt();
    const grpc::ByteBuffer question = upload_.next();
    {
        const std::stop_callback cancel(stop_, [&] { context.TryCancel(); });
        const auto call = grpc::GenericStub(connection_.channel())
                              .PrepareUnaryCall(&context, "/octopair.v1.Octopair/DetectSmall", question, &queue);
        call->StartCall();
        call->Finish(&answer, &status, this);
        void* tag = nullptr;
        bool ok = false;
        (void)queue.Next(&tag, &ok);
    }
    if (status.ok()) received_.take(answer);
    return status;
}

void RemoteJob::begin_attempt() {
    upload_.restart(received_.pairs());
    received_.begin_attempt();
}

grpc::Status RemoteJob::call_stream() {
    begin_attempt();
    const auto next = [&] { return upload_.done() ? std::nullopt : std::optional(upload_.next()); };
    const auto take = [&](grpc::ByteBuffer& message) { received_.take(message); };
    return RawStream(connection_, {"/octopair.v1.Octopair/Detect", next, take}).run(stop_);
}

Summary RemoteJob::run() {
    double seconds = 0;
    {
        const Timed timed(seconds);
        throw_if_stopped(stop_);
        if (!run_small()) {
            upload_.set_id(new_id());
            connection_.call_with_retries(stop_, [&] { return call_stream(); });
            if (received_.pairs() * sizeof(Pair) <= piece_bytes) raise_small_input();
        }
    }
    Summary summary = received_.finish();
    summary.seconds = seconds;
    return summary;
}

}  // namespace

}  // namespace octopair::service

namespace octopair {

namespace {

class ClientEngine final : public Engine {
public:
    ClientEngine(std::string_view address, const ClientOptions& options) : connection_(address, options) {
        connection_.check_server();
    }

private:
    Summary run(const detail::Request& request, const detail::Output& output, const detail::Control& control) override {
        const TicketLock::Guard turn(turns_, control.stop);
        return service::RemoteJob(connection_, request, output, control).run();
    }
    detail::JobQueue& jobs() override { return jobs_; }

    TicketLock turns_;
    service::Connection connection_;
    detail::JobQueue jobs_{*this};  // last, so that its thread ends before the other members are destroyed
};

}  // namespace

std::unique_ptr<Engine> connect(std::string_view address, const ClientOptions& options) {
    return std::make_unique<ClientEngine>(address, options);
}

}  // namespace octopair
