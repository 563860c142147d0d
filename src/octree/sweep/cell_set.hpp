// CellSet: entries of one octant, sorted for a sweep on cells.
//
// Layout
//   Entries are in buckets by their low cell on the first axis, in a bucket by their position in the list.
//   Planes have what a sweep reads of the entries: for each end on the two other axes, an array of its 8 most significant bits.
//   Behind the last entry are entries and bytes that a sweep may read. An entry behind the last one reaches the end of the octant, so its
//   window ends with the set.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/memory.hpp"
#include "octree/plan/octant_cells.hpp"

namespace octopair {

/// A plane of a CellSet: an end on the second or third axis of the sweep.
enum class CellPlane : std::uint8_t { low1, high1, low2, high2 };
inline constexpr std::size_t cell_planes = 4;

class CellSet {
public:
    /// Number of bytes of a plane, and number of entries, that may be read behind the last one.
    static constexpr std::size_t bytes_read_beyond = 64, entries_read_beyond = 16;

    using Runs = std::span<const std::span<const CellEntry>>;
    /// Sorts the entries of all runs. The set has no planes then.
    /// Requires: at most 2^16 entries (tuning().scan.max_swept_list), because a CellHit has 16 bits for a position.
    void assign(Runs runs);

    /// Sorts the entries along the next axis, which becomes the first. The set has no planes then.
    void turn();

    /// Makes the planes, unless the set has them. A sweep requires them.
    void make_planes();

    std::size_t size() const { return size_; }
    const CellEntry* entries() const { return entries_.data(); }
    const std::uint8_t* plane(CellPlane end) const { return planes_.data() + std::size_t(end) * stride_; }
    /// Returns the number of low bits of a cell by which the entries of a bucket may differ.
    unsigned bucket_shift() const { return bucket_shift_; }
    /// Returns the position of the first entry of each bucket, and behind them the number of entries.
    const std::uint32_t* bucket_begins() const { return bucket_begins_.data(); }

private:
    Buffer<CellEntry> entries_;
    std::vector<CellEntry> turned_;
    Buffer<std::uint8_t> planes_;
    std::vector<std::uint32_t> bucket_begins_;
    std::vector<std::uint16_t> buckets_;
    std::size_t size_ = 0;
    std::size_t stride_ = 0;  // from a plane to the next one
    unsigned bucket_shift_ = 0;
    bool has_planes_ = false;
};

/// Returns the bytes of an entry, by CellPlane. Specification of write_planes().
std::array<std::uint8_t, cell_planes> plane_bytes(const CellEntry& entry);

/// Writes the bytes of the entries to planes that begin `stride` bytes apart.
/// Requires: entries_read_beyond more entries can be read, and as many bytes more written to each plane.
void write_planes(std::span<const CellEntry> entries, std::uint8_t* planes, std::size_t stride);

}  // namespace octopair
