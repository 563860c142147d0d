#include "cli/server/serving.hpp"

#include <spdlog/logger.h>

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <string>

#include "octopair/version.hpp"

#ifdef OCTOPAIR_WITH_PROCESSES
#include "octopair/processes.hpp"
#endif

namespace octopair::cli {

service::ServerOptions server_options_of(const ServeRequest& request) {
    service::ServerOptions options = request.options;
    const EngineDescription described = describe_engine(request.engine);
    options.engine_name = described.engine;
    const unsigned width = described.threads + described.workers;
    // With worker processes no job is instant, because every job wakes another process.
    options.engine_widths = {width, width, request.engine.runs_in_caller() ? width : 0};
    options.engine = [choice = request.engine](unsigned one_width) {
        return make_engine(choice.with_width(one_width));
    };
#ifdef OCTOPAIR_WITH_PROCESSES
    if (request.engine.has_workers()) {
        options.worker_faults = [](const Engine& engine) {
            const WorkerFaults faults = worker_faults(engine);
            return faults.ended + faults.stopped;
        };
    }
#endif
    return options;
}

std::shared_ptr<spdlog::logger> make_log(const ServeRequest& request) {
    auto log = service::make_log(request.log_form);
    service::take_grpc_log(log);
    log->set_level(spdlog::level::from_str(request.quiet ? "err" : request.log_level));
    return log;
}

void log_start(spdlog::logger& log, const service::Server& server, const service::ServerOptions& options,
               const std::vector<service::Field>& more) {
    std::vector<service::Field> fields = {{"address", server.address().text()},
                                          {"version", OCTOPAIR_VERSION},
                                          {"engine", options.engine_name},
                                          {"width", std::uint64_t(options.engine_widths.large)}};
    fields.insert(fields.end(), more.begin(), more.end());
    service::log_event(log, service::LogLevel::info, "started", fields);
}

void wait_for_stop(const std::stop_token& stop) {
    std::mutex mutex;
    std::condition_variable_any changed;
    std::unique_lock lock(mutex);
    changed.wait(lock, stop, [] { return false; });
}

void drain(spdlog::logger& log, service::Server& server) {
    service::log_text(log, service::LogLevel::info, "stopping: no more jobs are taken");
    server.drain();
    service::log_text(log, service::LogLevel::info, "stopped");
}

}  // namespace octopair::cli
