#include "service/server/jobs/job_scheduler.hpp"

#include <algorithm>
#include <chrono>
#include <set>
#include <string_view>
#include <utility>

#include "service/protocol/job_spec.hpp"
#include "service/server/jobs/server_job.hpp"

namespace octopair::service {

namespace {

/// How soon a job that waits for memory asks again: nothing signals that memory was given back.
constexpr std::chrono::milliseconds ask_again(20);

/// Work of the smallest job, in objects: taking and answering it costs as much.
constexpr std::uint64_t min_work = 1000;

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
    small_.queue.close();
    large_.queue.close();
    threads_.clear();
}

void JobScheduler::start(Lane& lane, const EngineMaker& maker, unsigned width) {
    engines_.push_back(maker(width));
    threads_.emplace_back([this, &lane, &engine = *engines_.back()] {
        lane.queue.run([this, &lane](Queue::Items& jobs) { return next_ready(jobs, lane.order); }, ask_again,
                       [&lane, &engine](const std::shared_ptr<ServerJob>& job) {
                           if (job->run(engine) == ServerJob::Ran::queued_again) lane.queue.add(job);
                       });
    });
}

/// Returns the job whose turn it is among those that can run, or jobs.end(). Candidates are the first attached and the first detached
/// job of each client. Jobs that wait for room for their results let all others pass.
JobScheduler::Queue::Items::iterator JobScheduler::next_ready(Queue::Items& jobs, FairOrder& order) const {
    struct Candidate {
        double start;
        Queue::Items::iterator job;
    };
    std::vector<Candidate> candidates;
    std::set<std::pair<std::string_view, bool>> seen;
    for (auto job = jobs.begin(); job != jobs.end(); ++job) {
        if ((*job)->waits_for_room()) continue;
        if (seen.emplace((*job)->owner(), (*job)->detached()).second)
            candidates.push_back({order.start_of((*job)->owner()), job});
    }
    std::ranges::stable_sort(candidates, {}, &Candidate::start);
    bool detached_wait = holds_detached_;
    for (const auto& [start, job] : candidates) {
        if ((*job)->detached() && detached_wait) continue;
        if ((*job)->ask_memory()) {
            order.begin((*job)->owner(), double(std::max<std::uint64_t>(object_count((*job)->spec()), min_work)));
            return job;
        }
        detached_wait = true;
    }
    return jobs.end();
}

Engine& JobScheduler::engine_for(std::uint64_t objects) { return *engines_[objects <= max_small_objects ? 1 : 0]; }

bool JobScheduler::run_at_once(ServerJob& job) {
    for (Instant& instant : instant_) {
        const std::unique_lock lock(instant.mutex, std::try_to_lock);
        if (!lock.owns_lock()) continue;
        (void)job.run(*instant.engine);
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
    for (const auto& engine : engines_) sum += value(*engine);
    return sum;
}

}  // namespace octopair::service
