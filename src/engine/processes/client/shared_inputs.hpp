// The objects of a call in shared memory: where they lie already, or copied there.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <stop_token>
#include <vector>

#include "engine/processes/client/worker_pool.hpp"
#include "engine/search.hpp"

namespace octopair {

/// Arrays that the application had an engine allocate. They may outlive it. Thread-safe.
class SharedArrays {
public:
    /// Throws Error{resource_limit}.
    static std::shared_ptr<void> allocate(const std::shared_ptr<SharedArrays>& arrays, std::size_t bytes);
    /// The one that holds this memory, or none.
    std::shared_ptr<Region> find(std::span<const std::byte> memory) const;

private:
    mutable std::mutex mutex_;
    std::map<const std::byte*, std::weak_ptr<Region>> regions_;  // by where they begin
};

/// Gives a pass its objects, and keeps the copies from call to call.
class SharedInputs {
public:
    explicit SharedInputs(const SharedArrays& arrays) : arrays_(arrays) {}

    /// Sets the sets of `pass`; appends what its workers need to `regions`. Throws Error{resource_limit, cancelled}.
    void place(const Call& call, WorkerPool& pool, Pass& pass, std::vector<std::shared_ptr<Region>>& regions);

private:
    SetRef place(const Objects& objects, WorkerPool& pool, std::vector<std::shared_ptr<Region>>& regions);
    ArrayRef place(std::span<const std::byte> memory, WorkerPool& pool, std::vector<std::shared_ptr<Region>>& regions);

    const SharedArrays& arrays_;
    std::shared_ptr<Region> copies_;
    std::uint64_t used_ = 0;
    std::stop_token stop_;  // of the call
};

}  // namespace octopair
