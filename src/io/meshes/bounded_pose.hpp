// BoundedPose: a pose in float64 with a bound on the rounding error of each number.
//
// - Every operation adds the rounding error of its steps to the bound. Two-sum gives the exact error of a sum, fma that of
//   a product.
// - A bound of zero means an exact result. So meshes without a transform, or with a translation by whole numbers, keep exact boxes.
// - Other boxes grow by no more than the rounding error.
// - The values are those of plain float64 arithmetic, so they agree with the world positions of octopair/shapes.hpp.
//
// Source: Ogita, Rump, Oishi 2005, "Accurate sum and dot product".
#pragma once

#include <array>

#include "io/formats/unit_change.hpp"
#include "octopair/pose.hpp"

namespace octopair {

/// A rounded number, and an upper bound on its distance from the exact number.
struct Bounded {
    double value = 0;
    double error = 0;
};

/// A rounded point. The exact point lies between `low` and `high` on each axis.
struct BoundedPoint {
    Point3d value, low, high;
};

class BoundedPose {
public:
    /// Makes the identity.
    BoundedPose();
    /// Makes a pose from the rows of a 3 x 4 matrix. The numbers count as exact.
    explicit BoundedPose(const std::array<std::array<double, 4>, 3>& rows);

    /// Returns the pose that applies `local` first, then this pose: the pose of a child node.
    BoundedPose operator*(const BoundedPose& local) const;
    BoundedPoint apply(const Point3d& point) const;
    /// Returns the pose without its bounds.
    Pose value() const;
    /// Returns the pose for points whose coordinates have been converted, too: its translation is converted, and then counts as exact, but
    /// for the bound that it had.
    BoundedPose converted(const io::UnitChange& change) const;
    /// Returns the largest factor by which the pose lengthens an axis.
    double largest_scale() const;

private:
    std::array<std::array<Bounded, 4>, 3> rows_;
};

}  // namespace octopair
