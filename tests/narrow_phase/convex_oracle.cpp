#include "narrow_phase/convex_oracle.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace octopair::test {
namespace {

using vector::cross;
using vector::dot;
using vector::length;
using vector::minus;
using vector::plus;
using vector::times;

Point3d on_segment(const Point3d& from, const Point3d& to, const Point3d& at) {
    const Point3d way = minus(to, from);
    const double squared = dot(way, way);
    if (squared == 0) return from;
    return plus(from, times(way, std::clamp(dot(minus(at, from), way) / squared, 0.0, 1.0)));
}

double apart(const Point3d& a, const Point3d& b) { return length(minus(a, b)); }

Point3d nearer(const Point3d& to, const Point3d& a, const Point3d& b) { return apart(a, to) <= apart(b, to) ? a : b; }

Point3d on_triangle(const Point3d& a, const Point3d& b, const Point3d& c, const Point3d& at) {
    const Point3d edge = nearer(at, nearer(at, on_segment(a, b, at), on_segment(b, c, at)), on_segment(c, a, at));
    const Point3d normal = cross(minus(b, a), minus(c, a));
    if (length(normal) == 0) return edge;
    const Point3d foot = minus(at, times(normal, dot(minus(at, a), normal) / dot(normal, normal)));
    const bool inside = dot(cross(minus(b, a), minus(foot, a)), normal) >= 0 &&
                        dot(cross(minus(c, b), minus(foot, b)), normal) >= 0 &&
                        dot(cross(minus(a, c), minus(foot, c)), normal) >= 0;
    return inside ? nearer(at, foot, edge) : edge;
}

bool in_tetrahedron(const std::array<Point3d, 4>& corners, const Point3d& at) {
    for (std::size_t i = 0; i < 4; ++i) {
        const Point3d &a = corners[(i + 1) % 4], &b = corners[(i + 2) % 4], &c = corners[(i + 3) % 4];
        const Point3d normal = cross(minus(b, a), minus(c, a));
        const double own = dot(minus(corners[i], a), normal);
        if (own == 0 || own * dot(minus(at, a), normal) < 0) return false;
    }
    return true;
}

/// Returns the point on a circle around the z axis with the given radius and height, in the direction of `at`.
Point3d towards(const Point3d& at, double radius, double height) {
    const double across = std::hypot(at[0], at[1]);
    return across > 0 ? Point3d{at[0] * radius / across, at[1] * radius / across, height} : Point3d{radius, 0, height};
}

Point3d nearest(const shape::Sphere& sphere, const Point3d& to) {
    return length(to) <= sphere.radius ? to : times(to, sphere.radius / length(to));
}
Point3d nearest(const shape::Box& box, const Point3d& to) {
    Point3d at;
    for (std::size_t k = 0; k < 3; ++k) at[k] = std::clamp(to[k], -box.half_extents[k], box.half_extents[k]);
    return at;
}
Point3d nearest(const shape::Capsule& capsule, const Point3d& to) {
    const Point3d middle = {0, 0, std::clamp(to[2], -capsule.length / 2, capsule.length / 2)};
    return plus(middle, nearest(shape::Sphere{capsule.radius}, minus(to, middle)));
}
Point3d nearest(const shape::Cylinder& cylinder, const Point3d& to) {
    const double height = std::clamp(to[2], -cylinder.length / 2, cylinder.length / 2);
    return std::hypot(to[0], to[1]) <= cylinder.radius ? Point3d{to[0], to[1], height}
                                                       : towards(to, cylinder.radius, height);
}
Point3d nearest(const shape::Cone& cone, const Point3d& to) {
    const double half = cone.length / 2, across = std::hypot(to[0], to[1]);
    if (std::fabs(to[2]) <= half && across <= cone.radius * (half - to[2]) / cone.length) return to;
    const Point3d base = across <= cone.radius ? Point3d{to[0], to[1], -half} : towards(to, cone.radius, -half);
    return nearer(to, base, on_segment({0, 0, half}, towards(to, cone.radius, -half), to));
}
Point3d nearest(const shape::Ellipsoid& ellipsoid, const Point3d& to) {
    // Point x of the surface with to - x along the normal at x: x_k = r_k^2 to_k / (r_k^2 + t) for one t >= 0.
    const Point3d& r = ellipsoid.radii;
    const auto at = [&](double t) {
        return Point3d{r[0] * r[0] * to[0] / (r[0] * r[0] + t), r[1] * r[1] * to[1] / (r[1] * r[1] + t),
                       r[2] * r[2] * to[2] / (r[2] * r[2] + t)};
    };
    const auto outside = [&](const Point3d& x) { return length({x[0] / r[0], x[1] / r[1], x[2] / r[2]}) > 1; };
    if (!outside(to)) return to;
    double low = 0, high = length(to) * std::max({r[0], r[1], r[2]});
    for (int i = 0; i < 80; ++i) (outside(at((low + high) / 2)) ? low : high) = (low + high) / 2;
    return at(high);
}
Point3d nearest(const shape::ConvexHull& hull, const Point3d& to) {
    const auto& points = hull.points;
    Point3d best = points.front();
    for (std::size_t i = 0; i < points.size(); ++i) {
        for (std::size_t j = 0; j <= i; ++j) {
            for (std::size_t k = 0; k <= j; ++k) {
                best = nearer(to, best, on_triangle(points[i], points[j], points[k], to));
                for (std::size_t l = 0; l < k; ++l) {
                    if (in_tetrahedron({points[i], points[j], points[k], points[l]}, to)) return to;
                }
            }
        }
    }
    return best;
}
Point3d nearest(const shape::Plane& plane, const Point3d& to) {
    const double squared = dot(plane.normal, plane.normal);
    return minus(to, times(plane.normal, (dot(plane.normal, to) - plane.offset) / squared));
}
Point3d nearest(const shape::Mesh&, const Point3d&) { return {NAN, NAN, NAN}; }

}  // namespace

Point3d nearest_in(const shape::Any& shape, const Point3d& to) {
    return std::visit([&](const auto& one) { return nearest(one, to); }, shape);
}

Point3d nearest_in(const PosedShape& posed, const Point3d& to) {
    const Point3d own = vector::turned_back(posed.pose, minus(to, vector::place(posed.pose)));
    return plus(vector::turned(posed.pose, nearest_in(posed.shape, own)), vector::place(posed.pose));
}

double distance_by_turns(const PosedShape& a, const PosedShape& b, int times) {
    Point3d at = vector::place(b.pose);
    double distance = std::numeric_limits<double>::infinity();
    for (int i = 0; i < times; ++i) {
        const Point3d in_a = nearest_in(a, at), in_b = nearest_in(b, in_a);
        const double now = apart(in_a, in_b);
        if (!(now < distance)) break;
        distance = now, at = in_b;
    }
    return distance;
}

}  // namespace octopair::test
