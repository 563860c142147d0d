// JobTable: the jobs of a server, by owner and id. JobQuota: limits the number of jobs and scenes.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "service/server/jobs/budget.hpp"

namespace octopair::service {

class ServerJob;

/// Limits the number of unfinished jobs and scenes, in total and for each client.
class JobQuota {
public:
    /// A job or scene that counts against the quota until the slot is destroyed. Requires: the quota outlives the slot.
    class Slot {
    public:
        Slot() = default;
        Slot(Slot&& other) noexcept = default;
        Slot& operator=(Slot&& other) noexcept = default;

    private:
        friend class JobQuota;
        std::shared_ptr<void> counted_;
    };

    /// `most`: limit of all clients together. `max_each`: limit of each client. 0: no limit.
    JobQuota(std::uint64_t most, std::uint64_t max_each);

    /// Throws: LimitError if no slot is free. Thread safety: safe.
    Slot take_slot(const std::string& owner);
    /// Returns the number of slots in use.
    std::uint64_t count() const { return all_.taken(); }

private:
    void add_client_slot(const std::string& owner);

    Budget all_;
    const std::uint64_t max_each_;
    std::mutex mutex_;
    std::map<std::string, std::uint64_t> each_;
};

/// Thread safety: safe.
class JobTable {
public:
    /// Adds a job whose input is complete, and returns the job. If its owner already has a job with this id and the same hash,
    /// returns the older job instead. Throws: Error{bad_input} if the older job has another hash.
    std::shared_ptr<ServerJob> enter(const std::shared_ptr<ServerJob>& job);
    /// Throws: Error{bad_input} if `owner` has no job `id`.
    std::shared_ptr<ServerJob> find(const std::string& owner, const std::string& id) const;
    /// Returns null if `owner` has no job `id`.
    std::shared_ptr<ServerJob> look_up(const std::string& owner, const std::string& id) const;
    /// Returns the jobs of `owner` with ids greater than `after`, ascending by id, at most `most` of them.
    std::vector<std::shared_ptr<ServerJob>> of(const std::string& owner, const std::string& after,
                                               std::size_t most) const;
    std::vector<std::shared_ptr<ServerJob>> all() const;
    /// Removes `job`, but not another job with its owner and id.
    void remove(const ServerJob& job);

private:
    using Key = std::pair<std::string, std::string>;

    mutable std::mutex mutex_;
    std::map<Key, std::shared_ptr<ServerJob>> jobs_;
};

}  // namespace octopair::service
