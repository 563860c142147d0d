// Filters "bounding spheres" and "oriented boxes": remove pairs whose bounding volumes are apart, before the exact stages.
//
// Invariants
//   A gap counts only if it is greater than the bound on its rounding error.
//   A plane has no bounding volume: it is tested itself. A mesh without triangles is apart from everything.
//   Moving objects are tested by their spheres in both filters. Their centres deviate from straight lines by at most
//   Motion::sagitta, so the minimum distance is that of two points on straight lines, minus this deviation.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/floating_point_scope.hpp"
#include "narrow_phase/motion/motion.hpp"
#include "narrow_phase/plane_pair.hpp"
#include "narrow_phase/prepared.hpp"
#include "octopair/error.hpp"
#include "octopair/filters.hpp"
#include "pipeline/per_object.hpp"

namespace octopair {
namespace {

constexpr double rounding = std::numeric_limits<double>::epsilon();

/// Returns an upper bound on the factor by which a pose stretches lengths: the square root of the largest row sum of (transpose * pose).
double stretch_of(const Pose& pose) {
    double most = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        double sum = 0;
        for (std::size_t k = 0; k < 3; ++k)
            sum += std::fabs(vector::dot(vector::column(pose, i), vector::column(pose, k)));
        most = std::max(most, sum);
    }
    return std::sqrt(most) * (1 + 4 * rounding);
}

struct Ball {
    Point3d centre;
    double radius;
    double slack;  ///< bound on the rounding error of centre and radius
};

Ball ball_of(const detail::PreparedShape& shape, const Pose& pose) {
    const ShapeBounds& bounds = shape.bounds;
    const double stretch = std::max(stretch_of(pose), shape.convex.radius > 0 ? 1.0 : 0.0);
    Ball ball = {vector::posed(pose, bounds.centre), stretch * bounds.radius, 0};
    ball.slack = 32 * rounding *
                 (stretch * (vector::length(bounds.centre) + bounds.radius) + vector::length(vector::place(pose)));
    return ball;
}

/// Returns vectors from the centre of a posed bounding box to the centres of three of its faces.
std::array<Point3d, 3> half_edges(const detail::PreparedShape& shape, const Pose& pose) {
    const Box3d& box = shape.bounds.box;
    // A pose may deviate from a rotation by 1e-6, and so shrink the box. But poses do not scale the radius of a solid.
    constexpr double max_rotation_error = 4e-6;
    std::array<Point3d, 3> edges;
    for (std::size_t k = 0; k < 3; ++k) {
        const double half =
            (box.max[k] / 2 - box.min[k] / 2) * (1 + 4 * rounding) + max_rotation_error * shape.convex.radius;
        edges[k] = vector::times(vector::column(pose, k), half);
    }
    return edges;
}

double reach_along(const std::array<Point3d, 3>& edges, const Point3d& unit) {
    return std::fabs(vector::dot(edges[0], unit)) + std::fabs(vector::dot(edges[1], unit)) +
           std::fabs(vector::dot(edges[2], unit));
}

/// The two objects of a pair.
struct ShapePair {
    const detail::PreparedShape &a, &b;
    const Pose &pose_a, &pose_b;
    const Pose *end_a, *end_b;  ///< null: the object does not move
    double reach;               ///< margin plus both paddings
};

const shape::Plane* plane_of(const detail::PreparedShape& shape) { return std::get_if<shape::Plane>(&shape.shape); }

/// Returns whether the distance of a plane from a solid is greater than `reach`. `thick`: how far the solid extends from the ball's centre
/// along the plane's normal.
bool plane_apart(const PosedPlane& plane, const Ball& ball, double thick, double reach) {
    const double height = vector::dot(vector::minus(ball.centre, plane.point), plane.normal);
    const double slack = 2 * ball.slack + 32 * rounding * (vector::length(plane.point) + std::fabs(height));
    return std::fabs(height) - thick - slack > reach;
}

bool balls_apart(const Ball& a, const Ball& b, double reach) {
    const double distance = vector::length(vector::minus(a.centre, b.centre));
    return distance - (a.radius + b.radius) - (a.slack + b.slack) > reach;
}

/// Returns the motion between two poses. `end` is null for an object that does not move.
std::optional<Motion> motion_of(const Pose& begin, const Pose* end) {
    return end ? Motion::between(begin, *end) : Motion::between(begin, begin);
}

bool moving_balls_apart(const ShapePair& pair) {
    const auto move_a = motion_of(pair.pose_a, pair.end_a), move_b = motion_of(pair.pose_b, pair.end_b);
    if (!move_a || !move_b) return false;
    const Ball a = ball_of(pair.a, move_a->at(0)), b = ball_of(pair.b, move_b->at(0));
    const Ball last_a = ball_of(pair.a, move_a->at(1)), last_b = ball_of(pair.b, move_b->at(1));
    const double aside = move_a->sagitta(vector::length(pair.a.bounds.centre), 1) +
                         move_b->sagitta(vector::length(pair.b.bounds.centre), 1);
    const Point3d from = vector::minus(b.centre, a.centre);
    const Point3d way = vector::minus(vector::minus(last_b.centre, last_a.centre), from);
    const double squared = vector::dot(way, way);
    const double part = squared > 0 ? std::clamp(-vector::dot(from, way) / squared, 0.0, 1.0) : 0;
    const double nearest = vector::length(vector::plus(from, vector::times(way, part)));
    const double radii = std::max(a.radius, last_a.radius) + std::max(b.radius, last_b.radius);
    const double slack = 4 * (a.slack + b.slack + last_a.slack + last_b.slack) + 32 * rounding * std::sqrt(squared);
    return nearest - radii - aside - slack > pair.reach;
}

bool boxes_apart(const ShapePair& pair) {
    const Ball ball_a = ball_of(pair.a, pair.pose_a), ball_b = ball_of(pair.b, pair.pose_b);
    const auto a = half_edges(pair.a, pair.pose_a), b = half_edges(pair.b, pair.pose_b);
    const Point3d between = vector::minus(ball_b.centre, ball_a.centre);
    const double slack = 4 * (ball_a.slack + ball_b.slack);
    const auto separates = [&](const Point3d& axis) {
        const double length = vector::length(axis);
        if (!(length > 0)) return false;
        const Point3d unit = vector::times(axis, 1 / length);
        return std::fabs(vector::dot(between, unit)) - reach_along(a, unit) - reach_along(b, unit) - slack > pair.reach;
    };
    for (const auto* edges : {&a, &b}) {
        for (std::size_t k = 0; k < 3; ++k) {
            if (separates(vector::cross((*edges)[k], (*edges)[(k + 1) % 3]))) return true;
        }
    }
    for (const Point3d& edge_a : a) {
        for (const Point3d& edge_b : b) {
            if (separates(vector::cross(edge_a, edge_b))) return true;
        }
    }
    return false;
}

enum class Hull : std::uint8_t { ball, box };

bool with_plane_apart(const ShapePair& pair, Hull hull) {
    const bool first = plane_of(pair.a) != nullptr;
    const detail::PreparedShape& other = first ? pair.b : pair.a;
    const Pose& pose = first ? pair.pose_b : pair.pose_a;
    const PosedPlane plane = posed_plane(*plane_of(first ? pair.a : pair.b), first ? pair.pose_a : pair.pose_b);
    const Ball ball = ball_of(other, pose);
    const double thick = hull == Hull::ball ? ball.radius : reach_along(half_edges(other, pose), plane.normal);
    return plane_apart(plane, ball, thick, pair.reach);
}

bool are_apart(const ShapePair& pair, Hull hull) {
    const bool plane_a = plane_of(pair.a) != nullptr, plane_b = plane_of(pair.b) != nullptr;
    if ((!plane_a && !pair.a.bounds.bounded) || (!plane_b && !pair.b.bounds.bounded)) return true;
    if (plane_a && plane_b) return false;
    if (plane_a || plane_b) return !pair.end_a && !pair.end_b && with_plane_apart(pair, hull);
    if (pair.end_a || pair.end_b) return moving_balls_apart(pair);
    if (hull == Hull::box) return boxes_apart(pair);
    return balls_apart(ball_of(pair.a, pair.pose_a), ball_of(pair.b, pair.pose_b), pair.reach);
}

class BoundingFilter final : public Filter {
public:
    BoundingFilter(Hull hull, const ShapedObjects& first, const ShapedObjects& second, double margin)
        : hull_(hull), first_(first), second_(second), margin_(margin) {
        check(first_);
        in_second_set([this] { check(second_); });
        if (!(margin >= 0) || !std::isfinite(margin)) {
            throw Error(ErrorCode::bad_input, "the margin is not finite, or below 0");
        }
    }

    std::string_view name() const override { return hull_ == Hull::ball ? "bounding spheres" : "oriented boxes"; }

    void apply(Batch& batch) const override {
        batch.keep_if([&](std::size_t i) { return !are_apart(shape_pair(batch.pairs()[i]), hull_); });
    }

private:
    static const detail::PreparedShape& shape_of(const ShapedObjects& objects, std::uint32_t i) {
        return detail::prepared(objects.geometries[objects.geometry[i]]);
    }
    static const Pose* end_of(const ShapedObjects& objects, std::uint32_t i) {
        return objects.end_poses.empty() ? nullptr : &objects.end_poses[i];
    }
    static double padding_of(const ShapedObjects& objects, std::uint32_t i) {
        return objects.padding.empty() ? 0 : objects.padding[i];
    }
    ShapePair shape_pair(const Pair& pair) const {
        return {shape_of(first_, pair.a),
                shape_of(second_, pair.b),
                first_.poses[pair.a],
                second_.poses[pair.b],
                end_of(first_, pair.a),
                end_of(second_, pair.b),
                margin_ + (padding_of(first_, pair.a) + padding_of(second_, pair.b))};
    }

    Hull hull_;
    ShapedObjects first_, second_;
    double margin_;
};

}  // namespace

std::unique_ptr<Filter> make_sphere_filter(const ShapedObjects& first, double margin, const ShapedObjects* second) {
    const FloatingPointScope scope;
    return std::make_unique<BoundingFilter>(Hull::ball, first, second ? *second : first, margin);
}

std::unique_ptr<Filter> make_oriented_box_filter(const ShapedObjects& first, double margin,
                                                 const ShapedObjects* second) {
    const FloatingPointScope scope;
    return std::make_unique<BoundingFilter>(Hull::box, first, second ? *second : first, margin);
}

}  // namespace octopair
