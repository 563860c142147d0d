#include "octree/sweep/entry_list.hpp"

#include "base/memory.hpp"

namespace octopair {

EntryList EntryList::at(std::span<const std::uint32_t> positions) const {
    EntryList list = *this;
    list.positions_ = positions;
    list.all_ = false;
    return list;
}

template <typename PositionAt>
void EntryList::load_at(const PositionAt& position_at, std::span<Entry> out) const {
    constexpr std::size_t ahead = 32;
    if (source_ == nullptr) {
        for (std::size_t i = 0; i < out.size(); ++i) {
            if (i + ahead < out.size()) prefetch(&whole_[position_at(i + ahead)]);
            out[i] = whole_[position_at(i)];
        }
        return;
    }
    for (std::size_t i = 0; i < out.size(); ++i) {
        if (i + ahead < out.size()) prefetch(&ids_[position_at(i + ahead)]);
        const EntryId& id = ids_[position_at(i)];
        out[i].object = id.object;
        out[i].mask = id.mask;
    }
    source_->load_bounds(out);
}

void EntryList::load(std::size_t begin, std::span<Entry> out) const {
    load_at([&](std::size_t i) { return position(begin + i); }, out);
}

void EntryList::load(const Sample& sample, std::vector<Entry>& out) const {
    out.resize(sample.size());
    load_at([&](std::size_t i) { return position(sample[i]); }, out);
}

void EntryList::load(std::span<const SortKey> keys, Buffer<Entry>& out) const {
    out.resize_discard(keys.size());
    load_at([&](std::size_t i) { return position_of(keys[i]); }, out.span());
}

}  // namespace octopair
