// Distance: the method of Gilbert, Johnson and Keerthi on the difference of the bodies. The nearest point of a simplex is found by trying
// all its subsets, which is slow but has no special cases.
// Depth: a polytope within the difference of the bodies, which contains the origin. Each step moves its face that is nearest to the origin
// outward, to the boundary of the difference (expanding polytope algorithm).
#include "verification/shapes/distance_bounds.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <vector>

namespace octopair::certificate {

namespace {

constexpr int max_steps = 256;
constexpr int max_expansions = 256;

/// A point of the difference of two bodies, with the points of the bodies.
struct Difference {
    Vector first, second;
    Vector point() const { return first - second; }
};

/// A point of a simplex: its corners and their weights, which are positive and add up to 1.
struct Weighted {
    std::vector<Difference> corners;
    std::vector<Real> weights;

    Vector mean(Vector Difference::*member) const {
        Vector sum;
        for (std::size_t i = 0; i < corners.size(); ++i) sum = sum + corners[i].*member * weights[i];
        return sum;
    }
};

/// Solves a system of up to three linear equations by elimination with pivots. Returns nothing if it is singular.
std::optional<std::array<Real, 3>> solve(std::array<std::array<Real, 4>, 3> rows, std::size_t size) {
    for (std::size_t i = 0; i < size; ++i) {
        std::size_t pivot = i;
        for (std::size_t k = i; k < size; ++k) {
            if (std::abs(rows[k][i]) > std::abs(rows[pivot][i])) pivot = k;
        }
        if (rows[pivot][i] == 0) return {};
        std::swap(rows[i], rows[pivot]);
        for (std::size_t k = 0; k < size; ++k) {
            if (k == i) continue;
            const Real factor = rows[k][i] / rows[i][i];
            for (std::size_t j = i; j < size; ++j) rows[k][j] -= factor * rows[i][j];
            rows[k][3] -= factor * rows[i][3];
        }
    }
    std::array<Real, 3> solution{};
    for (std::size_t i = 0; i < size; ++i) solution[i] = rows[i][3] / rows[i][i];
    return solution;
}

/// Takes the plane, line or point through all corners. Returns its point that is nearest to the origin; nothing if this point is not
/// between the corners.
std::optional<Weighted> nearest_inside(const std::vector<Difference>& corners) {
    const Vector base = corners.front().point();
    std::array<std::array<Real, 4>, 3> rows{};
    for (std::size_t i = 1; i < corners.size(); ++i) {
        const Vector edge = corners[i].point() - base;
        for (std::size_t k = 1; k < corners.size(); ++k) rows[i - 1][k - 1] = dot(edge, corners[k].point() - base);
        rows[i - 1][3] = -dot(edge, base);
    }
    const auto solution = solve(rows, corners.size() - 1);
    if (!solution) return {};
    Weighted nearest{corners, std::vector<Real>(corners.size())};
    nearest.weights[0] = 1;
    for (std::size_t i = 1; i < corners.size(); ++i) {
        nearest.weights[i] = (*solution)[i - 1];
        nearest.weights[0] -= (*solution)[i - 1];
    }
    const bool inside = std::ranges::all_of(nearest.weights, [](Real weight) { return weight >= 0; });
    return inside ? std::optional(nearest) : std::nullopt;
}

/// Returns the point of the hull of the corners that is nearest to the origin.
Weighted nearest_of_simplex(const std::vector<Difference>& corners) {
    Weighted best;
    Real least = std::numeric_limits<Real>::infinity();
    for (unsigned subset = 1; subset < 1u << corners.size(); ++subset) {
        std::vector<Difference> chosen;
        for (std::size_t i = 0; i < corners.size(); ++i) {
            if ((subset >> i & 1) != 0) chosen.push_back(corners[i]);
        }
        const auto nearest = nearest_inside(chosen);
        if (!nearest) continue;
        const Real distance = length(nearest->mean(&Difference::first) - nearest->mean(&Difference::second));
        // Prefers fewer corners if two points are equally near.
        if (distance < least || (distance == least && nearest->corners.size() < best.corners.size())) {
            least = distance;
            best = *nearest;
        }
    }
    return best;
}

Difference farthest_difference(const ConvexBody& first, const ConvexBody& second, const Vector& direction) {
    return {first.support(direction), second.support(-direction)};
}

/// A face of a polytope around the origin, counterclockwise seen from outside.
struct Face {
    std::array<Vector, 3> corners;
    Vector normal;  ///< unit vector outward
    Real distance;  ///< distance of its plane from the origin, > 0
};

/// Makes the face a, b, c. Returns nothing if the origin is not certainly behind the face.
std::optional<Face> make_face(const Vector& a, const Vector& b, const Vector& c) {
    const Vector normal = cross(b - a, c - a);
    const Real size = length(normal);
    if (!(size > 0)) return {};
    const Face face{{a, b, c}, normal * (1 / size), dot(normal, a) / size};
    return face.distance > 0 ? std::optional(face) : std::nullopt;
}

bool is_equal(const Vector& a, const Vector& b) { return a.x == b.x && a.y == b.y && a.z == b.z; }

using Corners = std::array<Vector, 3>;

/// Turns the triangles of a closed surface so that the origin is behind each of them. Returns none if it is not certainly inside.
std::vector<Face> faces_of(const std::vector<Corners>& triangles) {
    std::vector<Face> faces;
    for (const auto& [a, b, c] : triangles) {
        auto face = make_face(a, b, c);
        if (!face) face = make_face(a, c, b);
        if (!face) return {};
        faces.push_back(*face);
    }
    // If the origin is outside, two neighbours have different orientations. Then both have their common edge in the same direction.
    std::vector<std::array<Vector, 2>> edges;
    for (const Face& face : faces) {
        for (std::size_t i = 0; i < 3; ++i) edges.push_back({face.corners[i], face.corners[(i + 1) % 3]});
    }
    const auto is_turned_alike = [&](const std::array<Vector, 2>& edge) {
        return std::ranges::count_if(edges, [&](const auto& other) {
                   return is_equal(other[0], edge[1]) && is_equal(other[1], edge[0]);
               }) == 1;
    };
    return std::ranges::all_of(edges, is_turned_alike) ? faces : std::vector<Face>();
}

/// Returns the surface of a double pyramid.
std::vector<Corners> double_pyramid(const Corners& equator, const std::array<Vector, 2>& tips) {
    std::vector<Corners> triangles;
    for (std::size_t i = 0; i < 3; ++i) {
        for (const Vector& tip : tips) triangles.push_back({equator[i], equator[(i + 1) % 3], tip});
    }
    return triangles;
}

/// Returns a unit vector perpendicular to `direction`.
Vector perpendicular_to(const Vector& direction) {
    const Vector axis = std::abs(direction.x) > std::abs(direction.y) ? Vector{0, 1, 0} : Vector{1, 0, 0};
    const Vector across = cross(direction, axis);
    return across * (1 / length(across));
}

/// Returns a polytope within the difference of the bodies that has the origin inside; no faces if no such polytope is found. `simplex`:
/// points of the difference whose hull contains the origin. It may be flat, for example for symmetric bodies.
std::vector<Face> polytope_around(const ConvexBody& first, const ConvexBody& second,
                                  const std::vector<Difference>& simplex) {
    const auto farthest = [&](const Vector& direction) {
        return first.support(direction) - second.support(-direction);
    };
    std::vector<Vector> p;
    p.reserve(simplex.size());
    for (const Difference& corner : simplex) p.push_back(corner.point());
    if (p.size() == 4)
        return faces_of({{p[0], p[1], p[2]}, {p[0], p[2], p[3]}, {p[0], p[3], p[1]}, {p[1], p[3], p[2]}});
    if (p.size() == 3) {
        const Vector normal = cross(p[1] - p[0], p[2] - p[0]);
        return faces_of(double_pyramid({p[0], p[1], p[2]}, {farthest(normal), farthest(-normal)}));
    }
    if (p.size() < 2) return {};
    const Vector along = p[1] - p[0], u = perpendicular_to(along), v = cross(along * (1 / length(along)), u);
    const Real half = 0.5L, height = std::sqrt(3.0L) / 2;
    return faces_of(double_pyramid({farthest(u), farthest(v * height - u * half), farthest(-(v * height) - u * half)},
                                   {p[0], p[1]}));
}

/// Replaces the faces that `point` sees by faces from their outline to `point`. Returns false if rounding prevents that.
bool expand(std::vector<Face>& faces, const Vector& point) {
    std::vector<std::array<Vector, 2>> outline;
    const auto remove_or_add = [&](const Vector& from, const Vector& to) {
        const auto opposite = std::ranges::find_if(
            outline, [&](const auto& edge) { return is_equal(edge[0], to) && is_equal(edge[1], from); });
        opposite != outline.end() ? void(outline.erase(opposite)) : outline.push_back({from, to});
    };
    std::erase_if(faces, [&](const Face& face) {
        if (dot(face.normal, point) <= face.distance) return false;
        for (std::size_t i = 0; i < 3; ++i) remove_or_add(face.corners[i], face.corners[(i + 1) % 3]);
        return true;
    });
    for (const auto& [from, to] : outline) {
        const auto face = make_face(from, to, point);
        if (!face) return false;
        faces.push_back(*face);
    }
    return !outline.empty();
}

/// When a search for bounds ends: they agree to `accuracy`, or the lower one is beyond `enough`.
struct Goal {
    Real accuracy, enough;
};

/// Bounds the distance. `simplex` gets the points of the difference whose hull is nearest to the origin, or contains it.
DistanceBounds bound_distance(const ConvexBody& first, const ConvexBody& second, const Goal& goal,
                              std::vector<Difference>& simplex) {
    // The first direction is not along an axis, because symmetric bodies would then yield flat simplices.
    Weighted nearest{{farthest_difference(first, second, {-0.48L, 0.6L, 0.64L})}, {1}};
    DistanceBounds bounds;
    bounds.upper = std::numeric_limits<Real>::infinity();
    for (int step = 0; step < max_steps; ++step) {
        const std::array<Vector, 2> points = {nearest.mean(&Difference::first), nearest.mean(&Difference::second)};
        const Vector v = points[0] - points[1];
        const Real distance = length(v);
        if (distance >= bounds.upper) break;  // rounding prevents further progress
        bounds.upper = distance;
        bounds.points = points;
        if (distance <= goal.accuracy) break;
        const Difference next = farthest_difference(first, second, -v);
        const Real width = dot(next.point(), v) / distance;
        bounds.lower = std::max(bounds.lower, width);
        if (bounds.upper - bounds.lower <= goal.accuracy || bounds.lower > goal.enough) break;
        std::vector<Difference> corners = nearest.corners;
        corners.push_back(next);
        nearest = nearest_of_simplex(corners);
        if (nearest.corners.size() == 4) {  // the origin is inside
            bounds.points = {nearest.mean(&Difference::first), nearest.mean(&Difference::second)};
            bounds.upper = length(bounds.points[0] - bounds.points[1]);
            break;
        }
    }
    simplex = nearest.corners;
    return bounds;
}

}  // namespace

Real gap_along(const ConvexBody& first, const ConvexBody& second, const Vector& direction) {
    return -(first.reach(direction) + second.reach(-direction));
}

DistanceBounds bound_distance(const ConvexBody& first, const ConvexBody& second, Real accuracy, Real far_enough) {
    std::vector<Difference> simplex;
    return bound_distance(first, second, {accuracy, far_enough}, simplex);
}

namespace {

DepthBounds bound_depth_once(const ConvexBody& first, const ConvexBody& second, Real accuracy, Real deep_enough) {
    DepthBounds bounds{0, std::numeric_limits<Real>::infinity()};
    std::vector<Difference> simplex;
    (void)bound_distance(first, second, {0, 0}, simplex);
    std::vector<Face> faces = polytope_around(first, second, simplex);
    for (int step = 0; step < max_expansions && !faces.empty(); ++step) {
        const Face nearest = *std::ranges::min_element(faces, {}, &Face::distance);
        bounds.lower = std::max(bounds.lower, nearest.distance);
        const Vector point = farthest_difference(first, second, nearest.normal).point();
        bounds.upper = std::min(bounds.upper, dot(point, nearest.normal));
        if (bounds.upper - bounds.lower <= accuracy || bounds.lower > deep_enough) break;
        if (!expand(faces, point)) break;
    }
    return bounds;
}

}  // namespace

DepthBounds bound_depth(const ConvexBody& first, const ConvexBody& second, Real accuracy, Real deep_enough) {
    const DepthBounds bounds = bound_depth_once(first, second, accuracy, deep_enough);
    if (bounds.lower > 0) return bounds;
    // No polytope was found, for example because rounding hides on which side of a face the origin is. A motion by `size` changes the depth
    // by at most `size`.
    const Real size = std::min(first.radius(), second.radius()) * 1e-7L;
    const Vector by = Vector{0.6L, 0.64L, 0.48L} * size;
    const DepthBounds moved = bound_depth_once(first, second.moved(by), accuracy, deep_enough + size);
    return {std::max(Real(0), moved.lower - size), moved.upper + size};
}

}  // namespace octopair::certificate
