#include "service/server/jobs/job_scheduler.hpp"

#include <algorithm>
#include <chrono>

#include "service/protocol/job_spec.hpp"
#include "service/server/jobs/server_job.hpp"

namespace octopair::service {

namespace {

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
    for (Queue* queue : {&small_, &large_}) {
        const std::lock_guard lock(queue->mutex);
        queue->ending = true;
        queue->changed.notify_all();
    }
    threads_.clear();
}

void JobScheduler::hold_detached() {
    for (Queue* queue : {&small_, &large_}) {
        const std::lock_guard lock(queue->mutex);
        queue->holds_detached = true;
    }
}

void JobScheduler::start(Queue& queue, const EngineMaker& maker, unsigned width) {
    engines_.push_back(maker(width));
    threads_.emplace_back([&queue, &engine = *engines_.back()] { drive(queue, engine); });
}

void JobScheduler::drive(Queue& queue, Engine& engine) {
    for (;;) {
        std::shared_ptr<ServerJob> job;
        {
            std::unique_lock lock(queue.mutex);
            while (!queue.ending && !(job = next(queue))) {
                // Memory is given back without a word to the engine_widths.
                queue.jobs.empty() ? queue.changed.wait(lock) : (void)queue.changed.wait_for(lock, ask_again);
            }
            if (queue.ending) return;
        }
        job->run(engine);
    }
}

/// The first job that can run; with the lock held. A detached job that waits for memory lets attached ones, which have
/// theirs, pass, but no other detached one: so it has its turn.
std::shared_ptr<ServerJob> JobScheduler::next(Queue& queue) {
    bool waits = queue.holds_detached;
    for (auto at = queue.jobs.begin(); at != queue.jobs.end(); ++at) {
        if ((*at)->detached() && waits) continue;
        if (!(*at)->ask_memory()) {
            waits = true;
            continue;
        }
        std::shared_ptr<ServerJob> job = std::move(*at);
        queue.jobs.erase(at);
        return job;
    }
    return {};
}

Engine& JobScheduler::engine_for(std::uint64_t objects) { return *engines_[objects <= most_small_objects ? 1 : 0]; }

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
    if (objects <= most_instant_objects && !job->detached() && run_at_once(*job)) return;
    Queue& queue = queue_of(objects);
    const std::lock_guard lock(queue.mutex);
    if (queue.jobs.size() >= queue.drop_from) {  // those that were cancelled while they waited
        std::erase_if(queue.jobs, [](const auto& waiting) { return waiting->ended(); });
        queue.drop_from = std::max(Queue().drop_from, 2 * queue.jobs.size());
    }
    queue.jobs.push_back(std::move(job));
    queue.changed.notify_one();
}

std::uint64_t JobScheduler::queued_before(const ServerJob& job) const {
    for (const Queue* queue : {&small_, &large_}) {
        const std::lock_guard lock(queue->mutex);
        const auto same = [&](const auto& waiting) { return waiting.get() == &job; };
        const auto found = std::find_if(queue->jobs.begin(), queue->jobs.end(), same);
        if (found != queue->jobs.end()) return std::uint64_t(found - queue->jobs.begin());
    }
    return 0;
}

std::uint64_t JobScheduler::waiting() const {
    const std::scoped_lock lock(small_.mutex, large_.mutex);
    return small_.jobs.size() + large_.jobs.size();
}

std::uint64_t JobScheduler::sum(const std::function<std::uint64_t(const Engine&)>& value) const {
    std::uint64_t sum = 0;
    for (const auto& engine : engines_) sum += value(*engine);
    return sum;
}

}  // namespace octopair::service
