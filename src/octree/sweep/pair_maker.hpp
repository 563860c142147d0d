// PairMaker: turns the hits of sweeps into pairs of the caller's objects, for one share of the work.
//
// A hit becomes a pair unless
//   the row and the column are not in the order that the search requires (Orientation, recursive_sweep.hpp), or
//   the boxes overlap so little that rounding could have caused the hit, and the caller's own numbers give no pair.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "base/tuning.hpp"
#include "octree/executor.hpp"
#include "octree/sweep/scan_context.hpp"
#include "octree/sweep/sweep.hpp"

namespace octopair {

/// By axis: +1 keeps hits whose row comes before the column (comes_before()), -1 keeps hits whose column comes first,
/// 0 keeps all hits.
using Orientation = std::array<std::int8_t, 3>;

inline Orientation reversed(Orientation orientation) {
    for (auto& sign : orientation) sign = std::int8_t(-sign);
    return orientation;
}

class PairMaker {
public:
    PairMaker(const ScanContext& context, ShareWriter& writer)
        : context_(context), slack_(context.source.slack()), writer_(writer) {}

    /// Runs a sweep to its end.
    /// Throws: Error{cancelled}.
    void sweep(const Sweep& sweep, const Orientation& orientation);
    /// Passes the pairs that are still held to the writer. Must be called once at the end.
    void flush();

private:
    void drop_turned(const Sweep& sweep, std::span<HitMask> hits, const Orientation& orientation);
    void drop_rounded(const Sweep& sweep, const Depths& depths, std::span<HitMask> hits);
    void check(const Sweep& sweep, std::span<const HitMask> hits) const;
    void drain(const Sweep& sweep, std::span<const HitMask> hits);

    const ScanContext& context_;
    RoundingSlack slack_;
    ShareWriter& writer_;
    std::array<HitMask, default_tuning.sweep.hits> hits_;
    std::array<HitMask, default_tuning.sweep.hits> certain_;
    std::array<Pair, default_tuning.sweep.pairs + max_hits> pairs_;
    std::size_t held_ = 0;
};

}  // namespace octopair
