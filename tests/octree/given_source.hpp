// GivenSource: entries that a test gives. Overlapping entries are pairs.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "boxes/entry_source.hpp"
#include "octree/sweep/entry_list.hpp"

namespace octopair::test {

/// Borrows the entries. Entry i has the object i. Entries of two sets are pairs only across the sets.
class GivenSource : public EntrySource {
public:
    GivenSource(std::span<const Entry> entries, std::uint32_t second_begin)
        : entries_(entries), second_begin_(second_begin) {}
    std::size_t size() const override { return entries_.size(); }
    bool load(std::size_t begin, std::span<Entry> out) const override {
        std::ranges::copy(entries_.subspan(begin, out.size()), out.begin());
        return true;
    }
    Float32Boxes float32_boxes(std::size_t, std::span<Box3f>) const override { return {}; }
    void pick(std::span<const std::size_t> positions, std::span<Entry> out) const override {
        for (std::size_t i = 0; i < out.size(); ++i) out[i] = entries_[positions[i]];
    }
    bool join() const override { return second_begin_ > 0; }
    std::uint32_t second_begin() const override { return second_begin_; }
    bool exact() const override { return true; }
    RoundingSlack slack() const override { return {}; }
    bool is_pair(std::uint32_t, std::uint32_t) const override { return true; }
    std::size_t refused(const DoubtfulPairs&, std::uint32_t*) const override { return 0; }
    void load_bounds(std::span<Entry> entries) const override {
        for (Entry& entry : entries) {
            const std::uint32_t mask = entry.mask;
            entry = entries_[entry.object];
            entry.mask = mask;
        }
    }

private:
    std::span<const Entry> entries_;
    std::uint32_t second_begin_;
};

inline std::vector<EntryId> ids_of(std::span<const Entry> entries) {
    std::vector<EntryId> ids;
    for (const Entry& entry : entries) ids.push_back({entry.object, entry.mask});
    return ids;
}

}  // namespace octopair::test
