// JobTable: the jobs of a server, by owner and id.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace octopair::service {

class ServerJob;

/// Thread safety: any thread may call it.
class JobTable {
public:
    /// Adds a job whose input is complete, and returns the job. If its owner already has a job with this id and the same hash,
    /// returns the older job instead. Throws: Error{bad_input} if the older job has another hash.
    std::shared_ptr<ServerJob> enter(const std::shared_ptr<ServerJob>& job);
    /// Throws: Error{bad_input} if `owner` has no job `id`.
    std::shared_ptr<ServerJob> find(const std::string& owner, const std::string& id) const;
    /// Returns null if `owner` has no job `id`.
    std::shared_ptr<ServerJob> look_up(const std::string& owner, const std::string& id) const;
    /// Returns the job with this id, of any owner. Throws: Error{bad_input} if no owner or several owners have such a job.
    std::shared_ptr<ServerJob> find_only(const std::string& id) const;
    /// Returns the jobs of `owner` with ids greater than `after`, ascending by id, at most `most` of them.
    std::vector<std::shared_ptr<ServerJob>> of(const std::string& owner, const std::string& after,
                                               std::size_t most) const;
    /// Returns the jobs of all owners after the job `after` of `owner`, ascending by owner and id, at most `most` of them.
    std::vector<std::shared_ptr<ServerJob>> of_all(const std::string& owner, const std::string& after,
                                                   std::size_t most) const;
    std::vector<std::shared_ptr<ServerJob>> all() const;
    /// Removes `job`, but not another job with its owner and id.
    void remove(const ServerJob& job);

private:
    using Key = std::pair<std::string, std::string>;

    std::vector<std::shared_ptr<ServerJob>> after(const Key& key, bool only_owner, std::size_t most) const;

    mutable std::mutex mutex_;
    std::map<Key, std::shared_ptr<ServerJob>> jobs_;
};

}  // namespace octopair::service
