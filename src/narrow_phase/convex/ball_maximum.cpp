// Method    For any number m above 0 and above all eigenvalues of the matrix, f(y) <= f(y) + m (1 - y'y) in the ball, and the right
//           side is concave, so its greatest value is known. The least of these bounds is the greatest value of f, also if f is neither
//           convex nor concave (S-lemma).
// Source    Polik, Terlaky: A survey of the S-lemma, SIAM Review 49 (2007).
#include "narrow_phase/convex/ball_maximum.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

namespace octopair {

namespace {

using Vector = Eigen::Vector3d;

constexpr double unit_roundoff = std::numeric_limits<double>::epsilon();

/// Returns the least m between two bounds for which the concave function has its greatest value in the ball: |y(m)| <= 1.
double least_multiplier(const Vector& eigenvalues, const Vector& linear, double below, double above) {
    const auto is_in_ball = [&](double m) {
        return (linear.array() / (m - eigenvalues.array())).matrix().squaredNorm() <= 1;
    };
    for (int step = 0; step < 60; ++step) {
        const double middle = below + (above - below) / 2;
        if (!(middle > below && middle < above)) break;
        (is_in_ball(middle) ? above : below) = middle;
    }
    return above;
}

}  // namespace

Quadratic squared_length(const Vector& offset, const Eigen::Matrix3d& map) {
    return {map.transpose() * map, map.transpose() * offset, offset.squaredNorm()};
}

Quadratic squared(double offset, const Vector& along) {
    return {along * along.transpose(), along * offset, offset * offset};
}

double greatest_on_ball(const Quadratic& function) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(function.square);
    const Vector& eigenvalues = solver.eigenvalues();
    const Vector linear = solver.eigenvectors().transpose() * function.linear;
    const double size = eigenvalues.cwiseAbs().maxCoeff() + linear.norm() + std::fabs(function.constant);
    // Eigenvalues err by a few roundings of the largest one, so the multiplier stays so far above them.
    const double least =
        std::max(eigenvalues.maxCoeff(), 0.0) + 16 * unit_roundoff * size + std::numeric_limits<double>::min();
    const double m = least_multiplier(eigenvalues, linear, least, least + linear.norm());
    const Vector parts = linear.array().square() / (m - eigenvalues.array());
    return function.constant + m + parts.sum() + 64 * unit_roundoff * size;
}

}  // namespace octopair
