// Planks: slabs between two parallel planes, and the regions of a convex domain outside of them.
//
// Theorem   If planks cover a convex body, the sum of their widths is at least the least width of the body. So planks whose widths sum
//           to T do not cover a ball of a diameter above T.
// Source    Bang 1951, "A solution of the plank problem".
#pragma once

#include <algorithm>
#include <functional>
#include <span>
#include <vector>

#include "narrow_phase/thickness/polygon.hpp"
#include "octopair/objects.hpp"
#include "octopair/pose.hpp"

namespace octopair {

/// The points x whose coordinate normal * x is in the extent.
struct Plank {
    Point3d normal;  ///< length 1
    Extent extent;

    double width() const { return extent.high - extent.low; }
    Plank widened(const Extent& more) const {
        return {normal, {std::min(extent.low, more.low), std::max(extent.high, more.high)}};
    }
    bool covers(const Extent& other, double rounding) const {
        return other.low >= extent.low - rounding && other.high <= extent.high + rounding;
    }
};

/// A box without the parts above some planes.
struct ConvexDomain {
    Box3d box;
    std::vector<CutPlane> planes = {};
};

/// Returns a domain that contains all points within `reach` of the box, and few others: its edges and corners are cut off.
ConvexDomain rounded_domain(const Box3d& box, double reach);

/// Returns the planes of the faces of a box.
std::vector<CutPlane> planes_of(const Box3d& box);

/// A bounded convex polyhedron, by its faces; without faces it is empty.
class Polyhedron {
public:
    Polyhedron() = default;
    Polyhedron(const ConvexDomain& domain, double rounding);

    /// Removes the part above the plane.
    void cut(const CutPlane& plane, double rounding);

    /// Removes the parts above all planes. If no interior is left, the polyhedron becomes empty.
    void cut_to(std::span<const CutPlane> planes, double rounding);

    bool empty() const { return faces_.empty(); }
    /// Returns a point of the interior, if there is an interior. Requires: not empty.
    Point3d middle() const;
    Extent along(const Point3d& direction) const;
    /// Returns all corners, most of them several times.
    std::vector<Point3d> corners() const;
    /// The polyhedron is all that is below these planes.
    const std::vector<CutPlane>& planes() const { return planes_; }

private:
    std::vector<Polygon> faces_;
    std::vector<CutPlane> planes_;
};

/// Calls `visit` for each part of the polyhedron outside of all planks, until it returns false. Leaves out parts that are nowhere wider than
/// about `rounding`. Returns false if `visit` did.
bool visit_regions(const Polyhedron& whole, std::span<const Plank> planks, double rounding,
                   const std::function<bool(const Polyhedron& region)>& visit);

}  // namespace octopair
