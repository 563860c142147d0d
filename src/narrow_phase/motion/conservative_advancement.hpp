// How long two moving objects may go on without coming within reach of each other.
//
// Of two convex things that two planes part, the planes go with them: what counts is how fast these close. So things that
// pass each other go far in one step. Meshes are taken triangle by triangle; the least time of all is theirs.
#pragma once

#include <algorithm>

#include "geometry/vector.hpp"
#include "narrow_phase/object_pair.hpp"

namespace octopair {

struct Passing {
    Point3d way;     ///< of a, seen from b, in the whole time
    double turning;  ///< what turning adds to the speeds of points of both
    double reach;    ///< what does not count as apart
    double keep;     ///< what of the rest should be left
    double fastest() const { return vector::length(way) + turning; }

    /// Of a gap that closes so fast: most of it, and at least half of it.
    double time_for(double gap, double speed) const {
        const double left = gap - reach;
        return left > 0 ? std::max(left - keep, left / 2) * (1 - 1e-9) / speed : 0;
    }
    /// A gap between two planes across a direction of length 1, from a to b.
    double time_across(double gap, const Point3d& direction) const {
        return time_for(gap, (std::max(0.0, vector::dot(way, direction)) + turning) * (1 + 1e-9));
    }
};

/// Two objects, as they are now, and the gap between them; borrowed.
struct ObjectsApart {
    const PosedObject &a, &b;
    const ObjectGap& gap;
};

/// At most `most`. The gap must be more than the reach.
double safe_time(const ObjectsApart& pair, const Passing& passing, double most);

}  // namespace octopair
