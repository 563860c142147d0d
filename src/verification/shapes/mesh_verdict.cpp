// Verdicts on pairs with a mesh: bounds on the distance of its triangles, signs of volumes, and winding numbers.
#include "verification/shapes/verdicts.hpp"

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

/// Returns a float64 box that contains two opposite corners.
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

/// One of the two objects of a pair: a mesh with its triangles in the world, or a convex solid.
struct Side {
    explicit Side(const JudgedObject& judged) : object(judged), triangles(triangles_of(judged)) {
        for (const Triangle& triangle : triangles) boxes.push_back(box_of(triangle));
        if (is_solid()) boxes.push_back(box_of(solid()));
    }
    /// Returns whether the object is a convex solid, not a mesh.
    bool is_solid() const { return triangles.empty(); }
    ConvexBody solid() const { return {object.geometry.shape(), object.pose}; }
    /// Returns one point of each connected part.
    std::vector<Vector> points_of_parts() const {
        if (is_solid()) return {solid().support({1, 0, 0})};
        std::vector<Vector> points;
        for (const std::size_t triangle : parts_of(local_triangles_of(object)))
            points.push_back(triangles[triangle][0]);
        return points;
    }
    /// Returns whether the parts of `other` are inside or outside this object. Requires: the surfaces do not meet.
    Enclosure enclosure_of(const Side& other) const {
        // `other` is a mesh. A triangle of it inside this solid would meet the solid, so all parts are outside.
        if (is_solid()) return {.is_known = true, .any_outside = true, .all_outside = true};
        if (!is_closed(local_triangles_of(object))) return {};
        return enclosure_in(triangles, other.points_of_parts());
    }

    /// Returns a lower bound on the distance of a point from the surface or the solid.
    Real least_distance(const Point3d& point, Real limit) const {
        return is_solid() ? certificate::least_distance(point, solid(), limit)
                          : certificate::least_distance(point, triangles, limit);
    }

    const JudgedObject& object;
    std::vector<Triangle> triangles;
    std::vector<Box3d> boxes;  ///< boxes of the triangles, or box of the solid
};

/// The part of the surface of an object that is near another object.
struct Surface {
    /// Takes the solid, or the triangles whose boxes are, on each axis, at most `reach` away from the common box of `other`.
    Surface(const Side& side, const Side& other, double reach) {
        if (side.is_solid()) {
            bodies.push_back(side.solid());
            boxes = side.boxes;
            return;
        }
        const Box3d bounds = joined(other.boxes);
        for (std::size_t i = 0; i < side.triangles.size(); ++i) {
            const Box3d& box = side.boxes[i];
            bool is_near = true;
            for (std::size_t axis = 0; axis < 3; ++axis)
                is_near &= box.min[axis] <= bounds.max[axis] + reach && bounds.min[axis] <= box.max[axis] + reach;
            if (!is_near) continue;
            const Triangle& triangle = side.triangles[i];
            triangles.push_back(triangle);
            bodies.emplace_back(std::vector<Vector>(triangle.begin(), triangle.end()));
            boxes.push_back(box);
        }
    }

    std::vector<Triangle> triangles;  ///< empty for a solid
    std::vector<ConvexBody> bodies;   ///< the triangles, or the solid
    std::vector<Box3d> boxes;         ///< boxes of the bodies
};

/// Bounds on the distance of two surfaces.
struct SurfaceBounds {
    Real lower = 0, upper = std::numeric_limits<Real>::infinity();
    bool meet = false;     ///< two triangles certainly cross, or a triangle certainly reaches into the solid
    bool complete = true;  ///< false: there were too many near triangles
};

class MeshVerdict {
public:
    MeshVerdict(const JudgedPair& pair, const Decision& decision, const std::stop_token& stop)
        : pair_(pair), first_(pair.a), second_(pair.b), decision_(decision), stop_(stop) {}

    PairVerdict judge() const {
        const Real distance = decision_.finding != nullptr ? Real(decision_.finding->distance) : Real(0);
        const SurfaceBounds bounds = bound_surfaces(std::max(decision_.reach, distance) + decision_.accuracy.length);
        if (!bounds.complete) return {"", "pairs of meshes with more than 200,000 pairs of near triangles"};
        if (bounds.lower > decision_.accuracy.position) return judge_apart(bounds);
        if (bounds.meet) return {judge_meeting(), features_not_checked()};
        return {decision_.says_meet() ? "" : judge_clearance(bounds), "meshes that touch within rounding"};
    }

private:
    /// Returns a text for users that names the properties of the features that no certificate judges; null: all were judged.
    const char* features_not_checked() const {
        const bool has_features = decision_.rules.features && (decision_.says_meet() || may_be_shallow());
        return has_features ? "depths and contacts of meshes" : nullptr;
    }
    bool may_be_shallow() const { return decision_.was_dropped() && decision_.rules.min_depth; }
    bool is_touching() const { return decision_.found() == CollisionClass::touching && decision_.rules.tolerance == 0; }

    /// Bounds the distance of the surfaces; the lower bound is at most `reach`.
    SurfaceBounds bound_surfaces(Real reach) const {
        SurfaceBounds bounds;
        bounds.lower = reach;  // all triangles that are not compared are at least this far apart
        const Surface a(first_, second_, double(reach)), b(second_, first_, double(reach));
        if (a.bodies.empty() || b.bodies.empty()) return bounds;
        Team alone(1);
        const Objects first{std::span<const Box3d>(a.boxes)}, second{std::span<const Box3d>(b.boxes)};
        const RowSearch near({first, &second, double(reach)}, alone, stop_);
        std::uint64_t compared = 0;
        std::vector<std::uint32_t> columns;
        for (std::uint32_t i = 0; i < near.rows(); ++i) {
            throw_if_stopped(stop_);
            near.unordered_row(i, columns);
            compared += columns.size();
            bounds.complete = compared <= max_near_triangles;
            if (!bounds.complete) return bounds;
            for (const std::uint32_t k : columns) {
                const DistanceBounds two = bound_distance(a.bodies[i], b.bodies[k], decision_.accuracy.position / 16,
                                                          std::min(bounds.upper, reach));
                bounds.lower = std::min(bounds.lower, two.lower);
                bounds.upper = std::min(bounds.upper, two.upper);
                if (bounds.meet || two.upper > decision_.accuracy.position) continue;
                const bool has_solid = first_.is_solid() || second_.is_solid();
                bounds.meet =
                    has_solid ? overlap(a.bodies[i], b.bodies[k]) : cross_each_other(a.triangles[i], b.triangles[k]);
            }
        }
        return bounds;
    }

    /// Returns whether a triangle and a solid certainly overlap.
    bool overlap(const ConvexBody& a, const ConvexBody& b) const {
        const Real accuracy = decision_.accuracy.length;
        return bound_depth(a, b, accuracy, accuracy).lower > accuracy;
    }

    /// Judges objects whose surfaces are certainly apart.
    PairVerdict judge_apart(const SurfaceBounds& bounds) const {
        const Enclosure a = second_.enclosure_of(first_), b = first_.enclosure_of(second_);
        const bool are_apart = a.all_outside && b.all_outside;
        const std::string gap = "their surfaces are at least " + text_of(bounds.lower) + " apart";
        if (!decision_.says_meet()) {
            if ((a.any_inside || b.any_inside) && !may_be_shallow())
                return {"a part of one object is inside the other one"};
            // The pair may have been dropped because of the depth of an object within the other one, which no certificate judges.
            if (may_be_shallow() && !are_apart) return {"", features_not_checked()};
            return {judge_clearance(bounds), features_not_checked()};
        }
        if (decision_.found() == CollisionClass::contained && a.any_outside && b.any_outside)
            return {"it is contained, but a part of each object is outside the other one"};
        if (are_apart) return {"the objects do not meet: " + gap};
        if (is_touching()) return {"it is touching, but " + gap};
        const bool is_known = a.is_known && b.is_known;
        return {"", is_known ? features_not_checked() : "containment in open meshes and in those of many parts"};
    }

    /// Judges objects that do not meet, or that were dropped.
    std::string judge_clearance(const SurfaceBounds& bounds) const {
        std::string fault = judge_distance(decision_, bounds.lower, bounds.upper);
        if (!fault.empty() || decision_.was_dropped()) return fault;
        const auto& [first, second] = decision_.finding->nearest;
        const Real limit = decision_.accuracy.length;
        const Real outside = std::max(first_.least_distance(first, limit), second_.least_distance(second, limit));
        if (outside > limit) return "a nearest point is at least " + text_of(outside) + " outside its object";
        return judge_nearest_points(decision_);
    }

    /// Judges objects whose surfaces certainly meet.
    std::string judge_meeting() const {
        const bool has_solid = first_.is_solid() || second_.is_solid();
        const bool is_contained = decision_.found() == CollisionClass::contained;
        if (is_contained && has_solid) return judge_mesh_in_solid();
        if ((is_contained || !decision_.says_meet()) && !may_be_shallow())
            return "their surfaces pass through each other";
        return is_touching() && !has_solid ? "it is touching, but two triangles pass through each other" : "";
    }

    /// Judges a mesh and a solid that meet and whose class is `contained`. A mesh cannot contain a solid that its surface meets, so
    /// the mesh must be inside the solid.
    std::string judge_mesh_in_solid() const {
        const Side &mesh = first_.is_solid() ? second_ : first_, &solid = first_.is_solid() ? first_ : second_;
        const ConvexBody outer = solid.solid();
        const std::vector<Vector> directions = compared_directions(pair_.a.pose, pair_.b.pose);
        for (const Triangle& triangle : mesh.triangles) {
            const Real outside = sticks_out(ConvexBody({triangle.begin(), triangle.end()}), outer, directions);
            if (outside > decision_.accuracy.position)
                return "it is contained, but the solid meets the mesh, and a triangle sticks out of it by at least " +
                       text_of(outside);
        }
        return {};
    }

    const JudgedPair& pair_;
    Side first_, second_;
    const Decision& decision_;
    const std::stop_token& stop_;
};

/// Returns the triangles of a mesh, each vertex replaced by moved(vertex). Returns no triangles if the object is not a mesh.
template <typename Move>
std::vector<Triangle> moved_triangles(const JudgedObject& object, Move&& moved) {
    std::vector<Triangle> triangles;
    const auto* const mesh = std::get_if<shape::Mesh>(&object.geometry.shape());
    if (mesh == nullptr) return triangles;
    for (const auto& corners : mesh->triangles) {
        const auto corner = [&](std::size_t i) { return moved(mesh->vertices[corners[i]]); };
        triangles.push_back({corner(0), corner(1), corner(2)});
    }
    return triangles;
}

}  // namespace

std::vector<Triangle> triangles_of(const JudgedObject& object) {
    return moved_triangles(object, [&](const Point3d& vertex) { return moved_vertex(object.pose, vertex); });
}

std::vector<Triangle> local_triangles_of(const JudgedObject& object) { return moved_triangles(object, vector_of); }

Real least_distance(const Point3d& point, const std::vector<Triangle>& triangles, Real limit) {
    const Vector position = vector_of(point);
    Real least = std::numeric_limits<Real>::infinity();
    for (const Triangle& triangle : triangles) {
        const Box3d box = box_of(triangle);
        Real apart = 0;  // largest distance of the point from the box along an axis
        for (const auto& [at, axis] : {std::pair(position.x, 0), {position.y, 1}, {position.z, 2}})
            apart = std::max({apart, box.min[axis] - at, at - box.max[axis]});
        if (apart > limit) {
            least = std::min(least, apart);
            continue;
        }
        least = std::min(least, least_distance(point, ConvexBody({triangle.begin(), triangle.end()}), limit));
    }
    return least;
}

PairVerdict judge_meshes(const JudgedPair& pair, const Decision& decision, const std::stop_token& stop) {
    return MeshVerdict(pair, decision, stop).judge();
}

}  // namespace octopair::certificate
