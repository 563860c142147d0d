// Poses in float64 that know how far rounding may have moved their results.
//
// Every operation adds up what it rounds away, found exactly (two-sum; the remainder of a product by fma). So an error
// of zero means an exact result: meshes that are not moved, or moved by whole numbers, keep exact boxes, and the others
// are widened by no more than was rounded. The values themselves are those of plain float64 arithmetic, so a point's is
// where a vertex is in the world (octopair/shapes.hpp).
//
// Source: Ogita, Rump, Oishi 2005, "Accurate sum and dot product".
#pragma once

#include <array>

#include "octopair/pose.hpp"

namespace octopair {

/// A number, and a bound on its distance from the exact result.
struct Bounded {
    double value = 0;
    double error = 0;
};

/// A point between whose bounds the exact one lies.
struct BoundedPoint {
    Point3d value, low, high;
};

class BoundedPose {
public:
    /// The identity.
    BoundedPose();
    /// The rows of a 3 x 4 matrix, exact.
    explicit BoundedPose(const std::array<std::array<double, 4>, 3>& rows);

    /// What first applies `local`, then this: the pose of a child node.
    BoundedPose operator*(const BoundedPose& local) const;
    BoundedPoint apply(const Point3d& point) const;
    /// Without the bounds.
    Pose value() const;

private:
    std::array<std::array<Bounded, 4>, 3> rows_;
};

}  // namespace octopair
