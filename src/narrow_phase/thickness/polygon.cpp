#include "narrow_phase/thickness/polygon.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace octopair {

namespace {

/// Returns the part of a polygon where `height` is at most 0; height(corner) is affine.
template <typename Height>
Polygon part_below(const Polygon& polygon, const Height& height) {
    Polygon part;
    const std::size_t count = polygon.corners.size();
    part.corners.reserve(count + 1);
    for (std::size_t i = 0; i < count; ++i) {
        const Point3d &from = polygon.corners[i], &to = polygon.corners[(i + 1) % count];
        const double at = height(from), next = height(to);
        if (at <= 0) part.corners.push_back(from);
        if ((at < 0 && next > 0) || (at > 0 && next < 0)) {
            part.corners.push_back(vector::plus(from, vector::times(vector::minus(to, from), at / (at - next))));
        }
    }
    if (part.empty()) part.corners.clear();
    return part;
}

}  // namespace

Extent extent_along(const Point3d& direction, const Polygon& polygon) {
    Extent extent{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    for (const Point3d& corner : polygon.corners) {
        const double at = vector::dot(direction, corner);
        extent = {std::min(extent.low, at), std::max(extent.high, at)};
    }
    return extent;
}

std::optional<Point3d> direction_of(const Point3d& way) {
    const double length = vector::length(way);
    if (!(length > 1e-3)) return std::nullopt;
    return vector::times(way, 1 / length);
}

Point3d middle_of(const Polygon& polygon) {
    Point3d sum = {};
    for (const Point3d& corner : polygon.corners) sum = vector::plus(sum, corner);
    return vector::times(sum, 1 / double(polygon.corners.size()));
}

Point3d middle_of(const Box3d& box) {
    Point3d middle;
    for (std::size_t axis = 0; axis < 3; ++axis) middle[axis] = box.min[axis] / 2 + box.max[axis] / 2;
    return middle;
}

bool contains(const Box3d& box, const Point3d& point) {
    bool inside = true;
    for (std::size_t axis = 0; axis < 3; ++axis) inside &= box.min[axis] <= point[axis] && point[axis] <= box.max[axis];
    return inside;
}

double area_of(const Polygon& polygon) {
    Point3d sum = {};
    for (std::size_t i = 2; i < polygon.corners.size(); ++i) {
        sum = vector::plus(sum, vector::cross(vector::minus(polygon.corners[i - 1], polygon.corners[0]),
                                              vector::minus(polygon.corners[i], polygon.corners[0])));
    }
    return vector::length(sum) / 2;
}

Polygon clipped(const Triangle3d& triangle, const Box3d& box) {
    Polygon polygon;
    polygon.corners.assign(triangle.begin(), triangle.end());
    for (int axis = 0; axis < 3 && !polygon.empty(); ++axis) {
        double low = polygon.corners[0][axis], high = low;
        for (const Point3d& corner : polygon.corners) {
            low = std::min(low, corner[axis]);
            high = std::max(high, corner[axis]);
        }
        if (low < box.min[axis])
            polygon = part_below(polygon, [&](const Point3d& corner) { return box.min[axis] - corner[axis]; });
        if (high > box.max[axis])
            polygon = part_below(polygon, [&](const Point3d& corner) { return corner[axis] - box.max[axis]; });
    }
    return polygon;
}

SplitPolygon split(const Polygon& polygon, const CutPlane& plane, double rounding) {
    if (polygon.empty()) return {};
    const auto [low, high] = extent_along(plane.normal, polygon);
    if (high <= plane.offset + rounding) return {polygon, {}};
    if (low >= plane.offset - rounding) return {{}, polygon};
    return {part_below(polygon, [&](const Point3d& corner) { return plane.height(corner); }),
            part_below(polygon, [&](const Point3d& corner) { return -plane.height(corner); })};
}

Polygon cut_below(Polygon polygon, const CutPlane& plane, double rounding) {
    if (polygon.empty()) return {};
    const auto [low, high] = extent_along(plane.normal, polygon);
    if (high <= plane.offset + rounding) return polygon;
    if (low >= plane.offset - rounding) return {};
    return part_below(polygon, [&](const Point3d& corner) { return plane.height(corner); });
}

std::vector<CutPlane> prism_over(const std::vector<Point3d>& points, const Point3d& direction) {
    const auto u = direction_of(vector::some_normal(direction));
    const Point3d v = vector::cross(direction, *u);
    struct Flat {
        double x, y;
    };
    std::vector<Flat> flat;
    flat.reserve(points.size());
    for (const Point3d& point : points) flat.push_back({vector::dot(*u, point), vector::dot(v, point)});
    std::sort(flat.begin(), flat.end(),
              [](const Flat& p, const Flat& q) { return p.x != q.x ? p.x < q.x : p.y < q.y; });
    // Andrew's monotone chain: the lower chain, then the upper one, counterclockwise.
    std::vector<Flat> hull;
    for (const bool upper : {false, true}) {
        const std::size_t first = hull.size();
        for (std::size_t i = 0; i < flat.size(); ++i) {
            const Flat& next = flat[upper ? flat.size() - 1 - i : i];
            while (hull.size() >= first + 2) {
                // Differences of neighbours: those of far points would lose the few bits by which nearly equal points differ, and a turn to
                // the wrong side would cut off points.
                const Flat &p = hull[hull.size() - 2], &q = hull.back();
                if ((q.x - p.x) * (next.y - q.y) - (q.y - p.y) * (next.x - q.x) > 0) break;
                hull.pop_back();
            }
            hull.push_back(next);
        }
        hull.pop_back();
    }
    std::vector<CutPlane> planes;
    for (std::size_t i = 0; i < hull.size(); ++i) {
        const Flat &p = hull[i], &q = hull[(i + 1) % hull.size()];
        const double x = q.y - p.y, y = p.x - q.x, length = std::hypot(x, y);
        if (!(length > 0)) continue;
        const Point3d normal = vector::plus(vector::times(*u, x / length), vector::times(v, y / length));
        planes.push_back({normal, (x * p.x + y * p.y) / length});
    }
    return planes;
}

}  // namespace octopair
