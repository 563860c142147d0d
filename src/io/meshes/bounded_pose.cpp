#include "io/meshes/bounded_pose.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/rounding.hpp"

namespace octopair {

namespace {

/// A sum of products with a bound on its rounding error. value() adds the rounding error of the bound itself.
class Sum {
public:
    void add(const Bounded& term) {
        const double sum = total_ + term.value;
        const double part = sum - total_;
        error_ += std::abs((total_ - (sum - part)) + (term.value - part)) + term.error;
        total_ = sum;
    }

    void add_product(const Bounded& a, const Bounded& b) {
        // Below `tiny` the remainder may be subnormal and inexact. It is then less than `allowance`.
        constexpr double tiny = 1e-280, allowance = 1e-300;
        const double product = a.value * b.value;
        double error = std::abs(std::fma(a.value, b.value, -product));
        const bool exact = a.value == 0 || b.value == 0 || std::abs(a.value) == 1 || std::abs(b.value) == 1;
        if (std::abs(product) < tiny && !exact) error += allowance;
        error += std::abs(a.value) * b.error + a.error * std::abs(b.value) + a.error * b.error;
        add({product, error});
    }

    /// Returns the sum. The bound was computed in float64 too, in at most a few dozen operations; adding 2^-40 of it covers
    /// their rounding.
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

BoundedPose BoundedPose::converted(const io::UnitChange& change) const {
    BoundedPose pose = *this;
    for (auto& row : pose.rows_) {
        auto& [value, error] = row[3];
        value = change(value);
        if (error != 0) error = rounding::next_above(change(error));
    }
    return pose;
}

double BoundedPose::largest_scale() const {
    double largest = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        largest = std::max(largest, std::hypot(rows_[0][axis].value, rows_[1][axis].value, rows_[2][axis].value));
    }
    return largest;
}

}  // namespace octopair
