// CellSet: entries of one octant, sorted for a sweep on cells.
//
// Layout
//   Entries are in buckets by their low cell on the first axis, in a bucket by their position in the list.
//   A column has what the sweep reads of an entry: 16 bits for each end on the first axis, 8 bits for each end on the two others.
//   The cells of high ends are stored as their complements. So one saturated subtraction compares both ends at once.
//   Behind the last entry are columns that hit nothing.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/memory.hpp"
#include "octree/cell_sweep/cell_entry.hpp"

namespace octopair {

class CellSet {
public:
    static constexpr std::size_t padding = 96;  ///< number of columns that may be read behind the end

    using Runs = std::span<const std::span<const CellEntry>>;
    /// Sorts the entries of all runs. Prefetches the runs `next` while it reads.
    /// Requires: at most 2^16 entries (tuning().scan.max_swept_list), because a CellHit has 16 bits for a position.
    void assign(Runs runs, Runs next = {});

    /// Sorts the entries along the next axis, which becomes the first.
    void turn();

    std::size_t size() const { return size_; }
    const CellEntry* entries() const { return entries_.data(); }
    /// Returns the ends on the first axis: the low cell, and above it the complement of the high cell.
    const std::uint32_t* first_axis() const { return first_axis_.data(); }
    /// Returns the ends on the two other axes, in bytes: low, complement of high, low, complement of high.
    const std::uint32_t* other_axes() const { return other_axes_.data(); }
    /// Returns the number of low bits of a cell by which the entries of a bucket may differ.
    unsigned bucket_shift() const { return bucket_shift_; }
    /// Returns the position behind the last entry of the bucket that holds `cell`.
    std::uint32_t bucket_end(std::uint32_t cell) const { return bucket_ends_[cell >> bucket_shift_]; }

private:
    Buffer<CellEntry> entries_;
    std::vector<CellEntry> turned_;
    Buffer<std::uint32_t> first_axis_, other_axes_;
    std::vector<std::uint32_t> bucket_ends_;
    std::vector<std::uint16_t> buckets_;
    std::size_t size_ = 0;
    unsigned bucket_shift_ = 0;
};

/// A column of a CellSet.
struct CellColumn {
    std::uint32_t first_axis, other_axes;
};
/// Specification of place_entries().
CellColumn column_of(const CellEntry& entry);

/// Destination of entries: position next[buckets[i]] of three arrays for entry i.
struct EntryPlaces {
    const std::uint16_t* buckets;
    std::uint32_t* next;
    CellEntry* entries;
    std::uint32_t *first_axis, *other_axes;
};
/// Copies each entry and its column to its place, and increases the position of its bucket, in the order of the entries.
void place_entries(std::span<const CellEntry> entries, const EntryPlaces& places);

}  // namespace octopair
