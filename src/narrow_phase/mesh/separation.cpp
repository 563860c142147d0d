#include "narrow_phase/mesh/separation.hpp"

#include <limits>

namespace octopair {

namespace {

/// Unit roundoff: largest relative error of a float64 operation.
constexpr double unit = 0x1p-53;
/// Upper bound on the number of roundings in each error bound below.
constexpr double roundings = 64;

double largest_row_sum(const std::array<std::array<double, 3>, 3>& m) {
    double largest = 0;
    for (const auto& row : m) largest = std::max(largest, std::abs(row[0]) + std::abs(row[1]) + std::abs(row[2]));
    return largest;
}

std::array<std::array<double, 3>, 3> linear_part(const Pose& pose) {
    std::array<std::array<double, 3>, 3> m;
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) m[row][column] = pose.rows[row][column];
    }
    return m;
}

/// Returns the inverse, by cofactors; infinite or NaN numbers if there is none.
std::array<std::array<double, 3>, 3> inverse_of(const std::array<std::array<double, 3>, 3>& m) {
    std::array<std::array<double, 3>, 3> inverse;
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) {
            const int r1 = (column + 1) % 3, r2 = (column + 2) % 3, c1 = (row + 1) % 3, c2 = (row + 2) % 3;
            inverse[row][column] = m[r1][c1] * m[r2][c2] - m[r1][c2] * m[r2][c1];
        }
    }
    const double determinant = m[0][0] * inverse[0][0] + m[0][1] * inverse[1][0] + m[0][2] * inverse[2][0];
    for (auto& row : inverse) {
        for (double& number : row) number /= determinant;
    }
    return inverse;
}

/// A world coordinate of a place in the boxes is a sum of terms. Returns an upper bound on the sum of their absolute values.
double reach_in_world(const PosedBoxes& boxes) {
    double largest = 0;
    for (int row = 0; row < 3; ++row) {
        double sum = std::abs(boxes.pose.rows[row][3]);
        for (int axis = 0; axis < 3; ++axis) {
            const double local = std::abs(boxes.origin[axis]) + double(std::abs(boxes.root.centre[axis])) +
                                 double(boxes.root.half[axis]);
            sum += std::abs(boxes.pose.rows[row][axis]) * local;
        }
        largest = std::max(largest, sum);
    }
    return largest;
}

/// Returns the world vector from a's origin to b's origin.
Point3d between_origins(const PosedBoxes& a, const PosedBoxes& b) {
    const Point3d from = vector::posed(a.pose, a.origin), to = vector::posed(b.pose, b.origin);
    return {to[0] - from[0], to[1] - from[1], to[2] - from[2]};
}

}  // namespace

Separation::Map Separation::map_of(const Matrix& matrix) {
    Map map;
    for (int column = 0; column < 3; ++column) {
        for (int row = 0; row < 3; ++row) {
            map.column[column].at[row] = float(matrix[row][column]);
            // Rounded up, so that half extents are rounded up too.
            map.magnitude[column].at[row] = std::abs(map.column[column].at[row]) * (1 + 0x1p-20F);
        }
    }
    return map;
}

/// The slack also covers the float32 rounding error: 2^-19 of the sum of the largest numbers along an axis.
void Separation::round_to_lanes(const PosedBoxes& own, const PosedBoxes& other, double room, Axes& axes) {
    const auto reach = [](const MeshNode& node, int axis) {
        return double(std::abs(node.centre[axis])) + double(node.half[axis]);
    };
    for (int i = 0; i < 3; ++i) {
        double largest = std::abs(double(axes.offset.at[i]));
        for (int axis = 0; axis < 3; ++axis) {
            largest += double(axes.other.magnitude[axis].at[i]) * reach(other.root, axis);
        }
        for (int axis = 0; axis < 3; ++axis) largest += reach(own.root, axis);
        axes.slack.at[i] = float((room + 0x1p-19 * largest) * (1 + 0x1p-20));
    }
    axes.slack.at[3] = std::numeric_limits<float>::infinity();
    axes.scale.at[3] = 1;
}

std::optional<Separation::OwnAxes> Separation::axes_of(const PosedBoxes& own, const PosedBoxes& other) {
    const Matrix pose = linear_part(own.pose), undo = inverse_of(pose), others = linear_part(other.pose);
    const double stretch = largest_row_sum(undo), condition = stretch * largest_row_sum(pose);
    if (!(condition < 1e5)) return std::nullopt;
    const Point3d way = between_origins(own, other);
    const double world = reach_in_world(own) + reach_in_world(other);
    OwnAxes axes;
    Matrix to_own;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            to_own[i][j] = undo[i][0] * others[0][j] + undo[i][1] * others[1][j] + undo[i][2] * others[2][j];
        }
        axes.offset.at[i] = float(undo[i][0] * way[0] + undo[i][1] * way[1] + undo[i][2] * way[2]);
        // A world vector of length 1 extends along this axis by at most the length of this row of the inverse.
        const double row = std::sqrt(undo[i][0] * undo[i][0] + undo[i][1] * undo[i][1] + undo[i][2] * undo[i][2]);
        axes.scale.at[i] = float((1 - 0x1p-20) / row);
    }
    axes.other = map_of(to_own);
    round_to_lanes(own, other, roundings * unit * stretch * world * (1 + condition), axes);
    return axes;
}

Separation::WorldAxes Separation::axes_of_world(const PosedBoxes& a, const PosedBoxes& b) {
    WorldAxes axes;
    axes.own = map_of(linear_part(a.pose));
    axes.other = map_of(linear_part(b.pose));
    const Point3d way = between_origins(a, b);
    for (int i = 0; i < 3; ++i) {
        axes.offset.at[i] = float(way[i]);
        axes.scale.at[i] = 1 - 0x1p-20F;
    }
    // The boxes of a are mapped to the world too, so the float32 error is bounded by their reach in the world.
    const double world = reach_in_world(a) + reach_in_world(b);
    round_to_lanes(a, b, (roundings * unit + 0x1p-19) * world, axes);
    return axes;
}

Separation::Separation(const PosedBoxes& a, const PosedBoxes& b) {
    size_ = {float(largest_row_sum(linear_part(a.pose))), float(largest_row_sum(linear_part(b.pose)))};
    const auto of_a = axes_of(a, b), of_b = axes_of(b, a);
    if (of_a && of_b) {
        of_a_ = *of_a;
        of_b_ = *of_b;
    } else {
        world_ = axes_of_world(a, b);
    }
}

}  // namespace octopair
