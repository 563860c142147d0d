#include "engine/processes/client/shared_inputs.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include "base/stop.hpp"

namespace octopair {

std::shared_ptr<void> SharedArrays::allocate(const std::shared_ptr<SharedArrays>& arrays, std::size_t bytes) {
    constexpr std::size_t page = 4096;
    const std::size_t size = std::max(page, (bytes + page - 1) / page * page);
    auto region = std::make_shared<Region>(SharedMemory::create(size));
    region->memory.commit(0, size);
    std::byte* const data = region->memory.data();
    const std::weak_ptr<Region> known = region;
    std::shared_ptr<void> array(data, [region = std::move(region), weak = std::weak_ptr(arrays)](void* memory) mutable {
        if (const auto all = weak.lock()) {
            const std::lock_guard lock(all->mutex_);
            all->regions_.erase(static_cast<const std::byte*>(memory));
        }
        region = nullptr;
    });
    const std::lock_guard lock(arrays->mutex_);
    arrays->regions_[data] = known;
    return array;
}

std::shared_ptr<Region> SharedArrays::find(std::span<const std::byte> memory) const {
    const std::lock_guard lock(mutex_);
    const auto after = regions_.upper_bound(memory.data());
    if (after == regions_.begin()) return nullptr;
    auto region = std::prev(after)->second.lock();
    const bool holds = region != nullptr && region->memory.contains(memory.data()) &&
                       region->memory.contains(memory.data() + memory.size() - 1);
    return holds ? region : nullptr;
}

void SharedInputs::place(const Call& call, WorkerPool& pool, Pass& pass,
                         std::vector<std::shared_ptr<Region>>& regions) {
    const detail::Request& request = call.request;
    stop_ = call.stop.get_token();
    used_ = 0;
    pass.first = place(request.first, pool, regions);
    pass.second = request.second != nullptr ? place(*request.second, pool, regions) : SetRef{};
    pass.join = request.second != nullptr ? 1 : 0;
}

SetRef SharedInputs::place(const Objects& objects, WorkerPool& pool, std::vector<std::shared_ptr<Region>>& regions) {
    SetRef set;
    set.wide = std::holds_alternative<std::span<const Box3d>>(objects.boxes) ? 1 : 0;
    std::visit(
        [&](auto boxes) {
            set.boxes = place(std::as_bytes(boxes), pool, regions);
            set.boxes.count = boxes.size();
        },
        objects.boxes);
    set.padding = place(std::as_bytes(objects.padding), pool, regions);
    set.padding.count = objects.padding.size();
    return set;
}

ArrayRef SharedInputs::place(std::span<const std::byte> memory, WorkerPool& pool,
                             std::vector<std::shared_ptr<Region>>& regions) {
    constexpr std::uint64_t alignment = 64;
    if (memory.empty()) return {};
    if (const auto shared = arrays_.find(memory)) {
        pool.register_region(shared);
        regions.push_back(shared);
        return {shared->number, std::uint64_t(memory.data() - shared->memory.data()), 0};
    }
    if (copies_ == nullptr) copies_ = pool.add_region(SharedMemory::create(max_region_bytes()));
    regions.push_back(copies_);
    const ArrayRef copy{copies_->number, used_, 0};
    constexpr std::size_t piece = std::size_t(1) << 24;  // bytes: a few milliseconds between checks for a stop
    for (std::size_t at = 0; at < memory.size(); at += piece) {
        throw_if_stopped(stop_);
        const auto part = memory.subspan(at, std::min(piece, memory.size() - at));
        std::memcpy(copies_->memory.array<std::byte>(used_ + at, part.size()), part.data(), part.size());
    }
    used_ += (memory.size() + alignment - 1) / alignment * alignment;
    return copy;
}

}  // namespace octopair
