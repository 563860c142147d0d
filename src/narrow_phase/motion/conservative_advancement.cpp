#include "narrow_phase/motion/conservative_advancement.hpp"

#include <array>
#include <cmath>
#include <limits>

#include "narrow_phase/convex/convex_plane.hpp"
#include "narrow_phase/exact/triangle_gap.hpp"
#include "narrow_phase/mesh/mesh_leaves.hpp"
#include "narrow_phase/mesh/mesh_plane.hpp"
#include "narrow_phase/object_kind.hpp"

namespace octopair {

namespace {

/// The same pair with its objects in the other order.
Passing turned_round(const Passing& passing) {
    Passing other = passing;
    other.way = vector::times(passing.way, -1);
    return other;
}

/// Of two convex things, `nearest` being a place of each.
double time_of_convex(const PosedConvex& a, const PosedConvex& b, const Passing& passing,
                      const std::array<Point3d, 2>& nearest) {
    const Point3d way = vector::minus(nearest[1], nearest[0]);
    const double length = vector::length(way);
    if (!(length > 0)) return 0;
    const Point3d direction = vector::times(way, 1 / length);
    const PosedPlane plane = {direction, nearest[0]};
    return passing.time_across(span_across(plane, b).low - span_across(plane, a).high, direction);
}

/// The least of the times of many pairs, none of which needs more than `most`.
class LeastTime {
public:
    LeastTime(const Passing& passing, double most) : passing_(passing), least_(most) {}

    /// Pairs that are further apart than this do not matter any more.
    float reach() const { return reach_above(passing_.reach + passing_.keep + least_ * passing_.fastest() * 2); }
    double least() const { return least_; }

    void add(const PosedConvex& a, const PosedConvex& b, double gap, const std::array<Point3d, 2>& nearest) {
        const double anyhow = passing_.time_for(gap, passing_.fastest());
        if (anyhow < least_) least_ = std::min(least_, std::max(anyhow, time_of_convex(a, b, passing_, nearest)));
    }

private:
    const Passing& passing_;
    double least_;
};

double time_of_meshes(const PosedMesh& a, const PosedMesh& b, const Passing& passing, double most) {
    LeastTime time(passing, most);
    MeshWalk walk(a, b, time.reach());
    std::array<NodePair, 1> at;
    while (next_leaves(walk, at) > 0) {
        const WorldLeaf leaf_a(a, a.tree.nodes[at[0].a]), leaf_b(b, b.tree.nodes[at[0].b]);
        for (std::uint32_t i = 0; i < leaf_a.count(); ++i) {
            for (std::uint32_t j = 0; j < leaf_b.count(); ++j) {
                const Triangle3d &p = leaf_a.triangle(i), &q = leaf_b.triangle(j);
                const TriangleGap gap = triangle_gap(p, q);
                time.add(PosedConvex(p), PosedConvex(q), gap.distance, gap.nearest);
            }
        }
        walk.reach = time.reach();
    }
    return time.least();
}

double time_of_mesh_and_solid(const PosedMesh& mesh, const BoxedSolid& solid, const Passing& passing, double most) {
    LeastTime time(passing, most);
    const PosedConvex posed(solid.solid, solid.box.pose);
    MeshWalk walk(mesh, solid.box, time.reach());
    std::array<NodePair, 1> at;
    while (next_leaves(walk, at) > 0) {
        const MeshNode& leaf = mesh.tree.nodes[at[0].a];
        for (std::uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i) {
            const Triangle3d triangle = mesh.tree.world_triangle(mesh.pose, i);
            const ConvexGap gap = convex_gap(PosedConvex(triangle), posed);
            time.add(PosedConvex(triangle), posed, gap.at_least, {gap.on_a, gap.on_b});
        }
        walk.reach = time.reach();
    }
    return time.least();
}

/// The plane is b. What is on one side of it is parted from it as a whole.
double time_beside_plane(const PlaneSpan& span, const PosedPlane& plane, const Passing& passing) {
    const Point3d down = vector::times(plane.normal, -1);
    return std::max(passing.time_across(span.low, down), passing.time_across(-span.high, plane.normal));
}

/// The kinds of both ascending.
double time_in_order(const ObjectsApart& pair, const Passing& passing, double most) {
    const auto& [a, b, gap] = pair;
    const Kind kind_a = kind_of(a), kind_b = kind_of(b);
    if (kind_b == Kind::plane) {
        const PosedPlane plane = plane_of(b);
        const auto span = kind_a == Kind::mesh ? span_across(plane, mesh_of(a)) : span_across(plane, solid_of(a));
        return time_beside_plane(*span, plane, passing);
    }
    if (kind_a == Kind::solid) return time_of_convex(solid_of(a), solid_of(b), passing, gap.nearest);
    return kind_b == Kind::mesh ? time_of_meshes(mesh_of(a), mesh_of(b), passing, most)
                                : time_of_mesh_and_solid(mesh_of(a), boxed_solid_of(b), passing, most);
}

}  // namespace

double safe_time(const ObjectsApart& pair, const Passing& passing, double most) {
    const auto& [a, b, gap] = pair;
    const double anyhow = passing.time_for(gap.at_least, passing.fastest());
    if (!(anyhow < most)) return most;
    const bool in_order = kind_of(a) <= kind_of(b);
    const ObjectGap other = {gap.at_least, {gap.nearest[1], gap.nearest[0]}};
    const double time =
        in_order ? time_in_order(pair, passing, most) : time_in_order({b, a, other}, turned_round(passing), most);
    return std::min(std::max(anyhow, time), most);
}

}  // namespace octopair
