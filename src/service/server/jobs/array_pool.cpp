#include "service/server/jobs/array_pool.hpp"

#include <algorithm>
#include <utility>

namespace octopair::service {

namespace {

/// Minimum size of a pooled array. The allocator reuses smaller ones well enough.
constexpr std::uint64_t min_spare_bytes = std::uint64_t(1) << 20;
/// Maximum size of all pooled arrays together.
constexpr std::uint64_t max_spare_bytes = std::uint64_t(128) << 20;

std::uint64_t size_of(const AnyBoxes& boxes) {
    return std::visit([](const auto& array) { return array.size(); }, boxes);
}

std::uint64_t bytes_of(const AnyBoxes& boxes) {
    return std::visit([](const auto& array) { return std::as_bytes(array.boxes()).size(); }, boxes);
}

}  // namespace

AnyBoxes ArrayPool::find(const Engine& engine, std::size_t kind, std::uint64_t count) {
    const std::lock_guard lock(mutex_);
    const auto fits = [&](const Spare& spare) {
        const std::uint64_t size = size_of(spare.boxes);
        return spare.engine == &engine && spare.boxes.index() == kind && size >= count && size - count <= count / 8;
    };
    const auto found = std::find_if(spares_.rbegin(), spares_.rend(), fits);
    AnyBoxes boxes = kind == 0 ? AnyBoxes(BoxArray<Box3f>()) : AnyBoxes(BoxArray<Box3d>());
    if (found == spares_.rend()) return boxes;
    boxes = std::move(found->boxes);
    spares_.erase(std::next(found).base());
    bytes_ -= bytes_of(boxes);
    return boxes;
}

void ArrayPool::give(const Engine& engine, AnyBoxes boxes) noexcept {
    const std::uint64_t bytes = bytes_of(boxes);
    if (bytes < min_spare_bytes || bytes > max_spare_bytes) return;
    const std::lock_guard lock(mutex_);
    while (bytes_ + bytes > max_spare_bytes) {
        bytes_ -= bytes_of(spares_.front().boxes);
        spares_.erase(spares_.begin());
    }
    try {
        spares_.push_back({&engine, std::move(boxes)});
        bytes_ += bytes;
    } catch (const std::bad_alloc&) {  // the array is freed
    }
}

void ArrayPool::clear() noexcept {
    std::vector<Spare> freed;  // after the lock is released
    const std::lock_guard lock(mutex_);
    freed.swap(spares_);
    bytes_ = 0;
}

std::uint64_t ArrayPool::bytes() const {
    const std::lock_guard lock(mutex_);
    return bytes_;
}

}  // namespace octopair::service
