// WorkerRegions: the regions of shared memory that a worker has received, by number.
//
// Thread safety: one thread may add regions while another waits for them.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <exception>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <utility>

#include "engine/processes/shared_memory/layout.hpp"
#include "engine/processes/shared_memory/shared_memory.hpp"
#include "octopair/error.hpp"

namespace octopair {

class WorkerRegions {
public:
    void add(std::uint32_t number, SharedMemory memory) {
        auto region = std::make_shared<SharedMemory>(std::move(memory));
        const std::lock_guard lock(mutex_);
        regions_[number] = std::move(region);
        changed_.notify_all();
    }
    void forget(std::uint32_t number) {
        const std::lock_guard lock(mutex_);
        regions_.erase(number);
    }
    /// Stores the failure to map a region. From now on, get() throws `failure`.
    void fail(std::exception_ptr failure) {
        const std::lock_guard lock(mutex_);
        failure_ = std::move(failure);
        changed_.notify_all();
    }
    bool failed() {
        const std::lock_guard lock(mutex_);
        return failure_ != nullptr;
    }
    /// Returns the region `number`. Waits until the region arrives. Throws: the exception given to fail().
    std::shared_ptr<SharedMemory> get(std::uint32_t number) {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [&] { return failure_ != nullptr || regions_.contains(number); });
        if (failure_ != nullptr) std::rethrow_exception(failure_);
        return regions_.at(number);
    }

    /// Returns the elements of an array. `keeper` keeps the region mapped.
    /// Throws: Error{resource_limit} if the array exceeds the region; Error{engine_failed} if its offset is not aligned.
    template <typename T>
    std::span<const T> array(const ArrayRef& ref, std::shared_ptr<SharedMemory>& keeper) {
        if (ref.count == 0) return {};
        keeper = get(ref.region);
        check_place(ref.offset, alignof(T));
        return {keeper->array<const T>(ref.offset, ref.count), std::size_t(ref.count)};
    }

private:
    static void check_place(std::uint64_t offset, std::size_t alignment) {
        if (offset % alignment != 0)
            throw Error(ErrorCode::engine_failed, "shared memory: the offset of an array is not aligned");
    }

    std::mutex mutex_;
    std::condition_variable changed_;
    std::map<std::uint32_t, std::shared_ptr<SharedMemory>> regions_;
    std::exception_ptr failure_;
};

}  // namespace octopair
