// Whether one convex thing lies in another, below its surface.
//
// Outer     what is within a radius of few points, a box, a cylinder, a cone, an ellipsoid: each says how far a point is
//           above its surface, by a function that is convex. The inner one's highest point is climbed to from many sides:
//           to its farthest point in the direction that the surface has there, as long as that is higher. From points and
//           flat sides this ends at the highest; between two curved surfaces, at one from which no way leads higher.
// Hulls     hold a ball if its centre is deeper in them than its radius, an ellipsoid if that is so where this is a ball,
//           others if they hold a polyhedron around them, of 64 sides where they are round.
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
    double above;  ///< the surface, as a length near it; below 0 inside
    Point3d uphill;
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

/// What is within the radius of a segment; of a point, if the two ends are one.
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

/// The faces, edges and corners of a cube around the origin.
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

/// The solid is the frame's `outer`.
bool stays_below(const ConvexSolid& solid, const LocalConvex& outer, const LocalConvex& inner, double slack) {
    // A pose that turns things by no more than rounding off a turn is undone by its transpose.
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

/// How much a pose is off a turn, where it must be one.
double off_turn(const Pose& pose) {
    double most = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j <= i; ++j) {
            const double product = vector::dot(vector::column(pose, i), vector::column(pose, j));
            most = std::max(most, std::fabs(product - (i == j ? 1 : 0)));
        }
    }
    return most;
}

/// Corners of a polyhedron around a cylinder or a cone.
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

/// Whether a point of the hull is deeper in it than this.
bool is_deep(const PosedConvex& hull, const Point3d& point, double depth) {
    const PosedConvex inner(point);
    if (!convex_meet(hull, inner)) return false;
    const LocalConvexPair frame(hull, inner);
    return convex_contact(hull, inner).depth > depth + 4 * frame.slack();
}

/// A pose times the scaling of its shape by these, undone: where the ellipsoid is the unit ball at the origin.
Pose seen_from_ball(const Pose& hull, const Pose& ellipsoid, const Point3d& radii) {
    Pose seen;
    const Point3d place = vector::minus(vector::place(hull), vector::place(ellipsoid));
    for (std::size_t k = 0; k < 4; ++k) {
        const Point3d turned = vector::turned_back(ellipsoid, k < 3 ? vector::column(hull, k) : place);
        for (std::size_t i = 0; i < 3; ++i) seen.rows[i][k] = turned[i] / radii[i];
    }
    return seen;
}

bool hull_holds(const PosedConvex& hull, const PosedConvex& inner) {
    if (inner.point()) return is_deep(hull, *inner.point(), 0);
    const auto holds_all = [&](const auto& points, double radius) {
        return std::all_of(points.begin(), points.end(), [&](const Point3d& at) { return is_deep(hull, at, radius); });
    };
    if (inner.triangle()) return holds_all(*inner.triangle(), 0);
    const ConvexSolid& solid = *inner.solid();
    if (solid.core == Core::ellipsoid) {
        const Pose seen = seen_from_ball(*hull.pose(), *inner.pose(), solid.extents);
        return is_deep(PosedConvex(*hull.solid(), seen), {0, 0, 0}, 1 + 4 * off_turn(*inner.pose()));
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
    return holds_all(points, solid.radius);
}

}  // namespace

bool convex_contains(const PosedConvex& outer, const PosedConvex& inner) {
    if (!outer.solid()) return false;
    const ConvexSolid& solid = *outer.solid();
    if (solid.core == Core::points && solid.radius == 0) return hull_holds(outer, inner);
    const LocalConvexPair frame(outer, inner);
    const LocalConvex& framed_outer = frame.swapped() ? frame.b() : frame.a();
    const LocalConvex& framed_inner = frame.swapped() ? frame.a() : frame.b();
    const double slack = 4 * frame.slack() + off_turn(*outer.pose()) * framed_outer.magnitude();
    return stays_below(solid, framed_outer, framed_inner, slack);
}

}  // namespace octopair
