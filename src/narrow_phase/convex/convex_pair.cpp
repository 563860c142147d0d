#include "narrow_phase/convex/convex_pair.hpp"

#include <algorithm>
#include <utility>

#include "geometry/vector.hpp"
#include "narrow_phase/convex/local_convex.hpp"

namespace octopair {

bool convex_meet(const PosedConvex& a, const PosedConvex& b) { return convex_within(a, b, 0); }

bool convex_within(const PosedConvex& a, const PosedConvex& b, double margin) {
    const LocalConvexPair pair(a, b);
    if (ScaledPair::is_needed(pair)) {
        const ScaledPair scaled(a, b, pair);
        return convex_within(scaled.a(), scaled.b(), scaled.to_units(margin));
    }
    const double enough = pair.radii() + margin;
    return gjk_distance(pair, enough).at_least <= enough;
}

ConvexGap convex_gap(const PosedConvex& a, const PosedConvex& b) {
    const LocalConvexPair pair(a, b);
    if (ScaledPair::is_needed(pair)) {
        const ScaledPair scaled(a, b, pair);
        const ConvexGap gap = convex_gap(scaled.a(), scaled.b());
        return {scaled.from_units(gap.distance), scaled.from_units(gap.at_least), scaled.from_units(gap.on_a),
                scaled.from_units(gap.on_b)};
    }
    const CoreGap core = gjk_distance(pair);
    ConvexGap gap;
    gap.at_least = std::max(0.0, core.at_least - pair.radii());
    // A pair within the tolerance counts as touching: its distance stays 0.
    if (gap.at_least > 0) gap.distance = std::max(gap.at_least, core.at_most - pair.radii());
    gap.on_a = core.on_a, gap.on_b = core.on_b;
    if (core.at_most > 0) {
        const Point3d normal = vector::times(vector::minus(core.on_b, core.on_a), 1 / core.at_most);
        gap.on_a = vector::plus(core.on_a, vector::times(normal, pair.a().radius()));
        gap.on_b = vector::minus(core.on_b, vector::times(normal, pair.b().radius()));
    }
    if (pair.swapped()) std::swap(gap.on_a, gap.on_b);
    gap.on_a = vector::plus(gap.on_a, pair.origin()), gap.on_b = vector::plus(gap.on_b, pair.origin());
    return gap;
}

}  // namespace octopair
