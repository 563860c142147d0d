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

/// Returns the motion of b relative to a.
RelativeMotion reversed(const RelativeMotion& motion) {
    RelativeMotion other = motion;
    other.displacement = vector::times(motion.displacement, -1);
    return other;
}

/// Returns the safe time of two convex objects. `nearest` holds one point of each; the planes are perpendicular to the line
/// between these points.
double time_of_convex(const PosedConvex& a, const PosedConvex& b, const RelativeMotion& motion,
                      const std::array<Point3d, 2>& nearest) {
    const Point3d way = vector::minus(nearest[1], nearest[0]);
    const double length = vector::length(way);
    if (!(length > 0)) return 0;
    const Point3d direction = vector::times(way, 1 / length);
    const PosedPlane plane = {direction, nearest[0]};
    return motion.time_across(span_across(plane, b).low - span_across(plane, a).high, direction);
}

/// The smallest safe time over many pairs of convex objects, at most `most`.
class LeastTime {
public:
    LeastTime(const RelativeMotion& motion, double most) : motion_(motion), least_(most) {}

    /// Returns the distance beyond which a pair cannot reduce the smallest time.
    float reach() const {
        return reach_above(motion_.reach + motion_.remaining_gap + least_ * motion_.max_speed() * 2);
    }
    double least() const { return least_; }

    void add(const PosedConvex& a, const PosedConvex& b, double gap, const std::array<Point3d, 2>& nearest) {
        const double time_by_speed = motion_.time_for(gap, motion_.max_speed());
        if (time_by_speed < least_)
            least_ = std::min(least_, std::max(time_by_speed, time_of_convex(a, b, motion_, nearest)));
    }

private:
    const RelativeMotion& motion_;
    double least_;
};

double time_of_meshes(const PosedMesh& a, const PosedMesh& b, const RelativeMotion& motion, double most) {
    LeastTime time(motion, most);
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

double time_of_mesh_and_solid(const PosedMesh& mesh, const BoxedSolid& solid, const RelativeMotion& motion,
                              double most) {
    LeastTime time(motion, most);
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

/// Returns the safe time of an object a, with the given span, and the plane b. The plane itself separates the two.
double time_to_plane(const PlaneSpan& span, const PosedPlane& plane, const RelativeMotion& motion) {
    const Point3d down = vector::times(plane.normal, -1);
    return std::max(motion.time_across(span.low, down), motion.time_across(-span.high, plane.normal));
}

/// Requires: the kind of a is not after the kind of b.
double time_in_order(const ObjectsApart& pair, const RelativeMotion& motion, double most) {
    const auto& [a, b, gap] = pair;
    const Kind kind_a = kind_of(a), kind_b = kind_of(b);
    if (kind_b == Kind::plane) {
        const PosedPlane plane = plane_of(b);
        const auto span = kind_a == Kind::mesh ? span_across(plane, mesh_of(a)) : span_across(plane, solid_of(a));
        return time_to_plane(*span, plane, motion);
    }
    if (kind_a == Kind::solid) return time_of_convex(solid_of(a), solid_of(b), motion, gap.nearest);
    return kind_b == Kind::mesh ? time_of_meshes(mesh_of(a), mesh_of(b), motion, most)
                                : time_of_mesh_and_solid(mesh_of(a), boxed_solid_of(b), motion, most);
}

}  // namespace

double safe_time(const ObjectsApart& pair, const RelativeMotion& motion, double most) {
    const auto& [a, b, gap] = pair;
    const double time_by_speed = motion.time_for(gap.at_least, motion.max_speed());
    if (!(time_by_speed < most)) return most;
    const bool in_order = kind_of(a) <= kind_of(b);
    const ObjectGap other = {gap.at_least, {gap.nearest[1], gap.nearest[0]}};
    const double time =
        in_order ? time_in_order(pair, motion, most) : time_in_order({b, a, other}, reversed(motion), most);
    return std::min(std::max(time_by_speed, time), most);
}

}  // namespace octopair
