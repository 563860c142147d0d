// SharedInputs: gives workers the objects of a call in shared memory. Copies arrays that are not already there.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <stop_token>
#include <vector>

#include "engine/passes.hpp"
#include "engine/processes/client/worker_pool.hpp"

namespace octopair {

/// Arrays in shared memory that the application allocated with an engine. They may outlive the engine.
/// Thread safety: any thread.
class SharedArrays {
public:
    /// Returns an array of `bytes` bytes, registered in `arrays` until its last owner releases it.
    /// Throws: Error{resource_limit}.
    static std::shared_ptr<void> allocate(const std::shared_ptr<SharedArrays>& arrays, std::size_t bytes);
    /// Returns the region that contains `memory`, or null.
    std::shared_ptr<Region> find(std::span<const std::byte> memory) const;

private:
    mutable std::mutex mutex_;
    std::map<const std::byte*, std::weak_ptr<Region>> regions_;  // keyed by their first byte
};

/// Places the objects of a call in shared memory. Keeps the memory of copies for later calls.
class SharedInputs {
public:
    explicit SharedInputs(const SharedArrays& arrays) : arrays_(arrays) {}

    /// Sets `first`, `second` and `join` of `pass`. Appends the regions that workers need to `regions`.
    /// Throws: Error{resource_limit}, Error{cancelled}.
    void place(const Call& call, WorkerPool& pool, Pass& pass, std::vector<std::shared_ptr<Region>>& regions);

private:
    SetRef place(const Objects& objects, WorkerPool& pool, std::vector<std::shared_ptr<Region>>& regions);
    ArrayRef place(std::span<const std::byte> memory, WorkerPool& pool, std::vector<std::shared_ptr<Region>>& regions);

    const SharedArrays& arrays_;
    std::shared_ptr<Region> copies_;
    std::uint64_t used_ = 0;  // bytes of copies_
    std::stop_token stop_;    // of the current call
};

}  // namespace octopair
