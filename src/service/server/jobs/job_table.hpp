// JobTable: the jobs of a server, by their owner and id, and how many there may be.
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

/// How many things clients have, in all and each.
class ClientCounts {
public:
    /// One thing's; counted until it goes.
    class Place {
    public:
        Place() = default;
        Place(Place&& other) noexcept = default;
        Place& operator=(Place&& other) noexcept = default;

    private:
        friend class ClientCounts;
        std::shared_ptr<void> counted_;
    };

    /// 0: no limit.
    ClientCounts(std::uint64_t most, std::uint64_t most_each);

    /// Throws a LimitError. Thread-safe. Must not outlive this.
    Place enter(const std::string& owner);
    std::uint64_t count() const { return all_.taken(); }

private:
    void count_one_more(const std::string& owner);

    Budget all_;
    const std::uint64_t most_each_;
    std::mutex mutex_;
    std::map<std::string, std::uint64_t> each_;
};

/// Thread-safe.
class JobTable {
public:
    /// Enters a job whose input is complete. If its owner has one with its id already and both ask the same, returns that;
    /// throws Error{bad_input} if they do not.
    std::shared_ptr<ServerJob> enter(const std::shared_ptr<ServerJob>& job);
    /// Throws Error{bad_input} if the owner has no such job.
    std::shared_ptr<ServerJob> find(const std::string& owner, const std::string& id) const;
    /// The same, or null.
    std::shared_ptr<ServerJob> look_up(const std::string& owner, const std::string& id) const;
    /// The owner's, ascending by id, those behind `after`, at most so many.
    std::vector<std::shared_ptr<ServerJob>> of(const std::string& owner, const std::string& after,
                                               std::size_t most) const;
    std::vector<std::shared_ptr<ServerJob>> all() const;
    /// Forgets this very job.
    void remove(const ServerJob& job);

private:
    using Key = std::pair<std::string, std::string>;

    mutable std::mutex mutex_;
    std::map<Key, std::shared_ptr<ServerJob>> jobs_;
};

}  // namespace octopair::service
