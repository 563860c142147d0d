// KnownBoxes: the entry source of a rank that received entries. It knows the boxes of a few objects only.
//
// An object is numbered by its position among the objects of all ranks.
#pragma once

#include <array>
#include <cstdint>
#include <mutex>
#include <span>
#include <vector>

#include "boxes/box_source.hpp"
#include "engine/mpi/joint_call.hpp"
#include "engine/mpi/partition/object_arrays.hpp"

namespace octopair {

/// Exception for a step that needs the bounds of an entry whose box is not known.
struct MissingBounds {};

/// A pair in doubt, and the memory that it was in when the scan found it: mostly that of the list that it was written to.
struct PostponedPair {
    Pair pair;
    const Pair* place;
};

class KnownBoxes final : public ForwardingSource {
public:
    /// Borrows all arguments. `known`: the objects whose boxes are known, by set, with ascending positions. `most_postponed`: maximum
    /// number of pairs in doubt that are kept.
    KnownBoxes(const JointCall& call, const std::array<ObjectArrays, 2>& known, std::uint64_t most_postponed = 0);

    std::uint32_t second_begin() const override { return second_begin_; }
    bool has_all_bounds() const override { return false; }
    /// Throws: MissingBounds.
    bool is_pair(std::uint32_t a, std::uint32_t b) const override;
    /// Keeps the pairs in doubt (take_postponed()), and refuses none. Throws: MissingBounds if they are too many.
    std::size_t refused(const DoubtfulPairs& doubtful, std::uint32_t* out) const override;
    /// Throws: MissingBounds.
    void load_bounds(std::span<Entry> entries) const override;

    /// Returns the pairs in doubt, in no particular order, and forgets them.
    std::vector<PostponedPair> take_postponed() const;

private:
    /// Lookup table from ascending positions to their places. The positions from base + (i << shift) to base + ((i + 1) << shift) - 1 are at
    /// the places from starts[i] to starts[i + 1] - 1.
    struct PlaceTable {
        explicit PlaceTable(std::span<const std::uint32_t> all);
        /// Throws: MissingBounds.
        std::uint32_t place(std::uint32_t position) const;

        std::span<const std::uint32_t> positions;
        std::uint32_t base = 0;
        unsigned shift = 0;
        std::vector<std::uint32_t> starts;
    };
    std::uint32_t place(std::uint32_t object) const;

    const std::array<PlaceTable, 2> tables_;  // by set
    const std::uint32_t second_begin_;
    const std::uint64_t most_postponed_;
    const Objects first_, second_;
    const BoxSource boxes_;
    mutable std::mutex mutex_;
    mutable std::vector<PostponedPair> postponed_;
};

}  // namespace octopair
