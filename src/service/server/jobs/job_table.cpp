#include "service/server/jobs/job_table.hpp"

#include <utility>

#include "octopair/error.hpp"
#include "service/protocol/errors.hpp"
#include "service/server/jobs/server_job.hpp"

namespace octopair::service {

namespace {

NoJobError no_job(const std::string& id) { return NoJobError("there is no job " + id.substr(0, 36)); }

}  // namespace

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
    if (!found) throw no_job(id);
    return found;
}

std::shared_ptr<ServerJob> JobTable::look_up(const std::string& owner, const std::string& id) const {
    const std::lock_guard lock(mutex_);
    const auto found = jobs_.find({owner, id});
    return found == jobs_.end() ? nullptr : found->second;
}

std::shared_ptr<ServerJob> JobTable::find_only(const std::string& id) const {
    std::shared_ptr<ServerJob> found;
    for (auto& job : all()) {
        if (job->spec().id() != id) continue;
        if (found) throw Error(ErrorCode::bad_input, "several owners have a job " + id + "; name the owner");
        found = std::move(job);
    }
    if (!found) throw no_job(id);
    return found;
}

std::vector<std::shared_ptr<ServerJob>> JobTable::of(const std::string& owner, const std::string& after,
                                                     std::size_t most) const {
    return this->after({owner, after}, true, most);
}

std::vector<std::shared_ptr<ServerJob>> JobTable::of_all(const std::string& owner, const std::string& after,
                                                         std::size_t most) const {
    return this->after({owner, after}, false, most);
}

std::vector<std::shared_ptr<ServerJob>> JobTable::after(const Key& key, bool only_owner, std::size_t most) const {
    const std::lock_guard lock(mutex_);
    std::vector<std::shared_ptr<ServerJob>> jobs;
    for (auto at = jobs_.upper_bound(key); at != jobs_.end() && jobs.size() < most; ++at) {
        if (only_owner && at->first.first != key.first) break;
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
