// gjk_distance(): distance of two convex cores by GJK, on the Minkowski difference of the cores.
//
// Source    Gilbert, Johnson, Keerthi 1988; lower bound by van den Bergen.
// Simplex   The nearest point of a simplex is the nearest among candidates on all its faces. Each candidate is a sum with
//           weights >= 0 that add up to 1, so a flat simplex reduces only accuracy, not correctness.
// FCL       FCL's search stops at any step with little progress, may report a touching pair either way, and throws on flat
//           simplices. Therefore this file does not use it.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "geometry/vector.hpp"
#include "narrow_phase/convex/local_convex.hpp"

namespace octopair {
namespace {

struct Vertex {
    Point3d on_a, on_b, apart;  // apart = on_a - on_b
};

using Weights = std::array<double, 4>;

/// Up to four vertices of the Minkowski difference, and the point of their convex hull that is nearest to the origin.
class Simplex {
public:
    /// `slack`: rounding error of a vertex.
    explicit Simplex(double slack) : slack_(slack) {}

    void add(const Vertex& vertex) { vertices_[count_++] = vertex; }
    bool has(const Vertex& vertex) const {
        return std::any_of(vertices_.begin(), vertices_.begin() + std::ptrdiff_t(count_),
                           [&](const Vertex& one) { return one.apart == vertex.apart; });
    }

    /// Finds the nearest point, and removes the vertices that have weight 0 in it.
    void reduce() {
        best_ = std::numeric_limits<double>::infinity();
        for (std::size_t i = 0; i < count_; ++i) {
            offer(weights({i}, {1}));
            for (std::size_t j = 0; j < i; ++j) {
                try_edge(i, j);
                for (std::size_t k = 0; k < j; ++k) try_triangle(i, j, k);
            }
        }
        if (count_ == 4) try_inside();
        keep_needed();
    }

    /// True if the nearest point is inside a tetrahedron of four vertices. The nearest point is then the origin, up to rounding.
    bool encloses() const { return count_ == 4; }
    const Point3d& nearest() const { return nearest_; }
    std::span<const Vertex> vertices() const { return {vertices_.data(), count_}; }
    /// Returns the direction from the origin to the nearest point, with length 1. If the simplex is larger than that distance,
    /// the nearest point gives an inaccurate direction; then the direction perpendicular to the simplex is used.
    Point3d direction() const {
        const double length = vector::length(nearest_);
        const Point3d unit = vector::times(nearest_, 1 / length);
        if (count_ == 2) {
            const Point3d edge = vector::minus(at(1), at(0));
            if (vector::dot(edge, edge) < length * length) return unit;
            return unit_or(vector::minus(unit, vector::times(edge, vector::dot(unit, edge) / vector::dot(edge, edge))),
                           unit);
        }
        if (count_ == 3) {
            const Point3d first = vector::minus(at(1), at(0)), second = vector::minus(at(2), at(0));
            const Point3d normal = vector::cross(first, second);
            const double longest = std::max(vector::length(first), vector::length(second));
            if (vector::length(normal) < length * longest) return unit;
            return unit_or(vector::times(normal, vector::dot(normal, at(0)) < 0 ? -1 : 1), unit);
        }
        return unit;
    }
    Point3d mix(Point3d Vertex::*which) const { return mix(kept_, which); }

private:
    static Weights weights(std::initializer_list<std::size_t> which, std::initializer_list<double> how_much) {
        Weights made = {};
        auto weight = how_much.begin();
        for (const std::size_t i : which) made[i] = *weight++;
        return made;
    }
    Point3d mix(const Weights& weights, Point3d Vertex::*which) const {
        Point3d sum = {};
        for (std::size_t i = 0; i < count_; ++i) {
            if (weights[i] > 0) sum = vector::plus(sum, vector::times(vertices_[i].*which, weights[i]));
        }
        return sum;
    }
    static Point3d unit_or(const Point3d& vector, const Point3d& otherwise) {
        const double length = vector::length(vector);
        return length > 0 ? vector::times(vector, 1 / length) : otherwise;
    }
    const Point3d& at(std::size_t i) const { return vertices_[i].apart; }

    void offer(const Weights& weights) {
        const Point3d point = mix(weights, &Vertex::apart);
        const double squared = vector::dot(point, point);
        if (!(squared < best_)) return;
        best_ = squared, kept_ = weights, nearest_ = point;
    }
    void try_edge(std::size_t i, std::size_t j) {
        const Point3d along = vector::minus(at(j), at(i));
        const double part = -vector::dot(at(i), along) / vector::dot(along, along);
        if (part > 0 && part < 1) offer(weights({i, j}, {1 - part, part}));
    }
    void try_triangle(std::size_t i, std::size_t j, std::size_t k) {
        const Point3d first = vector::minus(at(j), at(i)), second = vector::minus(at(k), at(i));
        const Point3d normal = vector::cross(first, second);
        const double whole = vector::dot(normal, normal);
        const Point3d from = vector::times(at(i), -1);
        const double of_j = vector::dot(vector::cross(from, second), normal) / whole;
        const double of_k = vector::dot(vector::cross(first, from), normal) / whole;
        if (of_j > 0 && of_k > 0 && of_j + of_k < 1) offer(weights({i, j, k}, {1 - of_j - of_k, of_j, of_k}));
    }
    void try_inside() {
        const Point3d x = vector::minus(at(1), at(0)), y = vector::minus(at(2), at(0)), z = vector::minus(at(3), at(0));
        const double whole = vector::dot(x, vector::cross(y, z));
        Weights inside = {1, 0, 0, 0};
        Point3d rest = vector::times(at(0), -1);
        // In a flat simplex the rounding error of the first weights is large, so two more steps correct the weights. The weights may
        // still be wrong, so they are accepted only if the weighted sum of the vertices is the origin.
        for (int step = 0; step < 3; ++step) {
            const double of_x = inside[1] + vector::dot(rest, vector::cross(y, z)) / whole;
            const double of_y = inside[2] + vector::dot(x, vector::cross(rest, z)) / whole;
            const double of_z = inside[3] + vector::dot(x, vector::cross(y, rest)) / whole;
            if (!(of_x > 0 && of_y > 0 && of_z > 0 && of_x + of_y + of_z < 1)) return;
            inside = {1 - of_x - of_y - of_z, of_x, of_y, of_z};
            const Point3d zero = mix(inside, &Vertex::apart);
            if (vector::length(zero) <= slack_) return offer(inside);
            rest = vector::times(zero, -1);
        }
    }
    void keep_needed() {
        std::size_t kept = 0;
        for (std::size_t i = 0; i < count_; ++i) {
            if (!(kept_[i] > 0)) continue;
            vertices_[kept] = vertices_[i];
            kept_[kept++] = kept_[i];
        }
        count_ = kept;
        for (std::size_t i = kept; i < kept_.size(); ++i) kept_[i] = 0;
    }

    double slack_;
    std::array<Vertex, 4> vertices_ = {};
    std::size_t count_ = 0;
    double best_ = 0;
    Weights kept_ = {};
    Point3d nearest_ = {};
};

Vertex support(const LocalConvexPair& pair, const Point3d& direction) {
    Vertex vertex;
    vertex.on_a = pair.a().support(direction);
    vertex.on_b = pair.b().support(vector::times(direction, -1));
    vertex.apart = vector::minus(vertex.on_a, vertex.on_b);
    return vertex;
}

/// A lower bound on the distance, and the direction that proves it: along this direction, all vertices of the difference are at least this
/// far from the origin.
struct Proof {
    double at_least = 0;
    Point3d direction = {};

    /// Replaces the proof if `unit`, a direction of length 1, proves a larger bound. Returns the vertex that is least far along `unit`.
    Vertex try_direction(const LocalConvexPair& pair, const Point3d& unit) {
        const Vertex least = support(pair, vector::times(unit, -1));
        const double bound = vector::dot(least.apart, unit) - pair.slack();
        if (bound > at_least) at_least = bound, direction = unit;
        return least;
    }
};

/// Improves a proof: tries the normals of faces around the nearest point that are close to `direction`. Two parallel faces that are near
/// each other need this. If their nearest points lie on an edge or corner, the short gap between them does not determine the normal.
void prove_by_faces(const LocalConvexPair& pair, std::span<const Vertex> vertices, const Point3d& direction,
                    Proof& proof) {
    constexpr double aside = 1e-5, alike = 0.999;
    std::array<Vertex, 8> around = {};
    std::size_t count = 0;
    for (const Vertex& vertex : vertices) around[count++] = vertex;
    const Point3d axis = std::fabs(direction[0]) < 0.6 ? Point3d{1, 0, 0} : Point3d{0, 1, 0};
    const Point3d first = vector::cross(direction, axis), second = vector::cross(direction, first);
    for (const Point3d& way : {first, second}) {
        for (const double by : {aside, -aside}) {
            around[count++] = support(pair, vector::times(vector::plus(direction, vector::times(way, by)), -1));
        }
    }
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            const Point3d edge = vector::minus(around[j].apart, around[i].apart);
            for (std::size_t k = 0; k < j; ++k) {
                const Point3d normal = vector::cross(edge, vector::minus(around[k].apart, around[i].apart));
                const double along = vector::dot(normal, direction);
                if (!(std::fabs(along) > alike * vector::length(normal))) continue;
                const double size = vector::length(normal);
                (void)proof.try_direction(pair, vector::times(normal, std::copysign(1 / size, along)));
            }
        }
    }
}

/// A proof that the objects are apart, and the vertices of the difference that determine its direction.
struct ProvenDirection {
    Proof proof;
    std::array<Vertex, 3> vertices = {};
    std::size_t count = 0;
};

/// Searches a direction that proves the objects apart, beginning with the vertices of a simplex.
///
/// If one object is much larger than the other, the difference has vertices near the origin and vertices far from it. Then rounding
/// errors of the far vertices may end the search for the distance before it has found the right near vertices. Whether a direction
/// proves the objects apart does not depend on the distance of a vertex. So this search is GJK with all vertices moved to the unit
/// sphere.
std::optional<ProvenDirection> search_directions(const LocalConvexPair& pair, const Simplex& simplex) {
    constexpr int max_steps = 64;
    constexpr double rounding = 1e-12;
    const auto on_sphere = [](Vertex vertex) {
        vertex.apart = vector::times(vertex.apart, 1 / vector::length(vertex.apart));
        return vertex;
    };
    Simplex units(rounding);
    for (const Vertex& vertex : simplex.vertices()) units.add(on_sphere(vertex));
    units.reduce();
    for (int step = 0; step < max_steps; ++step) {
        const double length = vector::length(units.nearest());
        if (units.encloses() || !(length > rounding)) return {};
        ProvenDirection found;
        const Vertex next = found.proof.try_direction(pair, units.direction());
        if (found.proof.at_least > 0) {
            for (Vertex vertex : units.vertices()) {
                vertex.apart = vector::minus(vertex.on_a, vertex.on_b);
                found.vertices[found.count++] = vertex;
            }
            return found;
        }
        const Vertex unit = on_sphere(next);
        if (units.has(unit)) return {};
        Simplex larger = units;
        larger.add(unit);
        larger.reduce();
        if (!(vector::length(larger.nearest()) < length)) return {};
        units = larger;
    }
    return {};
}

CoreGap gap_of(const Simplex& simplex, const Proof& proof) {
    CoreGap gap;
    gap.on_a = simplex.mix(&Vertex::on_a), gap.on_b = simplex.mix(&Vertex::on_b);
    gap.at_most = vector::length(simplex.nearest());
    gap.at_least = std::min(proof.at_least, gap.at_most);
    gap.direction = proof.direction;
    return gap;
}

/// Returns the gap of two objects that gjk_distance() could not prove to be apart: searches directions instead. `simplex`: the last simplex
/// of gjk_distance().
CoreGap gap_by_directions(const LocalConvexPair& pair, const Simplex& simplex) {
    auto found = search_directions(pair, simplex);
    if (!found) return gap_of(simplex, {});
    const std::span<const Vertex> vertices(found->vertices.data(), found->count);
    prove_by_faces(pair, vertices, Point3d(found->proof.direction), found->proof);
    Simplex near(pair.slack());
    for (const Vertex& vertex : vertices) near.add(vertex);
    near.reduce();
    const bool is_nearer = vector::length(near.nearest()) < vector::length(simplex.nearest());
    return gap_of(is_nearer ? near : simplex, found->proof);
}

}  // namespace

CoreGap gjk_distance(const LocalConvexPair& pair, std::optional<double> enough) {
    constexpr int max_steps = 256;
    constexpr double relative = 4 * std::numeric_limits<double>::epsilon();
    const double slack = pair.slack();
    Proof proof;
    bool decided = false;
    Simplex simplex(slack);
    simplex.add(support(pair, vector::minus(pair.b().middle(), pair.a().middle())));
    simplex.reduce();
    for (int step = 0; step < max_steps; ++step) {
        const double at_most = vector::length(simplex.nearest());
        decided = simplex.encloses() || at_most <= slack || (enough && at_most <= *enough);
        if (decided) break;
        const Vertex next = proof.try_direction(pair, simplex.direction());
        decided = (enough && proof.at_least > *enough) || at_most - proof.at_least <= 2 * slack + relative * at_most;
        if (decided || simplex.has(next)) break;
        Simplex larger = simplex;
        larger.add(next);
        larger.reduce();
        if (!(vector::length(larger.nearest()) < at_most)) break;
        simplex = larger;
    }
    if (!decided) prove_by_faces(pair, simplex.vertices(), simplex.direction(), proof);
    return decided || proof.at_least > 0 ? gap_of(simplex, proof) : gap_by_directions(pair, simplex);
}

}  // namespace octopair
