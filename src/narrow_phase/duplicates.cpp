#include "narrow_phase/duplicates.hpp"

#include <cstddef>
#include <variant>
#include <vector>

#include "geometry/vector.hpp"

namespace octopair {

namespace {

bool are_near(const Point3d& a, const Point3d& b, double tolerance) {
    return a == b || vector::length(vector::minus(a, b)) <= tolerance;
}

/// Points in the shape's own coordinates, and the pose that places them.
struct PosedPoints {
    const std::vector<Point3d>& points;
    const Pose& pose;
};

bool are_near(const PosedPoints& a, const PosedPoints& b, double tolerance) {
    if (a.points.size() != b.points.size()) return false;
    for (std::size_t i = 0; i < a.points.size(); ++i) {
        if (!are_near(vector::posed(a.pose, a.points[i]), vector::posed(b.pose, b.points[i]), tolerance)) return false;
    }
    return true;
}

std::vector<Point3d> corners_of(const Box3d& box) {
    std::vector<Point3d> corners;
    for (unsigned i = 0; i < 8; ++i) {
        Point3d corner;
        for (unsigned axis = 0; axis < 3; ++axis) corner[axis] = (i >> axis & 1u) != 0 ? box.max[axis] : box.min[axis];
        corners.push_back(corner);
    }
    return corners;
}

bool same_parameters(const ConvexSolid& a, const ConvexSolid& b) {
    return a.core == b.core && a.extents == b.extents && a.radius == b.radius && a.points.size() == b.points.size();
}

}  // namespace

bool are_duplicates(const PosedObject& a, const PosedObject& b, double tolerance) {
    const shape::Any &first = a.geometry.shape, &second = b.geometry.shape;
    if (first.index() != second.index() || std::holds_alternative<shape::Plane>(first)) return false;
    if (const auto* mesh = std::get_if<shape::Mesh>(&first)) {
        const auto& other = std::get<shape::Mesh>(second);
        // Places first: those of different objects differ at the first vertex.
        return are_near(PosedPoints{mesh->vertices, a.pose}, {other.vertices, b.pose}, tolerance) &&
               (mesh == &other || mesh->triangles == other.triangles);
    }
    if (!same_parameters(a.geometry.convex, b.geometry.convex)) return false;
    if (std::holds_alternative<shape::ConvexHull>(first)) {
        return are_near(PosedPoints{a.geometry.convex.points, a.pose}, {b.geometry.convex.points, b.pose}, tolerance);
    }
    return are_near(PosedPoints{corners_of(a.geometry.bounds.box), a.pose}, {corners_of(b.geometry.bounds.box), b.pose},
                    tolerance);
}

}  // namespace octopair
