#include "narrow_phase/convex/local_convex.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "geometry/vector.hpp"

namespace octopair {
namespace {

Point3d place_of(const PosedConvex& convex) {
    if (convex.point()) return *convex.point();
    if (convex.triangle()) return convex.triangle()->front();
    const ConvexSolid& solid = *convex.solid();
    return solid.points.empty() ? vector::place(*convex.pose()) : vector::posed(*convex.pose(), solid.points.front());
}

double size_of(const PosedConvex& convex) {
    if (convex.point()) return 0;
    double most = 0;
    if (const auto* triangle = convex.triangle()) {
        for (std::size_t i = 1; i < 3; ++i) {
            const Point3d side = vector::minus((*triangle)[i], triangle->front());
            for (const double along : side) most = std::max(most, std::fabs(along));
        }
        return most;
    }
    const ConvexSolid& solid = *convex.solid();
    for (const auto& row : convex.pose()->rows) {
        double along = 0;
        for (std::size_t k = 0; k < 3; ++k) along += std::fabs(row[k]) * solid.largest[k];
        most = std::max(most, along);
    }
    return most + solid.radius;
}

/// Returns true if `a` is the first object of the pair: the larger object. Ties are broken by place, kind, core, pose, extents and
/// points. So the order of the arguments does not matter.
bool solid_comes_first(const PosedConvex& a, const PosedConvex& b) {
    const double size_a = size_of(a), size_b = size_of(b);
    if (size_a != size_b) return size_a > size_b;
    const Point3d place_a = place_of(a), place_b = place_of(b);
    if (place_a != place_b) return place_a < place_b;
    if (!a.solid() || !b.solid()) return a.solid() != nullptr;
    if (a.solid()->core != b.solid()->core) return a.solid()->core < b.solid()->core;
    if (a.pose()->rows != b.pose()->rows) return a.pose()->rows < b.pose()->rows;
    if (a.solid()->extents != b.solid()->extents) return a.solid()->extents < b.solid()->extents;
    return a.solid()->points <= b.solid()->points;
}

}  // namespace

LocalConvex::LocalConvex(const PosedConvex& convex, const Point3d& origin) : solid_(convex.solid()) {
    if (convex.point()) take(vector::minus(*convex.point(), origin));
    if (convex.triangle()) {
        for (const Point3d& corner : *convex.triangle()) take(vector::minus(corner, origin));
    }
    if (!solid_) return;
    pose_ = *convex.pose();
    for (std::size_t axis = 0; axis < 3; ++axis) pose_.rows[axis][3] -= origin[axis];
    for (const auto& row : pose_.rows) {
        double most = std::fabs(row[3]);
        for (std::size_t k = 0; k < 3; ++k) most += std::fabs(row[k]) * solid_->largest[k];
        magnitude_ = std::max(magnitude_, most);
    }
    if (solid_->core != ConvexSolid::Core::points || solid_->points.size() > points_.size()) return;
    for (const Point3d& point : solid_->points) take(vector::posed(pose_, point));
}

void LocalConvex::take(const Point3d& point) {
    points_[count_++] = point;
    for (const double at : point) magnitude_ = std::max(magnitude_, std::fabs(at));
}

Point3d LocalConvex::support(const Point3d& direction) const {
    if (count_ == 0) return vector::posed(pose_, octopair::support(*solid_, vector::turned_back(pose_, direction)));
    std::size_t best = 0;
    double most = vector::dot(points_[0], direction);
    for (std::size_t i = 1; i < count_; ++i) {
        const double along = vector::dot(points_[i], direction);
        if (along > most) most = along, best = i;
    }
    return points_[best];
}

std::vector<Point3d> LocalConvex::all_points() const {
    if (count_ > 0) return {points_.begin(), points_.begin() + std::ptrdiff_t(count_)};
    std::vector<Point3d> points = solid_->points;
    for (Point3d& point : points) point = vector::posed(pose_, point);
    return points;
}

Point3d LocalConvex::middle() const {
    if (count_ == 0 && solid_->points.empty()) return vector::place(pose_);
    Point3d sum = {};
    const std::span<const Point3d> points = count_ > 0 ? this->points() : std::span<const Point3d>(solid_->points);
    for (const Point3d& point : points) sum = vector::plus(sum, vector::times(point, 1 / double(points.size())));
    return count_ > 0 ? sum : vector::posed(pose_, sum);
}

LocalConvexPair::LocalConvexPair(const PosedConvex& a, const PosedConvex& b)
    : swapped_(!solid_comes_first(a, b)),
      origin_(place_of(swapped_ ? a : b)),
      a_(swapped_ ? b : a, origin_),
      b_(swapped_ ? a : b, origin_),
      size_(a_.magnitude() + b_.magnitude() + radii()) {}

double LocalConvexPair::slack() const {
    // A support errs by a few roundings of each coordinate; so do its product with a direction and the radii.
    constexpr double epsilon = std::numeric_limits<double>::epsilon();
    return 32 * epsilon * size_ + std::numeric_limits<double>::min();
}

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

/// A scaled copy of a convex object. It owns the solid, the pose and the points that `convex` borrows.
struct ScaledPair::Scaled {
    ConvexSolid solid;
    Pose pose;
    std::array<Point3d, 3> triangle = {};
    Point3d point = {};
    PosedConvex convex;  // borrows the other members

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
