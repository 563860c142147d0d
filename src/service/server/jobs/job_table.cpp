#include "service/server/jobs/job_table.hpp"

#include "service/protocol/limit_error.hpp"
#include "service/server/jobs/server_job.hpp"

namespace octopair::service {

JobQuota::JobQuota(std::uint64_t most, std::uint64_t max_each) : all_("jobs", "job slots", most), max_each_(max_each) {}

JobQuota::Slot JobQuota::take_slot(const std::string& owner) {
    auto reservation = std::make_shared<Budget::Reservation>(all_.take(1));
    add_client_slot(owner);
    // The deleter locks mutex_. It also runs when this constructor throws std::bad_alloc, so the lock must not be held here.
    Slot slot;
    slot.counted_ = std::shared_ptr<void>(reservation.get(), [this, reservation, owner](void*) {
        const std::lock_guard lock(mutex_);
        const auto found = each_.find(owner);
        if (--found->second == 0) each_.erase(found);
    });
    return slot;
}

void JobQuota::add_client_slot(const std::string& owner) {
    const std::lock_guard lock(mutex_);
    std::uint64_t& count = each_[owner];
    if (max_each_ > 0 && count >= max_each_) {
        throw LimitError("jobs_per_client", max_each_,
                         "jobs_per_client: the client has " + std::to_string(count) + " jobs on the server; at most " +
                             std::to_string(max_each_) + " each");
    }
    ++count;
}

std::shared_ptr<ServerJob> JobTable::enter(const std::shared_ptr<ServerJob>& job) {
    const std::lock_guard lock(mutex_);
    const auto [entry, fresh] = jobs_.try_emplace({job->owner(), job->spec().id()}, job);
    if (fresh) return job;
    const v1::JobReport known = entry->second->report();
    if (known.head().hash() != job->input_hash() || known.detached() != job->detached()) {
        throw Error(ErrorCode::bad_input, "job " + known.id() + " already exists, with other input or options");
    }
    return entry->second;
}

std::shared_ptr<ServerJob> JobTable::find(const std::string& owner, const std::string& id) const {
    std::shared_ptr<ServerJob> found = look_up(owner, id);
    if (!found) throw Error(ErrorCode::bad_input, "there is no job " + id.substr(0, 36));
    return found;
}

std::shared_ptr<ServerJob> JobTable::look_up(const std::string& owner, const std::string& id) const {
    const std::lock_guard lock(mutex_);
    const auto found = jobs_.find({owner, id});
    return found == jobs_.end() ? nullptr : found->second;
}

std::vector<std::shared_ptr<ServerJob>> JobTable::of(const std::string& owner, const std::string& after,
                                                     std::size_t most) const {
    const std::lock_guard lock(mutex_);
    std::vector<std::shared_ptr<ServerJob>> jobs;
    for (auto at = jobs_.upper_bound({owner, after}); at != jobs_.end() && jobs.size() < most; ++at) {
        if (at->first.first != owner) break;
        jobs.push_back(at->second);
    }
    return jobs;
}

std::vector<std::shared_ptr<ServerJob>> JobTable::all() const {
    const std::lock_guard lock(mutex_);
    std::vector<std::shared_ptr<ServerJob>> jobs;
    jobs.reserve(jobs_.size());
    for (const auto& [key, job] : jobs_) jobs.push_back(job);
    return jobs;
}

void JobTable::remove(const ServerJob& job) {
    const std::lock_guard lock(mutex_);
    const auto found = jobs_.find({job.owner(), job.spec().id()});
    if (found != jobs_.end() && found->second.get() == &job) jobs_.erase(found);
}

}  // namespace octopair::service
