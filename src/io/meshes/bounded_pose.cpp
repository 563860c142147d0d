#include "io/meshes/bounded_pose.hpp"

#include <cmath>

#include "geometry/rounding.hpp"

namespace octopair {

namespace {

/// A sum of products; its error bounds what was rounded away, up to the bound's own rounding (see value()).
class Sum {
public:
    void add(const Bounded& term) {
        const double sum = total_ + term.value;
        const double part = sum - total_;
        error_ += std::abs((total_ - (sum - part)) + (term.value - part)) + term.error;
        total_ = sum;
    }

    void add_product(const Bounded& a, const Bounded& b) {
        // Below this the remainder may not be a float64; it is then less than the allowance.
        constexpr double tiny = 1e-280, allowance = 1e-300;
        const double product = a.value * b.value;
        double error = std::abs(std::fma(a.value, b.value, -product));
        const bool exact = a.value == 0 || b.value == 0 || std::abs(a.value) == 1 || std::abs(b.value) == 1;
        if (std::abs(product) < tiny && !exact) error += allowance;
        error += std::abs(a.value) * b.error + a.error * std::abs(b.value) + a.error * b.error;
        add({product, error});
    }

    /// The bound was itself added up in float64, in at most some dozens of operations; 2^-40 of it covers them.
    Bounded value() const { return {total_, error_ * (1 + 0x1p-40)}; }

private:
    double total_ = 0;
    double error_ = 0;
};

}  // namespace

BoundedPose::BoundedPose() : BoundedPose({{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}}) {}

BoundedPose::BoundedPose(const std::array<std::array<double, 4>, 3>& rows) {
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 4; ++column) rows_[row][column] = {rows[row][column], 0};
    }
}

BoundedPose BoundedPose::operator*(const BoundedPose& local) const {
    BoundedPose product;
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 4; ++column) {
            Sum sum;
            for (int k = 0; k < 3; ++k) sum.add_product(rows_[row][k], local.rows_[k][column]);
            if (column == 3) sum.add(rows_[row][3]);
            product.rows_[row][column] = sum.value();
        }
    }
    return product;
}

BoundedPoint BoundedPose::apply(const Point3d& point) const {
    BoundedPoint posed;
    for (int row = 0; row < 3; ++row) {
        Sum sum;
        for (int k = 0; k < 3; ++k) sum.add_product(rows_[row][k], {point[k], 0});
        sum.add(rows_[row][3]);
        const auto [value, error] = sum.value();
        posed.value[row] = value;
        posed.low[row] = error == 0 ? value : rounding::next_below(value - error);
        posed.high[row] = error == 0 ? value : rounding::next_above(value + error);
    }
    return posed;
}

Pose BoundedPose::value() const {
    Pose pose;
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 4; ++column) pose.rows[row][column] = rows_[row][column].value;
    }
    return pose;
}

}  // namespace octopair
