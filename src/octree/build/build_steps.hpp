// The steps that build a linear octree, each over a block of objects or a range of octants.
//
//   encode   a batch of objects -> the octants of each object, and its entries
//   scatter  a batch's entries -> the lists of their octants, one list for each octant and block. Encode and scatter alternate,
//            batch by batch, in one pass over the objects. They are an MSD radix sort by octal code.
//   count    the lists of all blocks, for a range of octants -> the number of entries of each octant
//
// Invariants
//   A step reads only what earlier steps wrote.
//   A step writes memory that no other block or range writes. So threads or processes can run the shares of a step
//   concurrently, and can run a share again.
//
// Source: Lucchesi, Egbert, Harris 2014, sections 3.2 and 3.3.
#pragma once

#include <cstdint>
#include <stop_token>

#include "base/memory.hpp"
#include "base/private_export.hpp"
#include "boxes/box_source.hpp"
#include "octree/build/chunk_lists.hpp"
#include "octree/plan/directory.hpp"
#include "octree/plan/space.hpp"

namespace octopair {

inline constexpr std::size_t max_entries_per_object = 8;

/// Data that steps pass to later steps.
struct OCTOPAIR_PRIVATE_EXPORT BuildMemory {
    explicit BuildMemory(PageSource& pages)
        : lists(pages), begins(pages), totals(pages), valid(pages), seconds(pages) {}

    /// Makes room for the given numbers of objects, blocks, octants and ranges of octants.
    void resize(std::size_t objects, std::size_t blocks, std::size_t octants, std::size_t octant_ranges);

    /// Two lists for each octant: list i has the home entries of octant i, and list `octants` + i has its ghosts. A home entry is the
    /// entry in the leaf that the box begins in. All other entries are ghosts.
    ChunkLists lists;
    Buffer<std::uint64_t> begins;  // by octant: number of entries in earlier octants of the same range
    Buffer<std::uint64_t> totals;  // by range of octants: number of entries
    Buffer<std::uint8_t> valid;    // by block: 1 if all its objects are valid boxes
    /// Time of the steps in a sample of the batches.
    struct Seconds {
        double encode = 0, scatter = 0;
    };
    Buffer<Seconds> seconds;  // by block

    std::size_t octants = 0;
    std::size_t home_list(std::size_t octant) const { return octant; }
    std::size_t ghost_list(std::size_t octant) const { return octants + octant; }
};

struct NumberedBlock {
    std::size_t number;
    ObjectBlock objects;
};

struct NumberedOctants {
    std::size_t number;
    OctantIndex begin, end;
};

/// The steps over some objects and octants. Borrows all members.
struct OCTOPAIR_PRIVATE_EXPORT BuildSteps {
    const EntrySource& source;
    const Space& space;
    const Directory& directory;
    BuildMemory& memory;
    const std::stop_token& stop;

    /// Encodes and scatters a block. Sets memory.valid, and stops at an object that is not a valid box.
    /// Throws: Error{cancelled}.
    void encode_and_scatter(const NumberedBlock& block) const;
    void count(const NumberedOctants& octants) const;

private:
    template <typename Writer>
    void encode_and_scatter_with(const NumberedBlock& block) const;
};

}  // namespace octopair
