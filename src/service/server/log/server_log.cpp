#include "service/server/log/server_log.hpp"

#include <grpcpp/support/status.h>

#include <utility>
#include <vector>

#include "service/protocol/limit_error.hpp"
#include "service/server/jobs/server_job.hpp"
#include "service/server/log/event.hpp"

namespace octopair::service {

namespace {

const char* outcome_of(v1::JobState state) {
    if (state == v1::DONE) return "done";
    return state == v1::FAILED ? "failed" : "cancelled";
}

}  // namespace

void ServerLog::job_state_changed(const ServerJob& job, std::optional<v1::JobState> from, v1::JobState to) {
    metrics_.job_state_changed(from, to);
    if (to < v1::DONE) return;
    const v1::JobReport report = job.report();
    const double seconds = job.seconds();
    metrics_.job_ended(report, seconds);
    // Jobs without an id (of DetectSmall) can end thousands of times a second, so they are logged at level debug.
    const bool small = report.id().empty();
    const auto level = to == v1::FAILED ? LogLevel::warning : small ? LogLevel::debug : LogLevel::info;
    if (!is_logged(*log_, level)) return;
    std::vector<Field> fields;
    if (!small) fields.push_back({"id", report.id()});
    fields.insert(fields.end(), {{"owner", job.owner()},
                                 {"objects", report.objects()},
                                 {"pairs", report.summary().pairs()},
                                 {"seconds", seconds},
                                 {"outcome", outcome_of(to)}});
    if (report.has_failure()) fields.push_back({"reason", report.failure().message()});
    log_event(*log_, level, "job ended", fields);
}

void ServerLog::limit_refused(const std::string& owner, const LimitError& error) {
    metrics_.refused(error.name());
    log_event(*log_, LogLevel::warning, "refused",
              {{"owner", owner}, {"limit", error.name()}, {"allowed", error.allowed()}, {"reason", error.what()}});
}

void ServerLog::connections_refused(std::uint64_t allowed, std::uint64_t refused) {
    log_event(*log_, LogLevel::warning, "refused",
              {{"limit", "connections"},
               {"allowed", allowed},
               {"reason", std::to_string(refused) + " connections refused since the start"}});
}

void ServerLog::call_refused(const std::string& peer, const grpc::Status& why) {
    const bool going = why.error_code() == grpc::StatusCode::UNAVAILABLE;
    metrics_.call_refused(going ? "going down" : "unauthenticated");
    std::vector<Field> fields = {{"peer", peer}, {"reason", why.error_message()}};
    if (!going) {
        constexpr std::chrono::seconds apart(1);
        const std::lock_guard lock(mutex_);
        const auto now = std::chrono::steady_clock::now();
        if (last_refusal_ != std::chrono::steady_clock::time_point() && now - last_refusal_ < apart) {
            ++unreported_;
            return;
        }
        last_refusal_ = now;
        if (unreported_ > 0) fields.push_back({"unreported", std::exchange(unreported_, 0)});
    }
    log_event(*log_, going ? LogLevel::debug : LogLevel::warning, "call refused", fields);
}

}  // namespace octopair::service
