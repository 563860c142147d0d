#include "engine/processes/worker/worker_regions.hpp"

#include <utility>

#include "octopair/error.hpp"

namespace octopair {

void WorkerRegions::add(std::uint32_t number, SharedMemory memory) {
    auto region = std::make_shared<SharedMemory>(std::move(memory));
    const std::lock_guard lock(mutex_);
    regions_[number] = std::move(region);
    changed_.notify_all();
}

void WorkerRegions::forget(std::uint32_t number) {
    const std::lock_guard lock(mutex_);
    regions_.erase(number);
}

void WorkerRegions::fail(std::exception_ptr failure) {
    const std::lock_guard lock(mutex_);
    failure_ = std::move(failure);
    changed_.notify_all();
}

bool WorkerRegions::failed() {
    const std::lock_guard lock(mutex_);
    return failure_ != nullptr;
}

std::shared_ptr<SharedMemory> WorkerRegions::get(std::uint32_t number) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return failure_ != nullptr || regions_.contains(number); });
    if (failure_ != nullptr) std::rethrow_exception(failure_);
    return regions_.at(number);
}

void WorkerRegions::check_place(std::uint64_t offset, std::size_t alignment) {
    if (offset % alignment != 0)
        throw Error(ErrorCode::engine_failed, "shared memory: the offset of an array is not aligned");
}

}  // namespace octopair
