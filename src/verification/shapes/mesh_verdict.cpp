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

/// One of the two objects.
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
        return is_solid() ? std::vector{solid().support({1, 0, 0})} : certificate::points_of_parts(triangles);
    }
    /// Returns where the other object is. Requires: the surfaces do not meet.
    Place place_of(const Side& other) const {
        if (is_solid()) return {false, true, true};  // otherwise a triangle would be in the solid
        return place_in(triangles, other.points_of_parts());
    }

    const JudgedObject& object;
    std::vector<Triangle> triangles;
    std::vector<Box3d> boxes;  ///< of the triangles, or of the solid
};

/// The part of the surface of an object that is near another object.
struct Surface {
    /// Takes the part that is at most `reach` away from the boxes of `other`.
    Surface(const Side& side, const Side& other, double reach) {
        if (side.is_solid()) {
            bodies.push_back(side.solid());
            boxes = side.boxes;
            return;
        }
        const Box3d place = joined(other.boxes);
        for (std::size_t i = 0; i < side.triangles.size(); ++i) {
            const Box3d& box = side.boxes[i];
            bool is_near = true;
            for (std::size_t axis = 0; axis < 3; ++axis)
                is_near &= box.min[axis] <= place.max[axis] + reach && place.min[axis] <= box.max[axis] + reach;
            if (!is_near) continue;
            const Triangle& triangle = side.triangles[i];
            triangles.push_back(triangle);
            bodies.emplace_back(std::vector<Vector>(triangle.begin(), triangle.end()));
            boxes.push_back(box);
        }
    }

    std::vector<Triangle> triangles;  ///< none of a solid
    std::vector<ConvexBody> bodies;   ///< the triangles, or the solid
    std::vector<Box3d> boxes;         ///< of the bodies
};

/// Bounds on the distance of two surfaces.
struct SurfaceBounds {
    Real lower = std::numeric_limits<Real>::infinity(), upper = std::numeric_limits<Real>::infinity();
    bool meet = false;     ///< two triangles certainly cross, or a triangle certainly reaches into the solid
    bool complete = true;  ///< false: there were too many near triangles
};

class MeshVerdict {
public:
    MeshVerdict(const JudgedPair& pair, const Decision& decision, const std::stop_token& stop)
        : pair_(pair), first_(pair.a), second_(pair.b), decision_(decision), stop_(stop) {}

    PairVerdict judge() const {
        const Real distance = decision_.finding != nullptr ? Real(decision_.finding->distance) : Real(0);
        if (!std::isfinite(distance)) return {"its distance is not finite"};
        const SurfaceBounds bounds = bound_surfaces(std::max(decision_.reach, distance) + decision_.accuracy.length);
        if (!bounds.complete) return {"", "pairs of meshes with more than 200,000 pairs of near triangles"};
        if (bounds.lower > decision_.accuracy.place) return {judge_apart(bounds), not_checked()};
        if (bounds.meet) return {judge_meeting(), not_checked()};
        const bool is_distance_known = decision_.found() == CollisionClass::clearance;
        return {is_distance_known ? judge_distance(decision_, bounds.lower, bounds.upper) : "",
                "meshes that touch within rounding"};
    }

private:
    const char* not_checked() const {
        return decision_.says_meet() && decision_.rules.features ? "depths and contacts of meshes" : nullptr;
    }
    bool may_be_shallow() const { return decision_.was_dropped() && decision_.rules.min_depth; }
    bool is_touching() const { return decision_.found() == CollisionClass::touching && decision_.rules.tolerance == 0; }

    SurfaceBounds bound_surfaces(Real reach) const {
        SurfaceBounds bounds;
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
                const DistanceBounds two = bound_distance(a.bodies[i], b.bodies[k], decision_.accuracy.place / 16,
                                                          std::min(bounds.upper, reach));
                bounds.lower = std::min(bounds.lower, two.lower);
                bounds.upper = std::min(bounds.upper, two.upper);
                if (bounds.meet || two.upper > decision_.accuracy.place) continue;
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
    std::string judge_apart(const SurfaceBounds& bounds) const {
        const Place a = second_.place_of(first_), b = first_.place_of(second_);
        const bool are_apart = a.all_outside && b.all_outside;
        if (decision_.says_meet()) {
            if (decision_.found() == CollisionClass::contained && a.any_outside && b.any_outside)
                return "it is contained, but a part of each object is outside the other one";
            if (are_apart)
                return "the objects do not meet: their surfaces are at least " + text_of(bounds.lower) + " apart";
            if (!is_touching()) return {};
            return "it is touching, but the surfaces are at least " + text_of(bounds.lower) + " apart";
        }
        if ((a.any_inside || b.any_inside) && !may_be_shallow()) return "a part of one object is inside the other one";
        return are_apart ? judge_distance(decision_, bounds.lower, bounds.upper) : "";
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

    /// Judges a mesh and a solid that meet, of which one is said to contain the other: then it is the solid.
    std::string judge_mesh_in_solid() const {
        const Side &mesh = first_.is_solid() ? second_ : first_, &solid = first_.is_solid() ? first_ : second_;
        const ConvexBody outer = solid.solid();
        const std::vector<Vector> directions = compared_directions(pair_.a.pose, pair_.b.pose);
        for (const Triangle& triangle : mesh.triangles) {
            const Real out = sticks_out(ConvexBody({triangle.begin(), triangle.end()}), outer, directions);
            if (out > decision_.accuracy.place)
                return "it is contained, but the solid meets the mesh, and a triangle sticks out of it by " +
                       text_of(out);
        }
        return {};
    }

    const JudgedPair& pair_;
    Side first_, second_;
    const Decision& decision_;
    const std::stop_token& stop_;
};

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

PairVerdict judge_meshes(const JudgedPair& pair, const Decision& decision, const std::stop_token& stop) {
    return MeshVerdict(pair, decision, stop).judge();
}

}  // namespace octopair::certificate
