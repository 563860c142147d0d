// convex_contains(): whether one convex object lies inside another, below its surface.
//
// Height    A sphere, capsule, box, cylinder, cone and ellipsoid each have a convex function: the height of a point above
//           their surface, below 0 inside.
// Search    Hill climbing from many directions finds the highest point of the inner object: the next point is the farthest
//           in the direction of the height's gradient. The search ends when the height no longer increases.
// Result    The maximum is global for points and flat sides. Between two curved surfaces it is a local maximum.
// Hulls     A hull contains a ball if the ball's centre is deeper than its radius. It contains an ellipsoid if this holds in
//           coordinates where the ellipsoid is a ball. It contains another solid if it contains all corners of a polyhedron
//           around that solid, with 64 sides where the solid is round.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "geometry/vector.hpp"
#include "narrow_phase/convex/local_convex.hpp"

namespace octopair {
namespace {

using Core = ConvexSolid::Core;

struct Height {
    double above;    ///< height above the surface, about a length near it; below 0 inside
    Point3d uphill;  ///< direction of the gradient, of any length
};

Height above_rim(double across, double along_axis, const Point3d& at) {
    const double distance = std::hypot(at[0], at[1]);
    if (distance == 0) return {0, {across, 0, along_axis}};
    return {across * distance, {across * at[0] / distance, across * at[1] / distance, along_axis}};
}

Height higher(const Height& a, const Height& b) { return a.above >= b.above ? a : b; }

Height above_box(const Point3d& extents, const Point3d& at) {
    Height height = {-std::numeric_limits<double>::infinity(), {}};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        Height side = {std::fabs(at[axis]) - extents[axis], {}};
        side.uphill[axis] = std::copysign(1, at[axis]);
        height = higher(height, side);
    }
    return height;
}

Height above_cylinder(const Point3d& extents, const Point3d& at) {
    Height wall = above_rim(1, 0, at);
    wall.above -= extents[0];
    return higher(wall, {std::fabs(at[2]) - extents[2], {0, 0, std::copysign(1, at[2])}});
}

Height above_cone(const Point3d& extents, const Point3d& at) {
    const double slant = std::hypot(extents[0], 2 * extents[2]);
    const double across = 2 * extents[2] / slant, along = extents[0] / slant;
    Height wall = above_rim(across, along, at);
    wall.above += along * (at[2] - extents[2]);
    return higher(wall, {-extents[2] - at[2], {0, 0, -1}});
}

Height above_ellipsoid(const Point3d& radii, const Point3d& at) {
    const Point3d scaled = {at[0] / radii[0], at[1] / radii[1], at[2] / radii[2]};
    const double least = std::min({radii[0], radii[1], radii[2]});
    return {(vector::length(scaled) - 1) * least, {scaled[0] / radii[0], scaled[1] / radii[1], scaled[2] / radii[2]}};
}

/// Height above a capsule, or above a sphere, whose two end points are equal.
Height above_capsule(const ConvexSolid& solid, const Point3d& at) {
    const Point3d from = solid.points.front(), way = vector::minus(solid.points.back(), from);
    const double squared = vector::dot(way, way);
    const double part = squared > 0 ? vector::dot(vector::minus(at, from), way) / squared : 0;
    const Point3d foot = vector::plus(from, vector::times(way, std::clamp(part, 0.0, 1.0)));
    const Point3d uphill = vector::minus(at, foot);
    return {vector::length(uphill) - solid.radius, uphill};
}

Height above(const ConvexSolid& solid, const Point3d& at) {
    switch (solid.core) {
        case Core::points:
            return above_capsule(solid, at);
        case Core::box:
            return above_box(solid.extents, at);
        case Core::cylinder:
            return above_cylinder(solid.extents, at);
        case Core::cone:
            return above_cone(solid.extents, at);
        case Core::ellipsoid:
            break;
    }
    return above_ellipsoid(solid.extents, at);
}

/// Returns the 26 directions from the centre of a cube to its faces, edges and corners.
std::vector<Point3d> all_sides() {
    std::vector<Point3d> sides;
    for (const double x : {-1.0, 0.0, 1.0}) {
        for (const double y : {-1.0, 0.0, 1.0}) {
            for (const double z : {-1.0, 0.0, 1.0}) {
                if (x != 0 || y != 0 || z != 0) sides.push_back({x, y, z});
            }
        }
    }
    return sides;
}

Point3d farthest(const LocalConvex& convex, const Point3d& direction) {
    const double length = vector::length(direction);
    const Point3d core = convex.support(direction);
    return length > 0 ? vector::plus(core, vector::times(direction, convex.radius() / length)) : core;
}

/// Returns true if all points of `inner` are more than `slack` below the surface of `outer`. `solid` is the solid of `outer`.
bool stays_below(const ConvexSolid& solid, const LocalConvex& outer, const LocalConvex& inner, double slack) {
    // The pose is a rotation up to rounding, so its transpose is its inverse.
    const Pose& pose = outer.pose();
    const auto height_at = [&](const Point3d& point) {
        return above(solid, vector::turned_back(pose, vector::minus(point, vector::place(pose))));
    };
    const auto stays = [&](Point3d direction) {
        double highest = -std::numeric_limits<double>::infinity();
        for (int step = 0; step < 64; ++step) {
            const Height height = height_at(farthest(inner, direction));
            if (height.above >= -slack) return false;
            if (!(height.above > highest)) return true;
            highest = height.above;
            direction = vector::turned(pose, height.uphill);
        }
        return true;
    };
    const std::vector<Point3d> points = inner.all_points();
    for (const Point3d& point : points) {
        if (height_at(point).above >= -slack) return false;
    }
    if (!points.empty() && inner.radius() == 0) return true;
    for (const Point3d& side : all_sides()) {
        if (!stays(vector::turned(pose, side)) || !stays(vector::turned(inner.pose(), side))) return false;
    }
    return stays(vector::minus(inner.middle(), vector::place(pose)));
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

/// Returns the corners of a polyhedron that contains a cylinder or a cone.
std::vector<Point3d> corners_around(const ConvexSolid& solid) {
    constexpr int sides = 64;
    const double radius = solid.extents[0] / std::cos(std::numbers::pi / sides) * (1 + 1e-12);
    const double half = solid.extents[2];
    std::vector<Point3d> corners;
    for (int i = 0; i < sides; ++i) {
        const double angle = 2 * std::numbers::pi * i / sides;
        const double x = radius * std::cos(angle), y = radius * std::sin(angle);
        corners.push_back({x, y, -half});
        if (solid.core == Core::cylinder) corners.push_back({x, y, half});
    }
    if (solid.core == Core::cone) corners.push_back({0, 0, half});
    return corners;
}

/// Returns true if `point` lies in the hull and is deeper than `depth`.
bool is_deep(const PosedConvex& hull, const Point3d& point, double depth) {
    const PosedConvex inner(point);
    if (!convex_meet(hull, inner)) return false;
    const LocalConvexPair pair(hull, inner);
    return convex_contact(hull, inner).depth > depth + 4 * pair.slack();
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

bool hull_contains(const PosedConvex& hull, const PosedConvex& inner) {
    if (inner.point()) return is_deep(hull, *inner.point(), 0);
    const auto contains_all = [&](const auto& points, double radius) {
        return std::all_of(points.begin(), points.end(), [&](const Point3d& at) { return is_deep(hull, at, radius); });
    };
    if (inner.triangle()) return contains_all(*inner.triangle(), 0);
    const ConvexSolid& solid = *inner.solid();
    if (solid.core == Core::ellipsoid) {
        const Pose relative = pose_relative_to_ball(*hull.pose(), *inner.pose(), solid.extents);
        return is_deep(PosedConvex(*hull.solid(), relative), {0, 0, 0}, 1 + 4 * rotation_error(*inner.pose()));
    }
    std::vector<Point3d> points = solid.points;
    if (solid.core == Core::box) {
        for (Point3d corner : all_sides()) {
            if (corner[0] == 0 || corner[1] == 0 || corner[2] == 0) continue;
            for (std::size_t axis = 0; axis < 3; ++axis) corner[axis] *= solid.extents[axis];
            points.push_back(corner);
        }
    }
    if (solid.core == Core::cylinder || solid.core == Core::cone) points = corners_around(solid);
    for (Point3d& point : points) point = vector::posed(*inner.pose(), point);
    return contains_all(points, solid.radius);
}

}  // namespace

bool convex_contains(const PosedConvex& outer, const PosedConvex& inner) {
    if (!outer.solid()) return false;
    const ConvexSolid& solid = *outer.solid();
    if (solid.core == Core::points && solid.radius == 0) return hull_contains(outer, inner);
    const LocalConvexPair pair(outer, inner);
    const LocalConvex& local_outer = pair.swapped() ? pair.b() : pair.a();
    const LocalConvex& local_inner = pair.swapped() ? pair.a() : pair.b();
    const double slack = 4 * pair.slack() + rotation_error(*outer.pose()) * local_outer.magnitude();
    return stays_below(solid, local_outer, local_inner, slack);
}

}  // namespace octopair
