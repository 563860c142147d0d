// The regions of shared memory that a worker was sent, by their numbers.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <exception>
#include <map>
#include <memory>
#include <mutex>
#include <span>

#include "engine/processes/shared_memory/layout.hpp"
#include "engine/processes/shared_memory/shared_memory.hpp"

namespace octopair {

class WorkerRegions {
public:
    void add(std::uint32_t number, SharedMemory memory);
    void forget(std::uint32_t number);
    /// One could not be taken: whoever wants any is told, from now on.
    void fail(std::exception_ptr failure);
    bool failed();
    /// Waits until it has come.
    std::shared_ptr<SharedMemory> get(std::uint32_t number);

    /// The elements of an array, whose region is kept by `keeper`. Throws Error{resource_limit} if it does not lie within
    /// the region, Error{engine_failed} if it lies askew.
    template <typename T>
    std::span<const T> array(const ArrayRef& ref, std::shared_ptr<SharedMemory>& keeper) {
        if (ref.count == 0) return {};
        keeper = get(ref.region);
        check_place(ref.offset, alignof(T));
        return {keeper->array<const T>(ref.offset, ref.count), std::size_t(ref.count)};
    }

private:
    static void check_place(std::uint64_t offset, std::size_t alignment);

    std::mutex mutex_;
    std::condition_variable come_;
    std::map<std::uint32_t, std::shared_ptr<SharedMemory>> regions_;
    std::exception_ptr failure_;
};

}  // namespace octopair
