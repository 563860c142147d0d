#include "narrow_phase/convex/scaled_pair.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace octopair {

namespace {

Point3d scaled(const Point3d& point, int exponent) {
    return {std::ldexp(point[0], exponent), std::ldexp(point[1], exponent), std::ldexp(point[2], exponent)};
}

ConvexSolid scaled(ConvexSolid solid, int exponent) {
    solid.extents = scaled(solid.extents, exponent);
    solid.largest = scaled(solid.largest, exponent);
    solid.radius = std::ldexp(solid.radius, exponent);
    for (Point3d& point : solid.points) point = scaled(point, exponent);
    return solid;
}

Pose scaled(Pose pose, int exponent) {
    for (auto& row : pose.rows) row[3] = std::ldexp(row[3], exponent);
    return pose;
}

std::array<Point3d, 3> scaled(const std::array<Point3d, 3>& triangle, int exponent) {
    return {scaled(triangle[0], exponent), scaled(triangle[1], exponent), scaled(triangle[2], exponent)};
}

int exponent_of(double size) { return std::ilogb(std::min(size, std::numeric_limits<double>::max())); }

}  // namespace

/// A convex object that owns its numbers.
struct ScaledPair::Scaled {
    ConvexSolid solid;
    Pose pose;
    std::array<Point3d, 3> triangle = {};
    Point3d point = {};
    PosedConvex convex;  // borrows one of the others

    Scaled(const PosedConvex& whole, int exponent) : convex(point) {
        if (whole.point()) {
            point = scaled(*whole.point(), -exponent);
        } else if (whole.triangle()) {
            triangle = scaled(*whole.triangle(), -exponent);
            convex = PosedConvex(triangle);
        } else {
            solid = scaled(*whole.solid(), -exponent);
            pose = scaled(*whole.pose(), -exponent);
            convex = PosedConvex(solid, pose);
        }
    }
    Scaled(const Scaled&) = delete;
    Scaled& operator=(const Scaled&) = delete;
};

ScaledPair::ScaledPair(const PosedConvex& a, const PosedConvex& b, const LocalConvexPair& pair)
    : exponent_(exponent_of(pair.size())),
      a_(std::make_unique<const Scaled>(a, exponent_)),
      b_(std::make_unique<const Scaled>(b, exponent_)) {}
ScaledPair::~ScaledPair() = default;

const PosedConvex& ScaledPair::a() const { return a_->convex; }
const PosedConvex& ScaledPair::b() const { return b_->convex; }

double ScaledPair::to_units(double length) const { return std::ldexp(length, -exponent_); }
double ScaledPair::from_units(double length) const { return std::ldexp(length, exponent_); }
Point3d ScaledPair::from_units(const Point3d& point) const { return scaled(point, exponent_); }

}  // namespace octopair
