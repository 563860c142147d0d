// EntryList: the entries of an octant that is too crowded for a single sweep.
//
// A list has one of two forms. A list of EntryId has 8 bytes for each entry, because it may have all objects of the scene; load() reads the
// bounds from the caller's boxes. A list of Entry, for fewer entries, has their bounds, so it reads less scattered memory.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/memory.hpp"
#include "boxes/entry_source.hpp"
#include "octree/plan/sample.hpp"
#include "octree/sweep/start_order.hpp"

namespace octopair {

/// An entry without bounds. An EntrySource loads the bounds of `object` when a step needs them.
struct EntryId {
    std::uint32_t object;
    std::uint32_t mask;
};

/// A list of entries: all elements of a span, or the elements at some positions of the span. Borrows the spans and the source.
class EntryList {
public:
    EntryList() = default;
    explicit EntryList(std::span<const Entry> whole) : whole_(whole) {}
    EntryList(const EntrySource& source, std::span<const EntryId> ids) : source_(&source), ids_(ids) {}

    /// Returns the list of the entries at these positions of the span.
    EntryList at(std::span<const std::uint32_t> positions) const;

    std::size_t size() const { return all_ ? whole_.size() + ids_.size() : positions_.size(); }
    /// Returns the position in the span of entry `i`.
    std::uint32_t position(std::size_t i) const { return all_ ? std::uint32_t(i) : positions_[i]; }

    /// Loads the entries from `begin` on.
    void load(std::size_t begin, std::span<Entry> out) const;
    /// Loads the entries whose positions in this list are in the sample.
    void load(const Sample& sample, std::vector<Entry>& out) const;
    /// Loads the entries at the keys' positions in the span, in the order of the keys.
    void load(std::span<const SortKey> keys, Buffer<Entry>& out) const;

    /// Calls body(position in the span, entry) for each entry, in order.
    template <typename Body>
    void for_each(Body&& body) const {
        if (source_ == nullptr) {
            for (std::size_t i = 0; i < size(); ++i) body(position(i), whole_[position(i)]);
            return;
        }
        std::array<Entry, 128> some;
        for (std::size_t begin = 0; begin < size(); begin += some.size()) {
            const std::size_t count = std::min(some.size(), size() - begin);
            load(begin, std::span(some).first(count));
            for (std::size_t i = 0; i < count; ++i) body(position(begin + i), some[i]);
        }
    }

private:
    /// Loads the entries at the positions position_at(0), position_at(1), and so on.
    template <typename PositionAt>
    void load_at(const PositionAt& position_at, std::span<Entry> out) const;

    std::span<const Entry> whole_;
    const EntrySource* source_ = nullptr;  // loads the bounds of ids_; null if whole_ has the entries
    std::span<const EntryId> ids_;
    std::span<const std::uint32_t> positions_ = {};
    bool all_ = true;
};

}  // namespace octopair
