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

#include "octree/sweep/entry_list.hpp"
#include "octree/sweep/pair_maker.hpp"

namespace octopair {

/// A search for the overlapping pairs within a set (`self`), or between rows and columns.
struct SweepInput {
    EntryList rows;
    EntryList columns;  ///< the list of rows if `self`
    bool self = false;
    Orientation orientation = {};

    std::size_t size() const { return rows.size() + (self ? 0 : columns.size()); }
};

/// The cheapest axis. `good`: a sweep along this axis has few tests for each box, or few for each pair.
struct SweepChoice {
    unsigned axis = 0;
    bool good = false;
};

/// Keeps its memory between calls.
/// Thread safety: one thread at a time.
class SweepChooser {
public:
    explicit SweepChooser(std::stop_token stop) : stop_(std::move(stop)) {}

    /// Throws: Error{cancelled}.
    SweepChoice choose(const SweepInput& join, std::span<const unsigned> axes = all_axes);

    /// Returns the axes, those first along which a sweep of each row over the columns has the fewest tests.
    /// Throws: Error{cancelled}.
    std::array<unsigned, 3> by_cost(const SweepInput& join);

private:
    static constexpr std::array<unsigned, 3> all_axes = {0, 1, 2};

    /// Some entries of a list. Each stands for `stride` entries.
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
