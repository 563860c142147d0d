#include "narrow_phase/depth_bounds.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>

#include "geometry/vector.hpp"

namespace octopair {

namespace {

/// Returns the greatest coordinate of the mesh along a direction.
double greatest_along(const Point3d& direction, const PosedMesh& mesh) {
    // The direction in the mesh's coordinates, so that vertices need not be posed one by one.
    const Point3d own = vector::turned_back(mesh.pose, direction);
    double most = -std::numeric_limits<double>::infinity();
    for (const Point3d& vertex : mesh.tree.vertices) most = std::max(most, vector::dot(own, vertex));
    return most + vector::dot(direction, vector::place(mesh.pose));
}

double greatest_along(const Point3d& direction, const BoxedSolid& solid) {
    const Point3d own = vector::turned_back(solid.box.pose, direction);
    return vector::dot(direction, vector::posed(solid.box.pose, support(solid.solid, own))) + solid.solid.radius;
}

}  // namespace

std::vector<Point3d> directions_out(std::span<const Contact> contacts) {
    constexpr std::size_t most = 16;
    std::vector<Point3d> directions;
    for (const Contact& contact : contacts.first(std::min(most, contacts.size()))) {
        const bool known = std::any_of(directions.begin(), directions.end(), [&](const Point3d& direction) {
            return vector::dot(direction, contact.normal) > 1 - 1e-9;
        });
        if (!known) directions.push_back(contact.normal);
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
        for (const double sense : {1.0, -1.0}) {
            Point3d direction = {};
            direction[axis] = sense;
            directions.push_back(direction);
        }
    }
    return directions;
}

double overlap_along(const Point3d& direction, const PosedMesh& a, const PosedMesh& b) {
    return greatest_along(direction, a) + greatest_along(vector::times(direction, -1), b);
}

double overlap_along(const Point3d& direction, const PosedMesh& a, const BoxedSolid& b) {
    return greatest_along(direction, a) + greatest_along(vector::times(direction, -1), b);
}

}  // namespace octopair
