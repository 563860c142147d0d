// PositionedSource: presents the objects that a rank received as entries of an octree. An entry's object number is the position of the
// object among the objects of all ranks. So pairs that a scan finds need no renumbering.
//
// Invariants 1. The positions of the received objects ascend, set after set.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "boxes/box_source.hpp"

namespace octopair {

/// Positions of the objects of a rank, by set.
struct ObjectPositions {
    std::array<std::span<const std::uint32_t>, 2> of_set = {};
    std::uint32_t second_begin = 0;  ///< number of objects of the first set, on all ranks; 0 unless the call is a join
};

class PositionedSource final : public ForwardingSource {
public:
    /// Borrows both arguments. `boxes`: the received objects. The place of an object is its number in `boxes`.
    PositionedSource(const BoxSource& boxes, const ObjectPositions& positions);

    bool load(std::size_t begin, std::span<Entry> out) const override;
    Float32Boxes float32_boxes(std::size_t begin, std::span<Box3f> room) const override;
    std::uint32_t second_begin() const override { return positions_.second_begin; }
    bool is_pair(std::uint32_t a, std::uint32_t b) const override { return source().is_pair(place(a), place(b)); }
    std::size_t refused(const DoubtfulPairs& doubtful, std::uint32_t* out) const override;
    void load_bounds(std::span<Entry> entries) const override;

private:
    /// Lookup table from positions to places. Positions [base + (i << shift), base + ((i + 1) << shift)) are at the places
    /// [starts[i], starts[i + 1]). These are few places, so a look-up reads two or three cache lines.
    struct PlaceTable {
        std::uint32_t base = 0;
        unsigned shift = 0;
        std::vector<std::uint32_t> starts;

        void fill(std::span<const std::uint32_t> positions);
        /// Returns the address of starts[i] for the i whose range contains `position`. starts[i + 1] follows it in memory.
        const std::uint32_t* start(std::uint32_t position) const { return &starts[(position - base) >> shift]; }
    };
    struct Named {
        unsigned set;
        std::uint32_t position;
    };
    Named named(std::uint32_t object) const;
    std::uint32_t place(std::uint32_t object) const;
    void find_places(std::span<std::uint32_t> objects) const;

    ObjectPositions positions_;
    std::array<PlaceTable, 2> tables_;  // by set
};

}  // namespace octopair
