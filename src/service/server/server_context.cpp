#include "service/server/server_context.hpp"

#include <grpcpp/server_context.h>

#include <algorithm>
#include <string>
#include <utility>

#include "service/protocol/errors.hpp"
#include "service/protocol/job_spec.hpp"
#include "service/protocol/status.hpp"
#include "service/server/store/detached_jobs.hpp"
#include "service/server/store/state_folder.hpp"
#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace octopair::service {

namespace {

/// Memory of a search in bytes per object, besides input and result. More than threads or workers take (docs/memory.md).
constexpr std::uint64_t working_bytes = 80;

/// Returns Options::buffer_bytes of a search. The memory budget does not count this buffer, which each engine keeps.
std::uint64_t buffer_of(const v1::JobSpec& spec, std::uint64_t memory_bytes) {
    const std::uint64_t most = std::uint64_t(object_count(spec) <= max_small_objects ? 64 : 256) << 20;
    return memory_bytes == 0 ? most : std::min(most, memory_bytes / 8);
}

void check_limit(const char* name, std::uint64_t asked, std::uint64_t allowed) {
    if (allowed == 0 || asked <= allowed) return;
    throw LimitError(name, allowed,
                     "a job of " + std::to_string(asked) + " " + name + "; at most " + std::to_string(allowed));
}

/// Returns freed memory to the system. glibc would keep up to 64 MiB of freed memory in each of several heaps.
void give_back_free_memory() {
#ifdef __GLIBC__
    ::malloc_trim(0);
#endif
}

}  // namespace

void CallThreads::start(std::function<void()> work) {
    const std::lock_guard lock(mutex_);
    running_.remove_if([](const Running& running) { return running.ended.load(); });
    Running& running = running_.emplace_back();
    try {
        running.thread = std::jthread([&running, work = std::move(work)]() mutable {
            work();
            work = nullptr;  // frees what `work` captured before the thread counts as ended
            running.ended = true;
        });
    } catch (...) {
        running_.pop_back();
        throw;
    }
}

ServerContext::ServerContext(const ServerOptions& given, std::shared_ptr<spdlog::logger> logger)
    : options(given),
      log(std::move(logger)),
      access(given.token_file, given.role_file),
      server_log(log),
      memory("memory_bytes", "bytes of memory", given.limits.memory_bytes,
             share_of_client(given, given.limits.memory_bytes, given.limits.memory_bytes_per_client)),
      job_slots("jobs", "job slots", given.limits.jobs, given.limits.jobs_per_client),
      calls("calls", "calls", 0, given.limits.calls_per_client.value_or(tells_clients_apart(given) ? 256 : 0)),
      connections_per_client(share_of_client(given, given.limits.connections, given.limits.connections_per_client)),
      state(given.state_folder.empty()
                ? nullptr
                : std::make_unique<StateFolder>(
                      given.state_folder,
                      StateFolder::Room{given.limits.state_bytes, share_of_client(given, given.limits.state_bytes,
                                                                                  given.limits.state_bytes_per_client)},
                      log)),
      attached("", "", 0),
      scheduler({given.engine, given.small_engine ? given.small_engine : given.engine, tells_clients_apart(given),
                 given.renewable_engines,
                 [this] {
                     array_pool.clear();
                     give_back_free_memory();
                 }},
                given.engine_widths) {
    if (!state) return;
    detached = std::make_shared<DetachedJobs>(*this);
    detached->restore();
    watchdog.watch(detached);
}

ServerContext::~ServerContext() {
    if (detached) detached->abandon();
}

grpc::Status ServerContext::admit(const grpc::ServerContextBase& context, Right right, Admission& admission) {
    grpc::Status status = draining ? grpc::Status(grpc::StatusCode::UNAVAILABLE, "the server is going down")
                                   : access.identify(context, admission.caller);
    if (status.ok() && !admission.caller.may(right)) {
        status = {grpc::StatusCode::PERMISSION_DENIED,
                  "the role " + std::string(name_of(admission.caller.role)) + " does not permit this call"};
    }
    if (!status.ok()) {
        const std::string peer = context.peer();
        server_log.call_refused({admission.client(), peer}, status);
        if (status.error_code() == grpc::StatusCode::UNAUTHENTICATED && on_unknown) on_unknown(peer);
        return status;
    }
    try {
        within_limits(admission.client(), [&] {
            if (on_call) on_call(context, admission.client());
            admission.call = calls.take(1, admission.client());
        });
    } catch (const LimitError& error) {
        return status_of(error);
    }
    return status;
}

std::shared_ptr<ServerJob> ServerContext::find(const Caller& caller, const std::string& owner,
                                               const std::string& id) const {
    if (!caller.sees_all()) return jobs.find(caller.owner(), id);
    return owner.empty() ? jobs.find_only(id) : jobs.find(owner, id);
}

void ServerContext::check_limits(const v1::JobSpec& spec) const {
    check(spec);
    check_limit("objects", object_count(spec), options.limits.objects);
    check_limit("input_bytes", input_bytes(spec), options.limits.input_bytes);
}

std::uint64_t ServerContext::memory_of(const v1::JobSpec& spec) {
    return input_bytes(spec) + object_count(spec) * working_bytes;
}

v1::JobReport ServerContext::report(const ServerJob& job, const Caller& caller) const {
    v1::JobReport report = job.report();
    if (report.state() == v1::QUEUED) report.set_queued_before(scheduler.queued_before(job));
    if (caller.name != job.owner()) report.set_owner(job.owner());
    return report;
}

grpc::Status ServerContext::refuse_stalled(const std::string& owner) {
    const auto seconds = std::uint64_t(options.stall.count());
    const LimitError error("stall_seconds", seconds,
                           "stall_seconds: the upload made no progress for " + std::to_string(seconds) + " s");
    server_log.limit_refused(owner, error);
    return status_of(error);
}

std::shared_ptr<ServerJob> ServerContext::begin(const std::string& owner, v1::JobSpec spec) {
    return within_limits(owner, [&] {
        check_limits(spec);
        ServerJob::Parts parts;
        parts.owner = owner;
        parts.slot = job_slots.take(1, owner);
        parts.memory = memory.take(memory_of(spec), owner);
        parts.input = std::make_unique<UploadedInput>(spec, scheduler.engine_for(object_count(spec)), &array_pool);
        parts.pairs = std::make_unique<PairsInMemory>(memory, options.limits.pairs, owner);
        parts.spec = std::move(spec);
        auto job = make_job(std::move(parts));
        server_log.job_state_changed(*job, {}, v1::UPLOADING);
        return job;
    });
}

std::shared_ptr<ServerJob> ServerContext::make_job(ServerJob::Parts parts) {
    parts.max_seconds = options.limits.job_seconds;
    parts.buffer_bytes = buffer_of(parts.spec, options.limits.memory_bytes);
    parts.on_state_change = [this](const ServerJob& job, v1::JobState from, v1::JobState to) {
        server_log.job_state_changed(job, from, to);
    };
    return std::make_shared<ServerJob>(std::move(parts));
}

void ServerContext::queue(const std::shared_ptr<ServerJob>& job) {
    watchdog.watch(job);
    scheduler.add(job);
}

bool ServerContext::idle() const {
    if (attached.taken() > 0) return false;
    for (const auto& job : jobs.all()) {
        if (job->detached() && job->state() == v1::RUNNING) return false;
    }
    return true;
}

}  // namespace octopair::service
