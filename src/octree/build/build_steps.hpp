// The steps that make a linear octree, each over a range of objects or of octants.
//
//   encode  a block of objects -> the home octant of each, its further entries (ghosts), and counts per octant
//   merge   the counts of all blocks, of a range of octants -> where each block's entries of these octants go
//   sort    a block's entries to their places: with the counts before it, an MSD radix sort by octal code
//
// A step reads what earlier steps wrote and writes memory that no other range writes, so that threads or processes can
// share the ranges out, and do one again.
//
// Source: Lucchesi, Egbert, Harris 2014, sections 3.2 and 3.3.
#pragma once

#include <cstdint>
#include <span>
#include <stop_token>
#include <vector>

#include "base/memory.hpp"
#include "boxes/box_source.hpp"
#include "octree/directory.hpp"
#include "octree/space.hpp"

namespace octopair {

/// The leaf that a box begins in, or none if it is too large for it, and whether it reaches into further ones.
class Home {
public:
    Home() = default;
    Home(OctantIndex octant, bool crosses) : packed_(octant << 1 | unsigned(crosses)) {}
    OctantIndex octant() const { return packed_ >> 1; }
    bool crosses() const { return (packed_ & 1) != 0; }

private:
    std::uint32_t packed_;
};

/// An entry of a box beyond the one in its home. Those of a box stand together, boxes ascending.
class Ghost {
public:
    Ghost() = default;
    Ghost(OctantIndex octant, unsigned begins) : packed_(octant << 4 | begins) {}

    OctantIndex octant() const { return packed_ >> 4; }
    /// The class bits.
    unsigned begins() const { return packed_ & begins_before; }
    /// Whether it is the last one of its box.
    bool last() const { return (packed_ & last_bit) != 0; }
    void set_last() { packed_ |= last_bit; }

private:
    static constexpr std::uint32_t last_bit = 8;
    std::uint32_t packed_;
};
inline constexpr std::size_t most_ghosts = 8;  // of a box

/// Objects [begin, end).
struct ObjectBlock {
    std::size_t begin = 0, end = 0;
};

/// What steps leave for each other.
struct BuildMemory {
    /// `scratch`: for what nobody reads after the sort.
    BuildMemory(PageSource& pages, PageSource& scratch)
        : homes(scratch),
          ghosts(scratch),
          ghost_counts(pages),
          counts(pages),
          places(pages),
          begins(pages),
          totals(pages),
          valid(pages) {}

    /// Room for these.
    void resize(std::size_t objects, std::size_t blocks, std::size_t octants, std::size_t octant_ranges);

    Buffer<Home> homes;                  // of each object
    Buffer<Ghost> ghosts;                // a block's from most_ghosts * begin on; committed as it grows
    Buffer<std::uint64_t> ghost_counts;  // of each block
    Buffer<std::uint64_t> counts;        // of each block: entries per octant that are home, then ghosts per octant
    Buffer<std::uint64_t> places;        // likewise: where the first goes, from the begin of the octant's range
    Buffer<std::uint64_t> begins;        // of each octant's entries, from the begin of its range
    Buffer<std::uint64_t> totals;        // of each range of octants: entries
    Buffer<std::uint8_t> valid;          // of each block, after sort: whether all of its objects are boxes

    std::size_t octants = 0;
    /// Of block `b`: what `counts` or `places` hold for homes, and for ghosts.
    std::span<std::uint64_t> home_part(Buffer<std::uint64_t>& of, std::size_t b) const {
        return of.span().subspan(2 * b * octants, octants);
    }
    std::span<std::uint64_t> ghost_part(Buffer<std::uint64_t>& of, std::size_t b) const {
        return of.span().subspan((2 * b + 1) * octants, octants);
    }
};

struct NumberedBlock {
    std::size_t number;
    ObjectBlock objects;
};

struct NumberedOctants {
    std::size_t number;
    OctantIndex begin, end;
};

/// Where a block's entries go.
struct ScatterTarget {
    std::span<Entry> entries;
    std::span<const std::uint64_t> range_begins;  ///< of the ranges of octants: what their places are counted from
    std::span<const NumberedOctants> ranges;
    std::size_t spare;  ///< the index of an entry that is free: boxes too large for a leaf are written there
};

/// The steps on some objects and octants. Borrows all.
struct BuildSteps {
    const EntrySource& source;
    const Space& space;
    const Directory& directory;
    BuildMemory& memory;
    const std::stop_token& stop;

    /// Throws Error{cancelled}, as sort() does.
    void encode(const NumberedBlock& block) const;
    /// `blocks`: those whose entries go to one list, first to last.
    void count(const NumberedOctants& octants, std::span<const std::size_t> blocks) const;
    /// Sets memory.valid; stops at an object that is not a box.
    void scatter(const NumberedBlock& block, const ScatterTarget& target) const;
};

}  // namespace octopair
