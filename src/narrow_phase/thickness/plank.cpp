#include "narrow_phase/thickness/plank.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace octopair {

namespace {

/// Returns a number that grows with the angle of (x, y), from -2 to 2.
double angle_order(double x, double y) {
    const double size = std::abs(x) + std::abs(y);
    if (!(size > 0)) return 0;
    return x >= 0 ? y / size : std::copysign(2, y) - y / size;
}

/// Sorts the corners of a convex polygon by their angles around its middle.
void sort_around(Polygon& polygon, const Point3d& normal) {
    const Point3d middle = middle_of(polygon), u = vector::some_normal(normal), v = vector::cross(normal, u);
    const auto angle = [&](const Point3d& corner) {
        const Point3d from = vector::minus(corner, middle);
        return angle_order(vector::dot(from, u), vector::dot(from, v));
    };
    std::sort(polygon.corners.begin(), polygon.corners.end(),
              [&](const Point3d& x, const Point3d& y) { return angle(x) < angle(y); });
}

struct RegionSearch {
    std::span<const Plank> planks;
    double rounding;
    const std::function<bool(const Polyhedron&)>& visit;
    std::vector<CutPlane> sides;  // of the planks before: the region is below all

    bool run(const Polyhedron& region) {
        if (region.empty()) return true;
        if (sides.size() < planks.size()) {
            const Plank& plank = planks[sides.size()];
            return run_side(region, {plank.normal, plank.extent.low}) &&
                   run_side(region, {vector::times(plank.normal, -1), -plank.extent.high});
        }
        const Point3d middle = region.middle();
        const bool has_interior = std::all_of(sides.begin(), sides.end(),
                                              [&](const CutPlane& side) { return side.height(middle) < -rounding; });
        return !has_interior || visit(region);
    }

    bool run_side(Polyhedron region, const CutPlane& side) {
        region.cut(side, rounding);
        sides.push_back(side);
        const bool goes_on = run(region);
        sides.pop_back();
        return goes_on;
    }
};

}  // namespace

Polyhedron::Polyhedron(const ConvexDomain& domain, double rounding) : planes_(planes_of(domain.box)) {
    const Box3d& box = domain.box;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
        for (const double at : {box.min[axis], box.max[axis]}) {
            Polygon& face = faces_.emplace_back();
            for (const auto& [x, y] : {std::pair{box.min[u], box.min[v]},
                                       {box.max[u], box.min[v]},
                                       {box.max[u], box.max[v]},
                                       {box.min[u], box.max[v]}}) {
                Point3d& corner = face.corners.emplace_back();
                corner[axis] = at, corner[u] = x, corner[v] = y;
            }
        }
    }
    for (const CutPlane& plane : domain.planes) cut(plane, rounding);
}

void Polyhedron::cut(const CutPlane& plane, double rounding) {
    if (empty() || along(plane.normal).high <= plane.offset + rounding) return;
    std::vector<Polygon> kept;
    Polygon cap;
    for (const Polygon& face : faces_) {
        Polygon below = cut_below(face, plane, rounding);
        for (const Point3d& corner : below.corners) {
            if (std::abs(plane.height(corner)) <= rounding) cap.corners.push_back(corner);
        }
        if (!below.empty()) kept.push_back(std::move(below));
    }
    faces_ = std::move(kept);
    planes_.push_back(plane);
    if (cap.empty()) return;
    sort_around(cap, plane.normal);
    faces_.push_back(std::move(cap));
}

void Polyhedron::cut_to(std::span<const CutPlane> planes, double rounding) {
    for (const CutPlane& plane : planes) cut(plane, rounding);
    if (empty()) return;
    const Point3d at = middle();
    const bool inside =
        std::all_of(planes.begin(), planes.end(), [&](const CutPlane& plane) { return plane.height(at) < -rounding; });
    if (!inside) faces_.clear();
}

Point3d Polyhedron::middle() const {
    Point3d sum = {};
    for (const Polygon& face : faces_) sum = vector::plus(sum, middle_of(face));
    return vector::times(sum, 1 / double(faces_.size()));
}

Extent Polyhedron::along(const Point3d& direction) const {
    Extent extent = extent_along(direction, faces_.front());
    for (const Polygon& face : faces_) {
        const auto [low, high] = extent_along(direction, face);
        extent = {std::min(extent.low, low), std::max(extent.high, high)};
    }
    return extent;
}

std::vector<Point3d> Polyhedron::corners() const {
    std::vector<Point3d> corners;
    for (const Polygon& face : faces_) corners.insert(corners.end(), face.corners.begin(), face.corners.end());
    return corners;
}

std::vector<CutPlane> planes_of(const Box3d& box) {
    std::vector<CutPlane> planes;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        Point3d unit = {};
        unit[axis] = 1;
        planes.push_back({unit, box.max[axis]});
        planes.push_back({vector::times(unit, -1), -box.min[axis]});
    }
    return planes;
}

ConvexDomain rounded_domain(const Box3d& box, double reach) {
    ConvexDomain domain{box};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        domain.box.min[axis] -= reach;
        domain.box.max[axis] += reach;
    }
    // Each direction with at least two of three coordinates: 12 edges and 8 corners.
    for (int code = 0; code < 27; ++code) {
        const std::array<int, 3> signs = {code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1};
        const double count = std::abs(signs[0]) + std::abs(signs[1]) + std::abs(signs[2]);
        if (count < 2) continue;
        CutPlane plane{{}, reach};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            plane.normal[axis] = signs[axis] / std::sqrt(count);
            plane.offset += plane.normal[axis] * (signs[axis] < 0 ? box.min[axis] : box.max[axis]);
        }
        domain.planes.push_back(plane);
    }
    return domain;
}

bool visit_regions(const Polyhedron& whole, std::span<const Plank> planks, double rounding,
                   const std::function<bool(const Polyhedron& region)>& visit) {
    return RegionSearch{planks, rounding, visit, {}}.run(whole);
}

}  // namespace octopair
