#include "cli/server/serving.hpp"

#include <pthread.h>
#include <spdlog/logger.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <cstdint>
#include <exception>
#include <mutex>
#include <string>
#include <thread>

#include "base/control_group.hpp"
#include "octopair/version.hpp"

#ifdef OCTOPAIR_WITH_PROCESSES
#include "octopair/processes.hpp"
#endif

namespace octopair::cli {

unsigned threads_for_instant_jobs() { return std::clamp(std::thread::hardware_concurrency() / 2, 2U, 16U) - 1; }

service::ServerOptions server_options_of(const ServeRequest& request) {
    service::ServerOptions options = request.options;
    const EngineDescription described = describe_engine(request.engine);
    options.engine_name = described.engine;
    const unsigned width = described.threads + described.workers;
    const bool local = request.engine.runs_in_caller();
    // Small jobs get width + 1 engines: one client may use all but one of them, so a single client can use `width`. With worker processes
    // no job runs on the calling thread, because every job wakes another process.
    options.engine_widths = {width, width + 1, local ? std::min(width, threads_for_instant_jobs()) : 0};
    options.renewable_engines = local;
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
    service::log_line(log, service::LogLevel::info, "started", fields);
}

void fit_descriptors(service::ServerLimits& limits, spdlog::logger& log) {
    // reserved: descriptors for files of jobs, engines and the log. A connection needs a second descriptor until its first call.
    constexpr rlim_t reserved = 96, smallest = 256, for_connection = 2;
    rlimit files{};
    if (::getrlimit(RLIMIT_NOFILE, &files) != 0) return;
    files.rlim_cur = files.rlim_max;
    if (::setrlimit(RLIMIT_NOFILE, &files) != 0) (void)::getrlimit(RLIMIT_NOFILE, &files);
    if (files.rlim_cur == RLIM_INFINITY || files.rlim_cur < smallest) return;
    const std::uint64_t fits = (files.rlim_cur - reserved) / for_connection;
    if (limits.connections != 0 && limits.connections <= fits) return;
    limits.connections = fits;
    log_text(log, service::LogLevel::warning,
             "at most " + std::to_string(fits) + " connections: the system allows this process " +
                 std::to_string(files.rlim_cur) + " open files");
}

void fit_memory(service::ServerLimits& limits, spdlog::logger& log) {
    // The whole process needs more memory than ServerLimits::memory_bytes (docs/server.md): `fixed` bytes, and a fraction of the limit.
    constexpr std::uint64_t fixed = std::uint64_t(384) << 20, least = std::uint64_t(64) << 20;
    const std::uint64_t machine = std::uint64_t(::sysconf(_SC_PHYS_PAGES)) * std::uint64_t(::sysconf(_SC_PAGESIZE));
    const std::uint64_t memory = std::min(machine, control_group_limits().memory_bytes.value_or(machine));
    const std::uint64_t fits = std::max(least, (memory - std::min(memory, fixed)) / 4 * 3);
    if (limits.memory_bytes == 0 || limits.memory_bytes <= fits) return;
    limits.memory_bytes = fits;
    service::log_text(log, service::LogLevel::warning,
                      "at most " + std::to_string(fits) + " bytes for jobs: the machine or the control group has " +
                          std::to_string(memory) + " bytes of memory");
}

namespace {

sigset_t hang_up() {
    sigset_t set;
    sigemptyset(&set);
    sigaddset(&set, SIGHUP);
    return set;
}

void reload(service::Server& server, spdlog::logger& log) {
    try {
        server.reload();
        log_text(log, service::LogLevel::info, "read tokens, roles and certificates again");
    } catch (const std::exception& error) {
        log_text(log, service::LogLevel::error,
                 "tokens, roles and certificates: cannot read them again: " + std::string(error.what()) +
                     "; those read before stay in use");
    }
}

}  // namespace

void block_hang_up() {
    const sigset_t set = hang_up();
    pthread_sigmask(SIG_BLOCK, &set, nullptr);
    std::signal(SIGHUP, SIG_DFL);  // sigwait() may not return for an ignored signal
}

Reloader::Reloader(service::Server& server, spdlog::logger& log)
    : thread_([this, &server, &log] {
          const sigset_t set = hang_up();
          for (int signal = 0; sigwait(&set, &signal) == 0 && !ends_;) reload(server, log);
      }) {}

Reloader::~Reloader() {
    ends_ = true;
    pthread_kill(thread_.native_handle(), SIGHUP);
    thread_.join();
}

void wait_for_stop(const std::stop_token& stop, const std::function<void()>& sometimes) {
    constexpr std::chrono::seconds apart(5);
    std::mutex mutex;
    std::condition_variable_any changed;
    std::unique_lock lock(mutex);
    while (!stop.stop_requested()) {
        (void)changed.wait_for(lock, stop, apart, [] { return false; });
        if (sometimes) sometimes();
    }
}

void drain(spdlog::logger& log, service::Server& server) {
    service::log_text(log, service::LogLevel::info, "stopping: no more jobs are taken");
    server.drain();
    service::log_text(log, service::LogLevel::info, "stopped");
}

}  // namespace octopair::cli
