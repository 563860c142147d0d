#include "io/meshes/content/dxf_transform.hpp"

#include <cmath>
#include <numbers>

namespace octopair::io {

namespace {

DxfPoint cross_of(const DxfPoint& a, const DxfPoint& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

DxfPoint unit_of(const DxfPoint& vector) {
    const double length = std::hypot(vector[0], vector[1], vector[2]);
    return {vector[0] / length, vector[1] / length, vector[2] / length};
}

}  // namespace

DxfTransform DxfTransform::move(const DxfPoint& by) {
    return DxfTransform({{{1, 0, 0, by[0]}, {0, 1, 0, by[1]}, {0, 0, 1, by[2]}}});
}

DxfTransform DxfTransform::scale(const DxfPoint& by) {
    return DxfTransform({{{by[0], 0, 0, 0}, {0, by[1], 0, 0}, {0, 0, by[2], 0}}});
}

DxfTransform DxfTransform::turn(double degrees) {
    double sine = 0, cosine = 1;
    const double quarters = std::remainder(degrees, 360) / 90;
    if (quarters == std::round(quarters)) {  // exact
        constexpr std::array<double, 5> sines = {0, -1, 0, 1, 0}, cosines = {-1, 0, 1, 0, -1};
        sine = sines[std::size_t(quarters + 2)];
        cosine = cosines[std::size_t(quarters + 2)];
    } else {
        sine = std::sin(degrees * std::numbers::pi / 180);
        cosine = std::cos(degrees * std::numbers::pi / 180);
    }
    return DxfTransform({{{cosine, -sine, 0, 0}, {sine, cosine, 0, 0}, {0, 0, 1, 0}}});
}

DxfTransform DxfTransform::from_entity(const DxfPoint& extrusion) {
    if (extrusion[0] == 0 && extrusion[1] == 0 && extrusion[2] >= 0) return {};
    const DxfPoint z = unit_of(extrusion);
    const bool near_z = std::abs(z[0]) < 1.0 / 64 && std::abs(z[1]) < 1.0 / 64;
    const DxfPoint x = unit_of(cross_of(near_z ? DxfPoint{0, 1, 0} : DxfPoint{0, 0, 1}, z)), y = cross_of(z, x);
    return DxfTransform({{{x[0], y[0], z[0], 0}, {x[1], y[1], z[1], 0}, {x[2], y[2], z[2], 0}}});
}

DxfTransform DxfTransform::operator*(const DxfTransform& first) const {
    Rows product{};
    for (std::size_t row = 0; row < 3; ++row) {
        for (std::size_t column = 0; column < 4; ++column) {
            for (std::size_t k = 0; k < 3; ++k) product[row][column] += rows_[row][k] * first.rows_[k][column];
        }
        product[row][3] += rows_[row][3];
    }
    return DxfTransform(product);
}

DxfPoint DxfTransform::operator*(const DxfPoint& point) const {
    DxfPoint moved{};
    for (std::size_t row = 0; row < 3; ++row)
        moved[row] = rows_[row][0] * point[0] + rows_[row][1] * point[1] + rows_[row][2] * point[2] + rows_[row][3];
    return moved;
}

}  // namespace octopair::io
