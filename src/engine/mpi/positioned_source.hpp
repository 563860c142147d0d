// PositionedSource: the objects that a rank received, as the entries of an octree. Objects have their positions as numbers, so
// that pairs need no renumbering.
//
// Invariants 1. The positions of the received objects ascend, set after set. So an object is found by binary search.
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

class PositionedSource final : public EntrySource, public PairRule {
public:
    /// Borrows both. `boxes`: the received objects, by their places.
    PositionedSource(const BoxSource& boxes, const ObjectPositions& positions);

    std::size_t size() const override { return boxes_.size(); }
    bool load(std::size_t begin, std::span<Entry> out) const override;
    PlainBoxes plain(std::size_t begin, std::size_t count) const override;
    void pick(std::span<const std::size_t> places, std::span<Entry> out) const override { boxes_.pick(places, out); }

    bool join() const override { return boxes_.join(); }
    std::uint32_t second_begin() const override { return positions_.second_begin; }
    bool exact() const override { return boxes_.exact(); }
    RoundingSlack slack() const override { return boxes_.slack(); }
    bool is_pair(std::uint32_t a, std::uint32_t b) const override { return boxes_.is_pair(place(a), place(b)); }
    std::size_t refused(const DoubtfulPairs& doubtful, std::uint32_t* out) const override {
        return refused_one_by_one(doubtful, out);
    }
    void load_bounds(std::span<Entry> entries) const override;

private:
    std::uint32_t place(std::uint32_t object) const;

    const BoxSource& boxes_;
    ObjectPositions positions_;
    std::array<std::vector<std::uint32_t>, 2> milestones_;  // by set: every 64th position, which stay in the cache
};

}  // namespace octopair
