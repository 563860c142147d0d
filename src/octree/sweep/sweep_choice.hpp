// SweepChooser: chooses the axis of a sweep, and tells whether a sweep along it is cheap.
//
// Invariant
//   The choice is a function of the boxes alone, from samples at fixed positions. So the order of the pairs is the same for any
//   number of threads.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <stop_token>
#include <utility>
#include <vector>

#include "octree/sweep/box_sweep.hpp"
#include "octree/sweep/entry_list.hpp"

namespace octopair {

/// Input of a search for overlapping pairs: pairs within `rows` if `self` is true, otherwise pairs of a row and a column.
struct SweepInput {
    EntryList rows;
    EntryList columns;  ///< the list of rows if `self`
    bool self = false;
    Orientation orientation = {};

    std::size_t size() const { return rows.size() + (self ? 0 : columns.size()); }
};

/// The axis with the fewest tests. `good`: a sweep along this axis makes few tests in relation to the number of boxes or of pairs.
struct SweepChoice {
    unsigned axis = 0;
    bool good = false;
};

/// Estimates the cost of sweeps from samples. Keeps its memory between calls.
/// Thread safety: one thread at a time.
class SweepChooser {
public:
    explicit SweepChooser(std::stop_token stop) : stop_(std::move(stop)) {}

    /// Returns the one of `axes` with the fewest tests, and whether a sweep along it is cheap. Throws: Error{cancelled}.
    SweepChoice choose(const SweepInput& join, std::span<const unsigned> axes = all_axes);

    /// Returns the axes in ascending order of the number of tests that a sweep of rows over columns makes along the axis.
    /// Throws: Error{cancelled}.
    std::array<unsigned, 3> by_cost(const SweepInput& join);

private:
    static constexpr std::array<unsigned, 3> all_axes = {0, 1, 2};

    /// Sampled entries of a list. Each sampled entry represents `stride` entries.
    struct Measured {
        std::vector<Entry> entries;
        std::size_t stride = 1;

        void measure(const EntryList& list);
    };

    void measure(const SweepInput& join);
    std::uint64_t tests(const Measured& rows, const Measured& columns, unsigned axis);
    std::uint64_t hits(const EntryList& rows, const Measured& columns);

    std::stop_token stop_;
    Measured rows_, columns_;
    std::vector<Entry> tried_rows_;
    std::vector<float> lows_;
};

}  // namespace octopair
