// convex_contains(): whether one convex object lies inside another, below its surface.
//
// Parts     The inner object is the convex hull of points, of balls, and of ellipsoids, which may be flat: the ends of a cylinder are
//           disks. A convex object contains all if it contains each part (below_surface.hpp).
// Hulls     A hull contains a ball if the ball's centre is deeper than its radius. It contains an ellipsoid if this holds in
//           coordinates where the ellipsoid is a ball. It contains a disk if it contains a polygon around the disk, which gets more
//           corners where they are not inside. Without a proof after many corners, the disk counts as not contained.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "geometry/vector.hpp"
#include "narrow_phase/convex/below_surface.hpp"
#include "narrow_phase/convex/local_convex.hpp"

namespace octopair {
namespace {

using Core = ConvexSolid::Core;

/// The parts of which an object is the convex hull: balls (points have radius 0), and ellipsoids, flat or solid.
struct Parts {
    std::vector<Point3d> centres;
    double radius = 0;
    std::vector<Ellipsoid> ellipsoids;
};

Eigen::Vector3d from(const Point3d& point) { return {point[0], point[1], point[2]}; }
Point3d from(const Eigen::Vector3d& vector) { return {vector[0], vector[1], vector[2]}; }

Eigen::Matrix3d turn_of(const Pose& pose) {
    Eigen::Matrix3d linear;
    for (int axis = 0; axis < 3; ++axis) linear.col(axis) = from(vector::column(pose, std::size_t(axis)));
    return linear;
}

/// Returns the corners of a box around the origin.
std::vector<Point3d> corners_of_box(const Point3d& extents) {
    std::vector<Point3d> corners;
    for (const double x : {-1.0, 1.0}) {
        for (const double y : {-1.0, 1.0}) {
            for (const double z : {-1.0, 1.0}) corners.push_back({x * extents[0], y * extents[1], z * extents[2]});
        }
    }
    return corners;
}

/// Returns the parts of a solid that is not made of points, in its own coordinates.
Parts parts_of(const ConvexSolid& solid) {
    const Point3d& extents = solid.extents;
    const auto disk_at = [&](double z) {
        return Ellipsoid{{0, 0, z}, Eigen::Vector3d(extents[0], extents[1], 0).asDiagonal()};
    };
    switch (solid.core) {
        case Core::box:
            return {corners_of_box(extents), 0, {}};
        case Core::cylinder:
            return {{}, 0, {disk_at(-extents[2]), disk_at(extents[2])}};
        case Core::cone:
            return {{{0, 0, extents[2]}}, 0, {disk_at(-extents[2])}};
        case Core::points:
        case Core::ellipsoid:
            break;
    }
    return {{}, 0, {{{0, 0, 0}, from(extents).asDiagonal()}}};
}

/// Returns the parts of an object in the local coordinates of a pair.
Parts parts_of(const PosedConvex& convex, const LocalConvex& local) {
    if (!convex.solid() || convex.solid()->core == Core::points) return {local.all_points(), local.radius(), {}};
    Parts parts = parts_of(*convex.solid());
    const Eigen::Matrix3d turn = turn_of(local.pose());
    for (Point3d& centre : parts.centres) centre = vector::posed(local.pose(), centre);
    for (Ellipsoid& one : parts.ellipsoids)
        one = {turn * one.centre + from(vector::place(local.pose())), turn * one.map};
    return parts;
}

/// Returns true if all parts are more than `slack` below the surface of a solid that is not a hull.
bool are_below(const ConvexSolid& solid, const Pose& pose, const Parts& parts, double slack) {
    // The pose is a rotation up to rounding, so its transpose serves as its inverse.
    const Eigen::Matrix3d turn_back = turn_of(pose).transpose();
    const auto in_solid = [&](const Ellipsoid& one) {
        return Ellipsoid{turn_back * (one.centre - from(vector::place(pose))), turn_back * one.map};
    };
    const auto ball_is_below = [&](const Point3d& centre) {
        const Ellipsoid ball = in_solid({from(centre), parts.radius * Eigen::Matrix3d::Identity()});
        if (solid.core == Core::ellipsoid && parts.radius > 0) return is_below(solid, ball, slack);
        return height_above(solid, from(ball.centre)) + parts.radius < -slack;
    };
    return std::all_of(parts.centres.begin(), parts.centres.end(), ball_is_below) &&
           std::all_of(parts.ellipsoids.begin(), parts.ellipsoids.end(),
                       [&](const Ellipsoid& one) { return is_below(solid, in_solid(one), slack); });
}

/// Returns the largest deviation of the pose's linear part from a rotation.
double rotation_error(const Pose& pose) {
    double most = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j <= i; ++j) {
            const double product = vector::dot(vector::column(pose, i), vector::column(pose, j));
            most = std::max(most, std::fabs(product - (i == j ? 1 : 0)));
        }
    }
    return most;
}

/// Returns true if `point` is proven to be deeper in the hull than `depth`.
bool is_deep(const PosedConvex& hull, const Point3d& point, double depth) {
    const PosedConvex inner(point);
    if (!convex_meet(hull, inner)) return false;
    const LocalConvexPair pair(hull, inner);
    return convex_depth_at_least(hull, inner) > depth + 4 * pair.slack();
}

/// Returns the hull's pose in the coordinates in which the ellipsoid is the unit ball at the origin.
Pose pose_relative_to_ball(const Pose& hull, const Pose& ellipsoid, const Point3d& radii) {
    Pose relative;
    const Point3d place = vector::minus(vector::place(hull), vector::place(ellipsoid));
    for (std::size_t k = 0; k < 4; ++k) {
        const Point3d turned = vector::turned_back(ellipsoid, k < 3 ? vector::column(hull, k) : place);
        for (std::size_t i = 0; i < 3; ++i) relative.rows[i][k] = turned[i] / radii[i];
    }
    return relative;
}

bool hull_contains_disk(const PosedConvex& hull, const Ellipsoid& disk) {
    constexpr int first_arcs = 8, most_corners = 4096;
    const auto at = [&](double angle, double distance) {
        return from(
            Eigen::Vector3d(disk.centre + disk.map * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0) * distance));
    };
    // An arc of a circle lies in the triangle of its two ends and the corner where the tangents at the ends meet.
    struct Arc {
        double middle, half;
    };
    std::vector<Arc> arcs;
    arcs.reserve(first_arcs);
    for (int i = 0; i < first_arcs; ++i) {
        arcs.push_back({2 * std::numbers::pi * i / first_arcs, std::numbers::pi / first_arcs});
    }
    for (int corners = 0; !arcs.empty(); ++corners) {
        const auto [middle, half] = arcs.back();
        if (corners == most_corners || !is_deep(hull, at(middle, 1), 0)) return false;
        arcs.pop_back();
        if (is_deep(hull, at(middle, (1 + 1e-12) / std::cos(half)), 0)) continue;
        arcs.push_back({middle - half / 2, half / 2});
        arcs.push_back({middle + half / 2, half / 2});
    }
    return true;
}

bool hull_contains(const PosedConvex& hull, const PosedConvex& inner, const LocalConvex& local_inner) {
    const Parts parts = parts_of(inner, local_inner);
    const auto contains_ball = [&](const Point3d& centre) { return is_deep(hull, centre, parts.radius); };
    if (!std::all_of(parts.centres.begin(), parts.centres.end(), contains_ball)) return false;
    if (inner.solid() && inner.solid()->core == Core::ellipsoid) {
        const Pose relative = pose_relative_to_ball(*hull.pose(), local_inner.pose(), inner.solid()->extents);
        return is_deep(PosedConvex(*hull.solid(), relative), {0, 0, 0}, 1 + 4 * rotation_error(local_inner.pose()));
    }
    return std::all_of(parts.ellipsoids.begin(), parts.ellipsoids.end(),
                       [&](const Ellipsoid& disk) { return hull_contains_disk(hull, disk); });
}

}  // namespace

bool convex_contains(const PosedConvex& outer, const PosedConvex& inner) {
    if (!outer.solid()) return false;
    const ConvexSolid& solid = *outer.solid();
    const LocalConvexPair pair(outer, inner);
    if (ScaledPair::is_needed(pair)) {
        const ScaledPair scaled(outer, inner, pair);
        return convex_contains(scaled.a(), scaled.b());
    }
    const LocalConvex& local_outer = pair.swapped() ? pair.b() : pair.a();
    const LocalConvex& local_inner = pair.swapped() ? pair.a() : pair.b();
    if (solid.core == Core::points && solid.radius == 0) {
        return hull_contains(PosedConvex(solid, local_outer.pose()), inner, local_inner);
    }
    const double slack = 4 * pair.slack() + rotation_error(*outer.pose()) * local_outer.magnitude();
    return are_below(solid, local_outer.pose(), parts_of(inner, local_inner), slack);
}

}  // namespace octopair
