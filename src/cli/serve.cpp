// octopair serve: the server.
#include <malloc.h>
#include <spdlog/spdlog.h>

#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>

#include "cli/interrupt.hpp"
#include "cli/serve_options.hpp"
#include "cli/subcommands.hpp"
#include "octopair/version.hpp"
#include "service/server/server.hpp"

#ifdef OCTOPAIR_WITH_PROCESSES
#include "octopair/processes.hpp"
#endif

namespace octopair::cli {

namespace {

void wait_for(const std::stop_token& stop) {
    std::mutex mutex;
    std::condition_variable_any changed;
    std::unique_lock lock(mutex);
    changed.wait(lock, stop, [] { return false; });
}

service::ServerOptions options_of(const ServeRequest& request) {
    service::ServerOptions options = request.options;
    const EngineCrew crew = crew_of(request.engine);
    options.engine_name = crew.engine;
    const unsigned width = crew.threads + crew.workers;
    // A worker process is woken for every job anyway.
    options.lanes = {width, width, request.engine.kind == EngineKind::local ? width : 0};
    options.engine = [choice = request.engine](unsigned workers) {
        EngineChoice one = choice;
        (one.kind == EngineKind::processes ? one.workers : one.threads) = workers;
        return make_engine(one);
    };
#ifdef OCTOPAIR_WITH_PROCESSES
    if (request.engine.kind == EngineKind::processes) {
        options.worker_faults = [](const Engine& engine) {
            const WorkerFaults faults = worker_faults(engine);
            return faults.ended + faults.stopped;
        };
    }
#endif
    return options;
}

/// What an upload gave back serves the next one: memory that the system takes meanwhile has to be cleared again, which takes as
/// long as all else that the server does with the bytes.
void keep_freed_memory() {
    mallopt(M_MMAP_THRESHOLD, 2 << 20);
    mallopt(M_TRIM_THRESHOLD, 64 << 20);
}

int run_serve(const ServeRequest& request) {
    keep_freed_memory();
    const Interrupt interrupt;
    const auto log = service::make_log(request.log_form);
    service::take_grpc_log(log);
    log->set_level(spdlog::level::from_str(request.quiet ? "err" : request.log_level));
    const service::ServerOptions options = options_of(request);
    service::Server server(options, log);
    service::log_event(*log, spdlog::level::info, "started",
                       {{"address", server.address().text()},
                        {"version", OCTOPAIR_VERSION},
                        {"engine", options.engine_name},
                        {"width", std::uint64_t(options.lanes.large)}});
    wait_for(interrupt.token());
    log->info("stopping: no more jobs are taken");
    server.drain();
    log->info("stopped");
    return 0;
}

}  // namespace

void add_serve(CLI::App& app, Action& action) {
    CLI::App* command = app.add_subcommand("serve", "find pairs for others: a server");
    const auto request = std::make_shared<ServeRequest>();
    add_serve_options(*command, *request);
    command->callback([command, request, &action] {
        complete_serve_request(*command, *request);
        action = [request] { return run_serve(*request); };
    });
}

}  // namespace octopair::cli
