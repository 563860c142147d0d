#include "engine/pair_list.hpp"

#include <algorithm>

#include "base/tuning.hpp"

namespace octopair {

PairList::PairList() : storage_(std::make_unique<detail::PairStorage>()) {}
PairList::PairList(PairList&&) noexcept = default;
PairList& PairList::operator=(PairList&&) noexcept = default;
PairList::~PairList() = default;

detail::PairStorage& detail::storage_of(PairList& list) { return *list.storage_; }

std::uint64_t PairList::size() const { return storage_->size; }

std::span<const std::span<const Pair>> PairList::chunks() const { return storage_->chunks; }

std::vector<Pair> PairList::to_vector() const {
    std::vector<Pair> copy;
    copy.reserve(size());
    for (const auto chunk : chunks()) copy.insert(copy.end(), chunk.begin(), chunk.end());
    return copy;
}

void detail::PairStorage::reset() {
    chunks.clear();
    size = 0;
    taken_ = 0;
    kept_ = nullptr;
    free_ = {};
}

void detail::PairStorage::release() {
    reset();
    blocks_.clear();
}

std::span<Pair> detail::PairStorage::take_block(std::size_t pairs) {
    const std::size_t block_pairs = tuning().output.list_block;
    const std::lock_guard lock(mutex_);
    const auto free = blocks_.begin() + std::ptrdiff_t(taken_);
    auto found = std::find_if(free, blocks_.end(), [&](const auto& block) { return block.size() >= pairs; });
    if (found == blocks_.end()) {
        // Free large blocks that are too small now. Otherwise a reused list would accumulate blocks of every past size.
        const auto hoarded = [&](const auto& block) { return block.size() > block_pairs; };
        blocks_.erase(std::remove_if(free, blocks_.end(), hoarded), blocks_.end());
        const std::size_t fresh = std::max({pairs, block_pairs, room_ ? 0 : growth()});
        if (room_) room_(fresh * sizeof(Pair));
        if (watch_) watch_(fresh * sizeof(Pair));
        blocks_.emplace_back(fresh);
        found = blocks_.end() - 1;
    }
    std::swap(*found, blocks_[taken_]);
    return blocks_[taken_++].span();
}

std::uint64_t detail::PairStorage::held_bytes() const {
    std::uint64_t held = 0;
    for (const auto& block : blocks_) held += block.size() * sizeof(Pair);
    return held;
}

/// Returns a block size for a long list, in pairs: a quarter of the list, in whole huge pages. Returns 0 for a short list.
/// With blocks below the size of a huge page, first calls took up to 1.9 times as long as later calls.
std::size_t detail::PairStorage::growth() const {
    constexpr std::size_t huge_page = (std::size_t(2) << 20) / sizeof(Pair);
    constexpr std::size_t most = 16 * huge_page;
    return std::min(std::size_t(held_bytes()) / sizeof(Pair) / 4, most) / huge_page * huge_page;
}

std::span<const Pair> detail::PairStorage::copy(std::span<const Pair> pairs) {
    if (free_.size() < pairs.size()) free_ = take_block(pairs.size());
    std::copy(pairs.begin(), pairs.end(), free_.begin());
    const std::span<const Pair> copied = free_.first(pairs.size());
    free_ = free_.subspan(pairs.size());
    return copied;
}

void detail::PairStorage::append(std::span<const Pair> pairs) {
    if (pairs.empty()) return;
    size += pairs.size();
    if (!chunks.empty() && chunks.back().data() + chunks.back().size() == pairs.data()) {
        chunks.back() = {chunks.back().data(), chunks.back().size() + pairs.size()};
    } else {
        chunks.push_back(pairs);
    }
}

}  // namespace octopair
