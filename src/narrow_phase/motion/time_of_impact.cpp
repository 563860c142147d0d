#include "narrow_phase/motion/time_of_impact.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "geometry/vector.hpp"
#include "narrow_phase/exact/triangle_pair.hpp"
#include "narrow_phase/mesh/mesh_leaves.hpp"
#include "narrow_phase/pair_kinds.hpp"
#include "narrow_phase/plane_pair.hpp"

namespace octopair {

namespace {

/// Motion of object a relative to object b. Times are fractions of the whole motion, 0 to 1.
struct RelativeMotion {
    Point3d displacement;  ///< displacement of a relative to b during the whole motion
    double turning_speed;  ///< sum of the speeds that rotation adds to points of a and of b
    double reach;          ///< distance at which the objects count as meeting
    double remaining_gap;  ///< gap beyond `reach` that should remain after a step
    /// Upper bound on the relative speed of two points.
    double max_speed() const { return vector::length(displacement) + turning_speed; }

    /// Returns the longer of two times: until `gap - reach`, which shrinks at `speed`, becomes `remaining_gap`, and until it becomes
    /// half of itself. Returns 0 if the gap is at most `reach`.
    double time_for(double gap, double speed) const {
        const double left = gap - reach;
        return left > 0 ? std::max(left - remaining_gap, left / 2) * (1 - 1e-9) / speed : 0;
    }
    /// Returns time_for() the gap between two planes that separate the objects. The planes are perpendicular to `direction`, which
    /// has length 1 and points from a to b.
    double time_across(double gap, const Point3d& direction) const {
        return time_for(gap, (std::max(0.0, vector::dot(displacement, direction)) + turning_speed) * (1 + 1e-9));
    }
};

/// Two objects at the current time and the gap between them. Borrowed.
struct ObjectsApart {
    const PosedObject &a, &b;
    const ObjectGap& gap;
};

/// Returns the motion of b relative to a.
RelativeMotion reversed(const RelativeMotion& motion) {
    RelativeMotion other = motion;
    other.displacement = vector::times(motion.displacement, -1);
    return other;
}

/// Returns the time in which two separating planes cannot meet (safe_time()). `nearest`: a point of each object; the planes are
/// perpendicular to the line between these points.
double time_of_convex(const PosedConvex& a, const PosedConvex& b, const RelativeMotion& motion,
                      const std::array<Point3d, 2>& nearest) {
    const Point3d way = vector::minus(nearest[1], nearest[0]);
    const double length = vector::length(way);
    if (!(length > 0)) return 0;
    const Point3d direction = vector::times(way, 1 / length);
    const PosedPlane plane = {direction, nearest[0]};
    return motion.time_across(span_across(plane, b).low - span_across(plane, a).high, direction);
}

/// The smallest safe time (safe_time()) over many pairs of convex objects, at most `most`.
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

/// Returns the safe time (safe_time()) of an object a, which covers `span`, and the plane b. The plane itself is the separating plane.
double time_to_plane(const PlaneSpan& span, const PosedPlane& plane, const RelativeMotion& motion) {
    const Point3d down = vector::times(plane.normal, -1);
    return std::max(motion.time_across(span.low, down), motion.time_across(-span.high, plane.normal));
}

/// Returns safe_time() of a pair. Requires: the kind of a is not after the kind of b (pair_kinds.hpp).
double time_in_order(const ObjectsApart& pair, const RelativeMotion& motion, double most) {
    const auto& [a, b, gap] = pair;
    const ObjectKind kind_a = kind_of(a), kind_b = kind_of(b);
    if (kind_b == ObjectKind::plane) {
        const PosedPlane plane = plane_of(b);
        const auto span = kind_a == ObjectKind::mesh ? span_across(plane, mesh_of(a)) : span_across(plane, solid_of(a));
        return time_to_plane(*span, plane, motion);
    }
    if (kind_a == ObjectKind::solid) return time_of_convex(solid_of(a), solid_of(b), motion, gap.nearest);
    return kind_b == ObjectKind::mesh ? time_of_meshes(mesh_of(a), mesh_of(b), motion, most)
                                      : time_of_mesh_and_solid(mesh_of(a), boxed_solid_of(b), motion, most);
}

/// Returns a time, at most `most`, during which the objects cannot come within `motion.reach`: the step of conservative advancement.
/// Requires: the gap is larger than the reach.
///
/// Convex    Two parallel planes separate two convex objects and move with them. The speed at which the planes approach bounds the time.
///           So objects that pass each other take long steps.
/// Planes    The plane itself is the separating plane.
/// Meshes    The result is the smallest time over all pairs of triangles, or of a triangle and a solid.
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

Point3d way_of(const Motion& motion) { return vector::minus(vector::place(motion.at(1)), vector::place(motion.at(0))); }

/// Returns the speed that rotation adds to the object's points. Planes do not rotate (shapes.hpp).
double speed_of_turning(const MovingObject& object) {
    const ShapeBounds& bounds = object.geometry.bounds;
    if (!bounds.bounded) return 0;
    return object.motion.speed(vector::length(bounds.centre) + bounds.radius) - object.motion.speed(0);
}

double tolerance_of(const MovingObject& a, const MovingObject& b) {
    const auto size = [](const MovingObject& object) {
        return object.geometry.bounds.bounded ? object.geometry.bounds.radius : std::numeric_limits<double>::infinity();
    };
    const auto farthest = [](const MovingObject& object) {
        return std::max(vector::length(vector::place(object.motion.at(0))),
                        vector::length(vector::place(object.motion.at(1))));
    };
    // Far from the origin, float64 limits the accuracy of places.
    return std::max(1e-6 * std::min(size(a), size(b)), 1e-14 * std::max(farthest(a), farthest(b)));
}

}  // namespace

std::optional<double> first_time_within(const MovingObject& a, const MovingObject& b, double reach,
                                        const std::stop_token& stop) {
    constexpr unsigned steps_per_tolerance = 1 << 14;
    RelativeMotion motion{vector::minus(way_of(a.motion), way_of(b.motion)), speed_of_turning(a) + speed_of_turning(b),
                          reach, 0};
    double tolerance = tolerance_of(a, b), time = 0;
    for (unsigned step = 1; !stop.stop_requested(); ++step) {
        const Pose pose_a = a.motion.at(time), pose_b = b.motion.at(time);
        const PosedObject at_a = {a.geometry, pose_a}, at_b = {b.geometry, pose_b};
        const std::optional<ObjectGap> gap = object_gap(at_a, at_b);
        if (!gap) return std::nullopt;
        // At time 0 the exact test decides, without tolerance.
        if (gap->at_least - reach <= (time == 0 ? 0 : tolerance)) return time;
        motion.remaining_gap = tolerance / 2;
        const double left_time = 1 - time, go_on = safe_time({at_a, at_b, *gap}, motion, left_time);
        if (go_on >= left_time) return std::nullopt;
        time += go_on;
        if (step % steps_per_tolerance == 0) tolerance *= 4;
    }
    return std::nullopt;
}

}  // namespace octopair
