// The steps that build a linear octree, each over a block of objects or a range of octants.
//
//   encode   a block of objects -> the home octant of each object, its ghosts (further entries), and counts per octant
//   count    the counts of all blocks, for a range of octants -> the places of each block's entries (a prefix sum)
//   scatter  a block's entries -> their places. Counting and scattering are an MSD radix sort by octal code.
//
// Invariants
//   A step reads only what earlier steps wrote.
//   A step writes memory that no other block or range writes. So threads or processes can run the shares of a step
//   concurrently, and can run a share again.
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

/// Home of a box: the leaf that it begins in, or the number of octants if the box is too large for that leaf.
/// `crosses`: the box reaches into further octants.
class Home {
public:
    Home() = default;
    Home(OctantIndex octant, bool crosses) : packed_(octant << 1 | unsigned(crosses)) {}
    OctantIndex octant() const { return packed_ >> 1; }
    bool crosses() const { return (packed_ & 1) != 0; }

private:
    std::uint32_t packed_;
};

/// An entry of a box outside its home. The ghosts of a box are adjacent; boxes ascend.
class Ghost {
public:
    Ghost() = default;
    Ghost(OctantIndex octant, unsigned begins) : packed_(octant << 4 | begins) {}

    OctantIndex octant() const { return packed_ >> 4; }
    /// Returns the class bits.
    unsigned begins() const { return packed_ & begins_before; }
    /// True for the last ghost of a box.
    bool last() const { return (packed_ & last_bit) != 0; }
    void set_last() { packed_ |= last_bit; }

private:
    static constexpr std::uint32_t last_bit = 8;
    std::uint32_t packed_;
};
inline constexpr std::size_t max_ghosts = 8;  ///< maximum number of ghosts of a box

/// Objects [begin, end).
struct ObjectBlock {
    std::size_t begin = 0, end = 0;
};

/// Data that steps pass to later steps.
struct BuildMemory {
    /// `scratch`: pages for data that is not read after the scatter step.
    BuildMemory(PageSource& pages, PageSource& scratch)
        : homes(scratch),
          ghosts(scratch),
          ghost_counts(pages),
          counts(pages),
          places(pages),
          begins(pages),
          totals(pages),
          valid(pages) {}

    /// Makes room for the given numbers of objects, blocks, octants and ranges of octants.
    void resize(std::size_t objects, std::size_t blocks, std::size_t octants, std::size_t octant_ranges);

    Buffer<Home> homes;                  // by object
    Buffer<Ghost> ghosts;                // by block, from max_ghosts * its first object on; committed as needed
    Buffer<std::uint64_t> ghost_counts;  // by block
    Buffer<std::uint64_t> counts;        // by block: home entries of each octant, then ghosts of each octant
    Buffer<std::uint64_t> places;        // laid out as `counts`: place of the first entry, relative to the range
    Buffer<std::uint64_t> begins;        // by octant: place of its first entry, relative to the octant's range
    Buffer<std::uint64_t> totals;        // by range of octants: number of entries
    Buffer<std::uint8_t> valid;          // by block, after scatter: 1 if all its objects are valid boxes

    std::size_t octants = 0;
    /// Returns the part of `counts` or `places` for the home entries of block `b`; ghost_part() the part for its ghosts.
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

/// Destination of a block's entries.
struct ScatterTarget {
    std::span<Entry> entries;
    std::span<const std::uint64_t> range_begins;  ///< by range of octants: index of its first entry
    std::span<const NumberedOctants> ranges;
    std::size_t spare;  ///< index of an unused entry, where boxes too large for a leaf are written
};

/// The steps over some objects and octants. Borrows all members.
struct BuildSteps {
    const EntrySource& source;
    const Space& space;
    const Directory& directory;
    BuildMemory& memory;
    const std::stop_token& stop;

    /// Throws: Error{cancelled}.
    void encode(const NumberedBlock& block) const;
    /// `blocks`: numbers of the blocks whose entries go into one list, in order.
    void count(const NumberedOctants& octants, std::span<const std::size_t> blocks) const;
    /// Sets memory.valid, and stops at an object that is not a valid box.
    /// Throws: Error{cancelled}.
    void scatter(const NumberedBlock& block, const ScatterTarget& target) const;
};

}  // namespace octopair
