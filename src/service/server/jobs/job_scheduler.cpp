#include "service/server/jobs/job_scheduler.hpp"

#include <algorithm>
#include <chrono>
#include <exception>
#include <set>
#include <string_view>
#include <utility>

#include "service/protocol/job_spec.hpp"
#include "service/server/jobs/server_job.hpp"

namespace octopair::service {

namespace {

/// Interval at which a thread checks again whether a waiting job can get memory. Freed memory sends no notification.
constexpr std::chrono::milliseconds ask_again(20);

/// Minimum estimate of a job's work, in objects: receiving and answering a job costs as much as a search of 1000 objects.
constexpr std::uint64_t min_work = 1000;
/// Number of objects with few pairs that one thread searches in a second. Converts the run time of a job to work in objects.
constexpr double objects_per_second = 2e7;

/// Returns the estimated work of a job, in objects.
double work_of(const ServerJob& job) { return double(std::max<std::uint64_t>(object_count(job.spec()), min_work)); }

}  // namespace

JobScheduler::JobScheduler(const Makers& makers, const Widths& widths)
    : tells_clients_apart_(makers.tells_clients_apart),
      renewable_(makers.renewable),
      on_idle_(makers.on_idle),
      instant_(widths.instant) {
    for (Instant& instant : instant_) instant.engine = std::make_unique<KeptEngine>(makers.small, 1);
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
    small_.queue.close();
    large_.queue.close();
    threads_.clear();
}

void JobScheduler::start(Lane& lane, const EngineMaker& maker, unsigned width) {
    engines_.push_back(std::make_unique<KeptEngine>(maker, width));
    {
        const std::lock_guard lock(lane.mutex);
        ++lane.engines;
    }
    threads_.emplace_back([this, &lane, &engine = *engines_.back()] {
        lane.queue.run([this, &lane](Queue::Items& jobs) { return next_ready(jobs, lane); }, ask_again,
                       [this, &lane, &engine](const std::shared_ptr<ServerJob>& job) { run_next(lane, engine, job); },
                       Queue::Idle{idle_before_renewal, [this, &lane, &engine] { renew_idle(lane, engine); }});
    });
}

void JobScheduler::run_next(Lane& lane, KeptEngine& engine, const std::shared_ptr<ServerJob>& job) {
    const auto began = std::chrono::steady_clock::now();
    const bool again = job->run(engine.use()) == ServerJob::Ran::queued_again;
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
    {
        const std::lock_guard lock(lane.mutex);
        lane.order.add(job->owner(), std::max(0.0, took.count() * objects_per_second - work_of(*job)));
        if (--lane.running[job->owner()] == 0) lane.running.erase(job->owner());
    }
    ++ended_;
    if (again) lane.queue.add(job);
}

/// Frees the memory that `engine` keeps, by making the engine anew. Called when the engine's thread had no job for a while. An engine
/// that an upload uses is left unchanged, and made anew after a later idle time.
void JobScheduler::renew_idle(Lane& lane, KeptEngine& engine) {
    const bool is_large = &lane == &large_;
    try {
        if (renewable_) engine.renew();
        for (Instant& instant : instant_) {
            if (renewable_ && is_large) instant.engine->renew();
        }
    } catch (const std::exception&) {  // no memory or no thread for a new engine: the old one stays
    }
    const std::uint64_t ended = ended_;
    if (is_large && on_idle_ && std::exchange(cleaned_after_, ended) != ended) on_idle_();
}

/// Returns the next job to run, or jobs.end() if no job can run. Candidates are the first attached and the first detached job of each
/// client. Jobs that wait for room for their results are skipped.
JobScheduler::Queue::Items::iterator JobScheduler::next_ready(Queue::Items& jobs, Lane& lane) const {
    struct Candidate {
        double start;
        Queue::Items::iterator job;
    };
    const std::lock_guard lock(lane.mutex);
    const unsigned most = tells_clients_apart_ ? std::max(1u, lane.engines - 1) : lane.engines;
    std::vector<Candidate> candidates;
    std::set<std::pair<std::string_view, bool>> seen;
    for (auto job = jobs.begin(); job != jobs.end(); ++job) {
        if ((*job)->waits_for_room()) continue;
        const std::string& owner = (*job)->owner();
        const auto running = lane.running.find(owner);
        if (running != lane.running.end() && running->second >= most) continue;
        if (seen.emplace(owner, (*job)->detached()).second) candidates.push_back({lane.order.start_of(owner), job});
    }
    std::ranges::stable_sort(candidates, {}, &Candidate::start);
    bool detached_wait = holds_detached_;
    for (const auto& [start, job] : candidates) {
        if ((*job)->detached() && detached_wait) continue;
        if ((*job)->ask_memory()) {
            lane.order.begin((*job)->owner(), work_of(**job));
            ++lane.running[(*job)->owner()];
            return job;
        }
        detached_wait = true;
    }
    return jobs.end();
}

std::shared_ptr<Engine> JobScheduler::engine_for(std::uint64_t objects) {
    return engines_[objects <= max_small_objects ? 1 : 0]->use();
}

bool JobScheduler::run_at_once(ServerJob& job) {
    for (Instant& instant : instant_) {
        const std::unique_lock lock(instant.mutex, std::try_to_lock);
        if (!lock.owns_lock()) continue;
        (void)job.run(instant.engine->use());
        ++ended_;
        return true;
    }
    return false;
}

void JobScheduler::add(std::shared_ptr<ServerJob> job) {
    const std::uint64_t objects = object_count(job->spec());
    if (objects <= max_instant_objects && !job->detached() && run_at_once(*job)) return;
    lane_of(objects).queue.add(std::move(job), [](const auto& waiting) { return waiting->ended(); });
}

std::uint64_t JobScheduler::queued_before(const ServerJob& job) const {
    const auto is_job = [&](const auto& waiting) { return waiting.get() == &job; };
    return small_.queue.waiting_before(is_job) + large_.queue.waiting_before(is_job);
}

std::uint64_t JobScheduler::sum(const std::function<std::uint64_t(const Engine&)>& value) const {
    std::uint64_t sum = 0;
    for (const auto& engine : engines_) sum += value(*engine->use());
    return sum;
}

}  // namespace octopair::service
