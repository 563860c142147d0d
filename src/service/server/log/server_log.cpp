#include "service/server/log/server_log.hpp"

#include <grpcpp/server_context.h>
#include <grpcpp/support/status.h>

#include <string>
#include <vector>

#include "service/protocol/errors.hpp"
#include "service/protocol/job_spec.hpp"
#include "service/server/jobs/server_job.hpp"
#include "service/server/log/log_line.hpp"

namespace octopair::service {

namespace {

const char* outcome_of(v1::JobState state) {
    if (state == v1::DONE) return "done";
    return state == v1::FAILED ? "failed" : "cancelled";
}

/// Returns the level of lines about a job. Jobs without an id (of DetectSmall) can end thousands of times a second.
LogLevel level_of(const ServerJob& job) { return job.spec().id().empty() ? LogLevel::debug : LogLevel::info; }

}  // namespace

void ServerLog::job_state_changed(const ServerJob& job, std::optional<v1::JobState> from, v1::JobState to) {
    metrics_.job_state_changed(from, to);
    if (to == v1::RUNNING) metrics_.job_started(job.queue_seconds());
    if (to < v1::DONE) return;
    const v1::JobReport report = job.report();
    const double seconds = job.seconds();
    metrics_.job_ended(report, seconds);
    metrics_.client_job_ended(job.owner(), {seconds, input_bytes(job.spec()), report.summary().pairs()});
    const auto level = to == v1::FAILED ? LogLevel::warning : level_of(job);
    if (!is_logged(*log_, level)) return;
    std::vector<Field> fields;
    if (!report.id().empty()) fields.push_back({"id", report.id()});
    fields.insert(fields.end(), {{"owner", job.owner()},
                                 {"objects", report.objects()},
                                 {"pairs", report.summary().pairs()},
                                 {"bytes", input_bytes(job.spec())},
                                 {"queue_seconds", job.queue_seconds()},
                                 {"seconds", seconds},
                                 {"outcome", outcome_of(to)}});
    if (report.has_failure()) fields.push_back({"reason", report.failure().message()});
    log_line(*log_, level, "job ended", fields);
}

void ServerLog::job_submitted(const ServerJob& job, const grpc::ServerContextBase& call) {
    const auto level = level_of(job);
    if (!is_logged(*log_, level)) return;
    log_line(*log_, level, "submit",
             {{"id", job.spec().id()},
              {"owner", job.owner()},
              {"peer", call.peer()},
              {"objects", object_count(job.spec())},
              {"bytes", input_bytes(job.spec())}});
}

void ServerLog::job_asked(const char* call, const ServerJob& job, const Asker& asker) {
    log_line(*log_, LogLevel::info, call,
             {{"id", job.spec().id()}, {"owner", job.owner()}, {"client", asker.client}, {"peer", asker.peer}});
}

void ServerLog::result_sent(const ServerJob& job, const Asker& asker, const Sent& sent) {
    log_line(*log_, LogLevel::info, "result",
             {{"id", job.spec().id()},
              {"owner", job.owner()},
              {"client", asker.client},
              {"peer", asker.peer},
              {"offset", sent.offset},
              {"bytes", sent.bytes},
              {"outcome", sent.outcome}});
}

void ServerLog::limit_refused(const std::string& client, const LimitError& error) {
    metrics_.refused(error.name());
    metrics_.client_refused(client);
    const auto left_out = refused_clients_.pass(client);
    if (!left_out) return;
    std::vector<Field> fields = {
        {"owner", client}, {"limit", error.name()}, {"allowed", error.allowed()}, {"reason", error.what()}};
    if (*left_out > 0) fields.push_back({"unreported", *left_out});
    log_line(*log_, LogLevel::warning, "refused", fields);
}

void ServerLog::connections_refused(std::uint64_t allowed, std::uint64_t refused) {
    log_line(*log_, LogLevel::warning, "refused",
             {{"limit", "connections"},
              {"allowed", allowed},
              {"reason", std::to_string(refused) + " connections refused since the start"}});
}

void ServerLog::connected(const std::string& peer, const std::string& client) {
    std::vector<Field> fields = {{"peer", peer}};
    if (!client.empty()) fields.push_back({"client", client});
    log_line(*log_, LogLevel::info, "connected", fields);
}

void ServerLog::call_refused(const Asker& asker, const grpc::Status& why) {
    const bool going = why.error_code() == grpc::StatusCode::UNAVAILABLE;
    const bool known = why.error_code() == grpc::StatusCode::PERMISSION_DENIED;
    metrics_.call_refused(going ? "going down" : known ? "not permitted" : "unauthenticated");
    std::vector<Field> fields = {{"peer", asker.peer}, {"reason", why.error_message()}};
    if (known) fields.insert(fields.begin(), {"client", asker.client});
    if (!going) {
        const auto left_out = refused_calls_.pass(known ? asker.client : "");
        if (!left_out) return;
        if (*left_out > 0) fields.push_back({"unreported", *left_out});
    }
    log_line(*log_, going ? LogLevel::debug : LogLevel::warning, "call refused", fields);
}

void ServerLog::call_failed(const Asker& asker, const grpc::Status& why) {
    const auto left_out = failed_clients_.pass(asker.client);
    if (!left_out) return;
    std::vector<Field> fields = {{"client", asker.client}, {"peer", asker.peer}, {"reason", why.error_message()}};
    if (*left_out > 0) fields.push_back({"unreported", *left_out});
    log_line(*log_, LogLevel::warning, "call failed", fields);
}

void ServerLog::drain_asked(const Asker& asker) {
    log_line(*log_, LogLevel::info, "drain", {{"client", asker.client}, {"peer", asker.peer}});
}

}  // namespace octopair::service
