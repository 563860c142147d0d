#include "narrow_phase/convex/face_directions.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include "geometry/vector.hpp"

namespace octopair {
namespace {

using vector::cross;
using vector::dot;
using vector::minus;
using vector::plus;
using vector::times;

/// Up to six points of a core that are farthest along directions near a given one. Equal points are stored once.
class NearPoints {
public:
    /// `direction` has length 1.
    NearPoints(const LocalConvex& convex, const Point3d& direction) {
        if (!convex.points().empty()) {
            for (const Point3d& point : convex.points()) add(point);
            return;
        }
        constexpr double aside = 1e-5;
        const auto add_toward = [&](const Point3d& way) {
            const double length = vector::length(way);
            if (length > 0) add(convex.support(plus(direction, times(way, aside / length))));
        };
        const Point3d first = vector::some_normal(direction), second = cross(direction, first);
        for (const Point3d& way : {first, second}) add_toward(way), add_toward(times(way, -1));
        // The third corner of a triangle may be farthest only along directions that are perpendicular to the longest edge.
        const Point3d edge = longest_edge(), across = cross(direction, edge);
        add_toward(across), add_toward(times(across, -1));
    }

    std::span<const Point3d> points() const { return {points_.data(), count_}; }

private:
    void add(const Point3d& point) {
        const auto end = points_.begin() + std::ptrdiff_t(count_);
        if (std::find(points_.begin(), end, point) == end) points_[count_++] = point;
    }
    Point3d longest_edge() const {
        Point3d longest = {};
        for (std::size_t i = 0; i < count_; ++i) {
            for (std::size_t k = 0; k < i; ++k) {
                const Point3d edge = minus(points_[i], points_[k]);
                if (dot(edge, edge) > dot(longest, longest)) longest = edge;
            }
        }
        return longest;
    }

    std::array<Point3d, 6> points_ = {};
    std::size_t count_ = 0;
};

/// Normals of the faces and directions of the edges of a core near a direction, of any length.
struct NearFeatures {
    std::array<Point3d, 20> normals = {};
    std::array<Point3d, 15> edges = {};
    std::size_t normal_count = 0, edge_count = 0;

    NearFeatures(const LocalConvex& convex, const Point3d& direction) {
        if (!convex.is_points()) {
            for (std::size_t axis = 0; axis < 3; ++axis) add_axis(vector::column(convex.pose(), axis));
            return;
        }
        const NearPoints near(convex, direction);
        const auto points = near.points();
        for (std::size_t i = 0; i < points.size(); ++i) {
            for (std::size_t j = 0; j < i; ++j) {
                const Point3d edge = minus(points[j], points[i]);
                edges[edge_count++] = edge;
                for (std::size_t k = 0; k < j; ++k) normals[normal_count++] = cross(edge, minus(points[k], points[i]));
            }
        }
    }

private:
    void add_axis(const Point3d& axis) { normals[normal_count++] = axis, edges[edge_count++] = axis; }
};

/// Returns the part of `direction` that is perpendicular to `edge`. The second step removes the rounding of the first one.
Point3d turned_across(const Point3d& edge, Point3d direction) {
    for (int step = 0; step < 2; ++step) {
        direction = minus(direction, times(edge, dot(direction, edge) / dot(edge, edge)));
    }
    return direction;
}

}  // namespace

void propose_face_directions(const LocalConvexPair& pair, double enough, LeastOverlap& least) {
    const Point3d direction = least.normal();
    const NearFeatures a(pair.a(), direction), b(pair.b(), times(direction, -1));
    const auto is_enough = [&](const Point3d& proposal) {
        least.propose(proposal);
        return least.overlap() <= enough;
    };
    for (const NearFeatures* one : {&a, &b}) {
        for (std::size_t i = 0; i < one->normal_count; ++i) {
            if (is_enough(one->normals[i])) return;
        }
        for (std::size_t i = 0; i < one->edge_count; ++i) {
            if (is_enough(turned_across(one->edges[i], direction))) return;
        }
    }
    for (std::size_t i = 0; i < a.edge_count; ++i) {
        for (std::size_t k = 0; k < b.edge_count; ++k) {
            if (is_enough(cross(a.edges[i], b.edges[k]))) return;
        }
    }
}

}  // namespace octopair
