#include "narrow_phase/largest_ball.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <vector>

namespace octopair::test {

namespace {

Point3d less(const Point3d& a, const Point3d& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
double product(const Point3d& a, const Point3d& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Point3d across(const Point3d& a, const Point3d& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double norm(const Point3d& a) { return std::sqrt(product(a, a)); }

double segment_distance(const Point3d& point, const Point3d& from, const Point3d& to) {
    const Point3d way = less(to, from), offset = less(point, from);
    const double square = product(way, way);
    const double part = square > 0 ? std::clamp(product(offset, way) / square, 0.0, 1.0) : 0;
    return norm(less(offset, {way[0] * part, way[1] * part, way[2] * part}));
}

double triangle_distance(const Point3d& point, const std::array<Point3d, 3>& t) {
    const Point3d normal = across(less(t[1], t[0]), less(t[2], t[0]));
    bool above = true;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < 3; ++i) {
        const Point3d &from = t[i], &to = t[(i + 1) % 3];
        above &= product(across(less(to, from), less(point, from)), normal) >= 0;
        least = std::min(least, segment_distance(point, from, to));
    }
    const double length = norm(normal);
    return above && length > 0 ? std::abs(product(normal, less(point, t[0]))) / length : least;
}

/// Returns the solid angle of a triangle, seen from a point (Van Oosterom and Strackee 1983).
double solid_angle(const Point3d& point, const std::array<Point3d, 3>& t) {
    const Point3d a = less(t[0], point), b = less(t[1], point), c = less(t[2], point);
    const double u = norm(a), v = norm(b), w = norm(c);
    return 2 *
           std::atan2(product(a, across(b, c)), u * v * w + product(a, b) * w + product(b, c) * u + product(c, a) * v);
}

/// The distance inside a solid; negative outside.
double depth_in(const shape::Mesh& mesh, const Point3d& point) {
    double angle = 0, least = std::numeric_limits<double>::infinity();
    for (const auto& [i, j, k] : mesh.triangles) {
        const std::array<Point3d, 3> triangle = {mesh.vertices[i], mesh.vertices[j], mesh.vertices[k]};
        angle += solid_angle(point, triangle);
        least = std::min(least, triangle_distance(point, triangle));
    }
    return std::abs(angle) > 2 * std::numbers::pi ? least : -least;
}

struct Extents {
    Point3d low, high;
};

Extents common_extents(const shape::Mesh& a, const shape::Mesh& b) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    Extents common{{-infinity, -infinity, -infinity}, {infinity, infinity, infinity}};
    for (const shape::Mesh* mesh : {&a, &b}) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const auto [low, high] =
                std::minmax_element(mesh->vertices.begin(), mesh->vertices.end(),
                                    [&](const Point3d& x, const Point3d& y) { return x[axis] < y[axis]; });
            common.low[axis] = std::max(common.low[axis], (*low)[axis]);
            common.high[axis] = std::min(common.high[axis], (*high)[axis]);
        }
    }
    return common;
}

struct Candidate {
    double depth;
    Point3d place;
};

}  // namespace

double largest_ball(const shape::Mesh& a, const shape::Mesh& b, unsigned steps) {
    const auto depth = [&](const Point3d& place) { return std::min(depth_in(a, place), depth_in(b, place)); };
    const auto [low, high] = common_extents(a, b);
    std::vector<Candidate> found;
    for (unsigned i = 0; i < steps * steps * steps; ++i) {
        const std::array<unsigned, 3> cell = {i % steps, i / steps % steps, i / steps / steps};
        Point3d place;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            place[axis] = low[axis] + (high[axis] - low[axis]) * (cell[axis] + 0.5) / steps;
        }
        found.push_back({depth(place), place});
    }
    const std::size_t starts = std::min<std::size_t>(found.size(), 6);
    std::partial_sort(found.begin(), found.begin() + std::ptrdiff_t(starts), found.end(),
                      [](const Candidate& x, const Candidate& y) { return x.depth > y.depth; });
    double best = 0;
    for (std::size_t start = 0; start < starts; ++start) {
        Candidate at = found[start];
        double step = norm(less(high, low)) / steps;
        for (int round = 0; round < 120 && step > 1e-7; ++round) {
            bool better = false;
            for (int code = 0; code < 27; ++code) {
                Point3d place = at.place;
                for (std::size_t axis = 0, rest = std::size_t(code); axis < 3; ++axis, rest /= 3) {
                    place[axis] += step * (double(rest % 3) - 1);
                }
                const double there = depth(place);
                if (there > at.depth) at = {there, place}, better = true;
            }
            if (!better) step /= 2;
        }
        best = std::max(best, 2 * at.depth);
    }
    return best;
}

}  // namespace octopair::test
