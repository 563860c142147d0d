#include "narrow_phase/convex/convex_pair.hpp"

#include <algorithm>
#include <utility>

#include "geometry/vector.hpp"
#include "narrow_phase/convex/local_convex.hpp"

namespace octopair {

bool convex_meet(const PosedConvex& a, const PosedConvex& b) { return convex_within(a, b, 0); }

bool convex_within(const PosedConvex& a, const PosedConvex& b, double margin) {
    const LocalConvexPair frame(a, b);
    const double enough = frame.radii() + margin;
    return core_gap(frame, enough).at_least <= enough;
}

ConvexGap convex_gap(const PosedConvex& a, const PosedConvex& b) {
    const LocalConvexPair frame(a, b);
    const CoreGap core = core_gap(frame);
    ConvexGap gap;
    gap.at_least = std::max(0.0, core.at_least - frame.radii());
    // Within the tolerance of touching they meet.
    if (gap.at_least > 0) gap.distance = std::max(gap.at_least, core.at_most - frame.radii());
    gap.on_a = core.on_a, gap.on_b = core.on_b;
    if (core.at_most > 0) {
        const Point3d normal = vector::times(vector::minus(core.on_b, core.on_a), 1 / core.at_most);
        gap.on_a = vector::plus(core.on_a, vector::times(normal, frame.a().radius()));
        gap.on_b = vector::minus(core.on_b, vector::times(normal, frame.b().radius()));
    }
    if (frame.swapped()) std::swap(gap.on_a, gap.on_b);
    gap.on_a = vector::plus(gap.on_a, frame.origin()), gap.on_b = vector::plus(gap.on_b, frame.origin());
    return gap;
}

}  // namespace octopair
