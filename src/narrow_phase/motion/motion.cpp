#include "narrow_phase/motion/motion.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "geometry/vector.hpp"

namespace octopair {
namespace {

using Matrix = Eigen::Matrix3d;

Matrix linear(const Pose& pose) {
    Matrix matrix;
    for (int i = 0; i < 3; ++i) {
        for (int k = 0; k < 3; ++k) matrix(i, k) = pose.rows[std::size_t(i)][std::size_t(k)];
    }
    return matrix;
}

Pose with_place(const Matrix& matrix, const Point3d& place) {
    Pose pose;
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t k = 0; k < 3; ++k) pose.rows[i][k] = matrix(int(i), int(k));
        pose.rows[i][3] = place[i];
    }
    return pose;
}

bool is_turn(const Matrix& matrix) {
    constexpr double tolerance = 1e-6;
    const Matrix difference = matrix.transpose() * matrix - Matrix::Identity();
    return difference.cwiseAbs().maxCoeff() <= tolerance && matrix.determinant() > 0;
}

}  // namespace

std::optional<Motion> Motion::between(const Pose& begin, const Pose& end) {
    const Matrix first = linear(begin), last = linear(end);
    Motion motion;
    motion.begin_ = begin, motion.end_ = motion.ready_to_end_ = end;
    Matrix turn = Matrix::Identity();
    if (first != last) {
        const double size = std::max(first.cwiseAbs().maxCoeff(), last.cwiseAbs().maxCoeff());
        const Matrix relative = (last / size) * (first / size).inverse();
        if (!relative.allFinite() || !is_turn(relative)) return std::nullopt;
        const Eigen::AngleAxisd angle_axis(Eigen::Quaterniond(relative).normalized());
        motion.angle_ = angle_axis.angle();
        motion.axis_ = {angle_axis.axis()[0], angle_axis.axis()[1], angle_axis.axis()[2]};
        turn = angle_axis.toRotationMatrix();
    }
    const Matrix ready = turn.transpose() * last;
    motion.ready_to_end_ = with_place(ready, vector::place(end));
    motion.stretch_ = std::max(first.norm(), ready.norm());
    motion.change_ = (ready - first).norm();
    return motion;
}

Pose Motion::at(double time) const {
    if (time <= 0) return begin_;
    if (time >= 1) return end_;
    const Matrix blended = (1 - time) * linear(begin_) + time * linear(ready_to_end_);
    const Eigen::AngleAxisd turn(time * angle_, Eigen::Vector3d(axis_[0], axis_[1], axis_[2]));
    const Point3d from = vector::place(begin_), to = vector::place(end_);
    return with_place(turn.toRotationMatrix() * blended,
                      vector::plus(vector::times(from, 1 - time), vector::times(to, time)));
}

double Motion::speed(double reach) const {
    const double way = vector::length(vector::minus(vector::place(end_), vector::place(begin_)));
    return (way + (angle_ * stretch_ + change_) * reach) * (1 + 1e-12);
}

double Motion::sagitta(double reach, double step) const {
    // Between its ends, a curve is at most step^2 / 8 * (bound of its second derivative) away from its chord.
    return angle_ * (angle_ * stretch_ + 2 * change_) * reach * step * step / 8 * (1 + 1e-12);
}

}  // namespace octopair
