#include "octree/sweep/entry_list.hpp"

#include "base/prefetch.hpp"

namespace octopair {

EntryList EntryList::at(std::span<const std::uint32_t> positions) const {
    EntryList list = *this;
    list.positions_ = positions;
    list.all_ = false;
    return list;
}

void EntryList::load(std::size_t begin, std::span<Entry> out) const {
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = without_bounds(position(begin + i));
    rule_->load_bounds(out);
}

void EntryList::load(const Sample& sample, std::vector<Entry>& out) const {
    out.resize(sample.size());
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = without_bounds(position(sample[i]));
    rule_->load_bounds(out);
}

void EntryList::load(std::span<const SortKey> keys, Buffer<Entry>& out) const {
    out.resize_discard(keys.size());
    constexpr std::size_t ahead = 32;
    for (std::size_t i = 0; i < keys.size(); ++i) {
        if (i + ahead < keys.size()) prefetch(&ids_[position_of(keys[i + ahead])]);
        out[i] = without_bounds(position_of(keys[i]));
    }
    rule_->load_bounds(out.span());
}

}  // namespace octopair
