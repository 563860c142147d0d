// greatest_on_ball(): a proven upper bound on the greatest value of a quadratic function in the unit ball.
#pragma once

#include <Eigen/Core>

namespace octopair {

/// The function y -> y' square y + 2 linear' y + constant. The matrix is symmetric.
struct Quadratic {
    Eigen::Matrix3d square;
    Eigen::Vector3d linear;
    double constant;
};

/// Returns |offset + map y|^2 as a function of y.
Quadratic squared_length(const Eigen::Vector3d& offset, const Eigen::Matrix3d& map);

/// Returns (offset + along' y)^2 as a function of y.
Quadratic squared(double offset, const Eigen::Vector3d& along);

/// Returns a number that the function exceeds nowhere in the unit ball. It is the greatest value itself, up to rounding.
/// Requires: no intermediate result overflows.
double greatest_on_ball(const Quadratic& function);

}  // namespace octopair
