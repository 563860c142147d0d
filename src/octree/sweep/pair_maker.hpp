// PairMaker: turns the hits of sweeps into pairs of the caller's objects, for one share of the work.
//
// A hit becomes a pair unless the orientation that its search asks for fails (recursive_sweep.hpp), or its boxes
// overlap so barely that rounding could have made it and the caller's own numbers say no.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <stop_token>

#include "base/tuning.hpp"
#include "boxes/pair_rule.hpp"
#include "octree/directory.hpp"
#include "octree/executor.hpp"
#include "octree/sweep/sweep.hpp"

namespace octopair {

/// Per axis: +1 keeps hits whose row comes before its column in (min, object), -1 those whose column does, 0 all.
using Orientation = std::array<std::int8_t, 3>;

inline Orientation reversed(Orientation orientation) {
    for (auto& sign : orientation) sign = std::int8_t(-sign);
    return orientation;
}

/// An octant of the outermost octree. Tests check that the pairs reported within it have the low corners of their
/// intersections in it.
struct OutermostOctant {
    Space space;
    Octant octant;

    /// Throws Error{engine_failed} if another octant is to report this pair.
    void check(const Entry& a, const Entry& b) const;
};

/// What every share of a scan needs to know.
struct ScanContext {
    const PairRule& rule;
    std::stop_token stop;
    unsigned nesting = 0;  ///< octrees that hold the octant which the scanned octree is made of
    double growth = 1;     ///< product of entries / objects of the octrees around, up to the outermost
    std::optional<OutermostOctant> outermost = {};  ///< with test hooks
};

class PairMaker {
public:
    PairMaker(const ScanContext& context, ShareWriter& writer)
        : context_(context), slack_(context.rule.slack()), writer_(writer) {}

    /// Runs a sweep to its end. Throws Error{cancelled}.
    void sweep(const Sweep& sweep, const Orientation& orientation);
    /// Hands what it still holds to the writer; to be called once at the end.
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
    std::array<Pair, default_tuning.sweep.pairs + most_hits> pairs_;
    std::size_t held_ = 0;
};

}  // namespace octopair
