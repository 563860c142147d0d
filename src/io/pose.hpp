// Affine transforms in float64 that know how far rounding may have moved their results.
//
// Every operation adds up what it rounds away, found exactly (two-sum; the remainder of a product by fma). So an error
// of zero means an exact result: meshes that are not moved, or moved by whole numbers, keep exact boxes, and the others
// are widened by no more than was rounded.
//
// Source: Ogita, Rump, Oishi 2005, "Accurate sum and dot product".
#pragma once

#include <array>

namespace octopair::io {

/// A number, and a bound on its distance from the exact result.
struct Bounded {
    double value = 0;
    double error = 0;
};

/// A point between whose bounds the exact one lies.
struct BoundedPoint {
    std::array<double, 3> value, low, high;
};

class Pose {
public:
    /// The identity.
    Pose();
    /// The rows of a 3 x 4 matrix, exact.
    explicit Pose(const std::array<std::array<double, 4>, 3>& rows);

    /// What first applies `local`, then this: the pose of a child node.
    Pose operator*(const Pose& local) const;
    BoundedPoint apply(const std::array<double, 3>& point) const;

private:
    std::array<std::array<Bounded, 4>, 3> rows_;
};

}  // namespace octopair::io
