#include "verification/shapes/mesh_verdict.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <variant>

#include "base/stop.hpp"
#include "parallel/team.hpp"
#include "verification/row_search.hpp"
#include "verification/shapes/enclosure.hpp"

namespace octopair::certificate {

namespace {

/// Maximum number of pairs of near triangles that are compared for a pair of objects.
constexpr std::uint64_t max_near_triangles = 200'000;

/// The part of the surface of an object that is near another object.
struct Surface {
    std::vector<Triangle> triangles;  ///< none if the object is a convex solid
    std::vector<ConvexBody> bodies;   ///< the triangles, or the solid
    std::vector<Box3d> boxes;         ///< of the bodies
};

/// Returns a float64 box that contains the points of `bounds`, each a point and the opposite corner.
Box3d box_around(const Vector& low, const Vector& high) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    const auto down = [](Real x) { return std::nextafter(double(x), -infinity); };
    const auto up = [](Real x) { return std::nextafter(double(x), infinity); };
    return {{down(low.x), down(low.y), down(low.z)}, {up(high.x), up(high.y), up(high.z)}};
}

Box3d box_of(const ConvexBody& body) {
    const Vector x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
    return box_around({-body.reach(-x), -body.reach(-y), -body.reach(-z)},
                      {body.reach(x), body.reach(y), body.reach(z)});
}

Box3d box_of(const Triangle& triangle) {
    const auto all = [&](Real Vector::*axis) {
        return std::minmax({triangle[0].*axis, triangle[1].*axis, triangle[2].*axis});
    };
    const auto [x, y, z] = std::tuple(all(&Vector::x), all(&Vector::y), all(&Vector::z));
    return box_around({x.first, y.first, z.first}, {x.second, y.second, z.second});
}

Box3d joined(const std::vector<Box3d>& boxes) {
    Box3d all = boxes.front();
    for (const Box3d& box : boxes) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            all.min[axis] = std::min(all.min[axis], box.min[axis]);
            all.max[axis] = std::max(all.max[axis], box.max[axis]);
        }
    }
    return all;
}

/// Returns all boxes of an object: of its triangles, or of the solid.
std::vector<Box3d> boxes_of(const JudgedObject& object, const std::vector<Triangle>& triangles) {
    if (triangles.empty()) return {box_of(ConvexBody(object.geometry.shape(), object.pose))};
    std::vector<Box3d> boxes;
    for (const Triangle& triangle : triangles) boxes.push_back(box_of(triangle));
    return boxes;
}

/// Returns the part of the surface that is at most `reach` away from a box.
Surface surface_near(const Box3d& place, const JudgedObject& object, const std::vector<Triangle>& triangles,
                     const std::vector<Box3d>& boxes, double reach) {
    Surface surface;
    if (triangles.empty()) {
        surface.bodies.emplace_back(object.geometry.shape(), object.pose);
        surface.boxes = boxes;
        return surface;
    }
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        bool is_near = true;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            is_near &= boxes[i].min[axis] <= place.max[axis] + reach && place.min[axis] <= boxes[i].max[axis] + reach;
        }
        if (!is_near) continue;
        surface.triangles.push_back(triangles[i]);
        surface.bodies.emplace_back(std::vector<Vector>(triangles[i].begin(), triangles[i].end()));
        surface.boxes.push_back(boxes[i]);
    }
    return surface;
}

/// Returns the sign of the volume of the tetrahedron a, b, c, d; 0 if rounding may have changed it.
int sign_of_volume(const Vector& a, const Vector& b, const Vector& c, const Vector& d) {
    const Vector u = b - a, v = c - a, w = d - a;
    const Real volume = dot(cross(u, v), w);
    const auto size = [](const Vector& x) { return std::abs(x.x) + std::abs(x.y) + std::abs(x.z); };
    const Real rounding = 64 * std::numeric_limits<Real>::epsilon() * size(u) * size(v) * size(w);
    return volume > rounding ? 1 : volume < -rounding ? -1 : 0;
}

/// Returns true if the segment from p to q certainly passes through the inside of the triangle.
bool crosses(const Vector& p, const Vector& q, const Triangle& t) {
    const int above = sign_of_volume(t[0], t[1], t[2], p), below = sign_of_volume(t[0], t[1], t[2], q);
    if (above == 0 || above != -below) return false;
    const int first = sign_of_volume(p, q, t[0], t[1]);
    return first != 0 && first == sign_of_volume(p, q, t[1], t[2]) && first == sign_of_volume(p, q, t[2], t[0]);
}

bool cross_each_other(const Triangle& a, const Triangle& b) {
    for (std::size_t i = 0; i < 3; ++i) {
        if (crosses(a[i], a[(i + 1) % 3], b) || crosses(b[i], b[(i + 1) % 3], a)) return true;
    }
    return false;
}

/// Bounds on the distance of two surfaces.
struct SurfaceBounds {
    Real lower = std::numeric_limits<Real>::infinity(), upper = std::numeric_limits<Real>::infinity();
    bool meet = false;     ///< two triangles certainly cross, or a triangle certainly reaches into the solid
    bool complete = true;  ///< false: there were too many near triangles
};

/// Returns whether two bodies of surfaces certainly meet. Requires: their distance is 0 within the accuracy.
bool certainly_meet(const Surface& a, std::size_t i, const Surface& b, std::size_t k, Real accuracy) {
    if (!a.triangles.empty() && !b.triangles.empty()) return cross_each_other(a.triangles[i], b.triangles[k]);
    return bound_depth(a.bodies[i], b.bodies[k], accuracy, accuracy).lower > accuracy;
}

SurfaceBounds bound_surfaces(const Surface& a, const Surface& b, Real reach, const Decision::Accuracy& accuracy,
                             const std::stop_token& stop) {
    SurfaceBounds bounds;
    if (a.bodies.empty() || b.bodies.empty()) return bounds;
    Team alone(1);
    const Objects first{std::span<const Box3d>(a.boxes)}, second{std::span<const Box3d>(b.boxes)};
    const RowSearch near({first, &second, double(reach)}, alone, stop);
    std::uint64_t compared = 0;
    std::vector<std::uint32_t> columns;
    for (std::uint32_t i = 0; i < near.rows(); ++i) {
        throw_if_stopped(stop);
        near.unordered_row(i, columns);
        compared += columns.size();
        bounds.complete = compared <= max_near_triangles;
        if (!bounds.complete) return bounds;
        for (const std::uint32_t k : columns) {
            const Real far_enough = std::min(bounds.upper, reach);
            const DistanceBounds two = bound_distance(a.bodies[i], b.bodies[k], accuracy.place / 16, far_enough);
            bounds.lower = std::min(bounds.lower, two.lower);
            bounds.upper = std::min(bounds.upper, two.upper);
            bounds.meet = bounds.meet || (two.upper <= accuracy.place && certainly_meet(a, i, b, k, accuracy.length));
        }
    }
    return bounds;
}

/// Judges objects whose surfaces are certainly apart.
std::string judge_apart(const JudgedObject& a, const JudgedObject& b, const std::vector<Triangle>& first,
                        const std::vector<Triangle>& second, const SurfaceBounds& bounds, const Decision& decision) {
    const Vector x{1, 0, 0};
    const auto points_of = [&](const JudgedObject& object, const std::vector<Triangle>& mesh) {
        if (!mesh.empty()) return points_of_parts(mesh);
        return std::vector{ConvexBody(object.geometry.shape(), object.pose).support(x)};
    };
    // No triangle of a mesh is in a solid.
    const Place outside{false, true, true};
    const Place a_in_b = second.empty() ? outside : place_in(second, points_of(a, first));
    const Place b_in_a = first.empty() ? outside : place_in(first, points_of(b, second));
    const bool are_apart = a_in_b.all_outside && b_in_a.all_outside;
    if (decision.says_meet()) {
        const bool not_contained = a_in_b.any_outside && b_in_a.any_outside;
        if (decision.found() == CollisionClass::contained && not_contained)
            return "it is contained, but a part of each object is outside the other one";
        if (are_apart)
            return "the objects do not meet: their surfaces are at least " + text_of(bounds.lower) + " apart";
        const bool is_touching = decision.found() == CollisionClass::touching && decision.rules.tolerance == 0;
        return is_touching ? "it is touching, but the surfaces are at least " + text_of(bounds.lower) + " apart" : "";
    }
    const bool may_be_shallow = decision.was_dropped() && decision.rules.min_depth;
    if ((a_in_b.any_inside || b_in_a.any_inside) && !may_be_shallow)
        return "a part of one object is inside the other one";
    return are_apart ? judge_distance(decision, bounds.lower, bounds.upper) : "";
}

/// Judges a mesh and a convex solid that meet, where one is said to contain the other: then it is the solid.
std::string judge_mesh_in_solid(const JudgedObject& a, const JudgedObject& b, const std::vector<Triangle>& first,
                                const std::vector<Triangle>& second, const std::vector<Vector>& directions,
                                const Decision& decision) {
    const JudgedObject& solid = first.empty() ? a : b;
    const ConvexBody outer(solid.geometry.shape(), solid.pose);
    for (const Triangle& triangle : first.empty() ? second : first) {
        const Real out = sticks_out(ConvexBody({triangle.begin(), triangle.end()}), outer, directions);
        if (out > decision.accuracy.place)
            return "it is contained, but the solid meets the mesh, and a triangle sticks out of it by " + text_of(out);
    }
    return {};
}

}  // namespace

std::vector<Triangle> triangles_of(const JudgedObject& object) {
    std::vector<Triangle> triangles;
    const auto* const mesh = std::get_if<shape::Mesh>(&object.geometry.shape());
    if (mesh == nullptr) return triangles;
    for (const auto& corners : mesh->triangles) {
        const auto corner = [&](std::size_t i) { return moved_vertex(object.pose, mesh->vertices[corners[i]]); };
        triangles.push_back({corner(0), corner(1), corner(2)});
    }
    return triangles;
}

PairVerdict judge_meshes(const JudgedObject& a, const JudgedObject& b, const std::vector<Vector>& directions,
                         const Decision& decision, const std::stop_token& stop) {
    const std::vector<Triangle> first = triangles_of(a), second = triangles_of(b);
    const std::vector<Box3d> first_boxes = boxes_of(a, first), second_boxes = boxes_of(b, second);
    const Real distance = decision.finding != nullptr ? Real(decision.finding->distance) : Real(0);
    if (!std::isfinite(distance)) return {"its distance is not finite"};
    const Real reach = std::max(decision.reach, distance) + decision.accuracy.length;
    const Surface near_first = surface_near(joined(second_boxes), a, first, first_boxes, double(reach));
    const Surface near_second = surface_near(joined(first_boxes), b, second, second_boxes, double(reach));
    const SurfaceBounds bounds = bound_surfaces(near_first, near_second, reach, decision.accuracy, stop);
    if (!bounds.complete) return {"", "pairs of meshes with more than 200,000 pairs of near triangles"};

    PairVerdict verdict{"",
                        decision.says_meet() && decision.rules.features ? "depths and contacts of meshes" : nullptr};
    const bool has_solid = first.empty() || second.empty();
    const bool may_be_shallow = decision.was_dropped() && decision.rules.min_depth;
    if (bounds.lower > decision.accuracy.place) {
        verdict.fault = judge_apart(a, b, first, second, bounds, decision);
    } else if (!bounds.meet) {
        const bool is_distance_known = decision.found() == CollisionClass::clearance;
        if (is_distance_known) verdict.fault = judge_distance(decision, bounds.lower, bounds.upper);
        verdict.not_checked = "meshes that touch within rounding";
    } else if (has_solid && decision.found() == CollisionClass::contained) {
        verdict.fault = judge_mesh_in_solid(a, b, first, second, directions, decision);
    } else if (!decision.says_meet() || decision.found() == CollisionClass::contained) {
        if (!may_be_shallow) verdict.fault = "their surfaces pass through each other";
    } else if (decision.found() == CollisionClass::touching && decision.rules.tolerance == 0 && !has_solid) {
        verdict.fault = "it is touching, but two triangles pass through each other";
    }
    return verdict;
}

}  // namespace octopair::certificate
