#include "service/server/jobs/job_scheduler.hpp"

#include <chrono>
#include <utility>

#include "service/protocol/job_spec.hpp"
#include "service/server/jobs/server_job.hpp"

namespace octopair::service {

namespace {

/// How soon a job that waits for memory asks again: nothing signals that memory was given back.
constexpr std::chrono::milliseconds ask_again(20);

}  // namespace

JobScheduler::JobScheduler(const Makers& makers, const Widths& widths) : instant_(widths.instant) {
    for (Instant& instant : instant_) instant.engine = makers.small(1);
    try {
        start(large_, makers.large, widths.large);
        for (unsigned i = 0; i < widths.small; ++i) start(small_, makers.small, 1);
    } catch (...) {
        stop();
        throw;
    }
}

JobScheduler::~JobScheduler() { stop(); }

void JobScheduler::stop() {
    small_.close();
    large_.close();
    threads_.clear();
}

void JobScheduler::start(Queue& queue, const EngineMaker& maker, unsigned width) {
    engines_.push_back(maker(width));
    threads_.emplace_back([this, &queue, &engine = *engines_.back()] {
        queue.run([this](Queue::Items& jobs) { return first_ready(jobs); }, ask_again,
                  [&engine](const std::shared_ptr<ServerJob>& job) { job->run(engine); });
    });
}

/// Returns the first job that can run, or jobs.end().
JobScheduler::Queue::Items::iterator JobScheduler::first_ready(Queue::Items& jobs) const {
    bool detached_wait = holds_detached_;
    for (auto job = jobs.begin(); job != jobs.end(); ++job) {
        if ((*job)->detached() && detached_wait) continue;
        if ((*job)->ask_memory()) return job;
        detached_wait = true;
    }
    return jobs.end();
}

Engine& JobScheduler::engine_for(std::uint64_t objects) { return *engines_[objects <= max_small_objects ? 1 : 0]; }

bool JobScheduler::run_at_once(ServerJob& job) {
    for (Instant& instant : instant_) {
        const std::unique_lock lock(instant.mutex, std::try_to_lock);
        if (!lock.owns_lock()) continue;
        job.run(*instant.engine);
        return true;
    }
    return false;
}

void JobScheduler::add(std::shared_ptr<ServerJob> job) {
    const std::uint64_t objects = object_count(job->spec());
    if (objects <= max_instant_objects && !job->detached() && run_at_once(*job)) return;
    queue_of(objects).add(std::move(job), [](const auto& waiting) { return waiting->ended(); });
}

std::uint64_t JobScheduler::queued_before(const ServerJob& job) const {
    const auto is_job = [&](const auto& waiting) { return waiting.get() == &job; };
    return small_.waiting_before(is_job) + large_.waiting_before(is_job);
}

std::uint64_t JobScheduler::sum(const std::function<std::uint64_t(const Engine&)>& value) const {
    std::uint64_t sum = 0;
    for (const auto& engine : engines_) sum += value(*engine);
    return sum;
}

}  // namespace octopair::service
