// Shapes as triangles, for pictures. Round shapes become polyhedra.
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "octopair/shapes.hpp"
#include "viewer/scene/scene_contents.hpp"

namespace octopair::viewer {

namespace {

using Triangle = std::array<std::uint32_t, 3>;

constexpr unsigned sides = 32;  ///< of a circle

Point3d minus(const Point3d& a, const Point3d& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Point3d cross(const Point3d& a, const Point3d& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double dot(const Point3d& a, const Point3d& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

void add_vertex(ShownShape& out, double x, double y, double z) {
    out.vertices.push_back({float(x), float(y), float(z)});
}

/// A circle of a surface of revolution about the z axis.
struct Ring {
    double radius, z;
};

/// Returns the surface that joins rings, from the lowest to the highest. A ring of radius 0 is a point.
ShownShape revolved(const std::vector<Ring>& rings) {
    ShownShape out;
    for (const Ring& ring : rings) {
        for (unsigned side = 0; side < sides; ++side) {
            const double angle = 2 * std::numbers::pi * side / sides;
            add_vertex(out, ring.radius * std::cos(angle), ring.radius * std::sin(angle), ring.z);
        }
    }
    for (std::uint32_t ring = 0; ring + 1 < rings.size(); ++ring) {
        for (std::uint32_t side = 0; side < sides; ++side) {
            const std::uint32_t next = (side + 1) % sides;
            const std::uint32_t a = ring * sides + side, b = ring * sides + next, c = a + sides, d = b + sides;
            if (rings[ring].radius > 0) out.triangles.push_back({a, b, d});
            if (rings[ring + 1].radius > 0) out.triangles.push_back({a, d, c});
        }
    }
    return out;
}

/// Appends the rings of half a ball about (0, 0, z). `from` and `to` are angles above the equator, in quarters of a circle.
void add_ball_rings(std::vector<Ring>& rings, const Ring& ball, double from, double to) {
    constexpr int steps = 8;
    for (int i = 0; i <= steps; ++i) {
        const double angle = (from + (to - from) * i / steps) * std::numbers::pi / 2;
        const bool pole = std::abs(std::abs(angle) - std::numbers::pi / 2) < 1e-9;
        rings.push_back({pole ? 0 : ball.radius * std::cos(angle), ball.z + ball.radius * std::sin(angle)});
    }
}

ShownShape shown(const shape::Sphere& sphere, double) {
    std::vector<Ring> rings;
    add_ball_rings(rings, {sphere.radius, 0}, -1, 0);
    add_ball_rings(rings, {sphere.radius, 0}, 0, 1);
    return revolved(rings);
}

ShownShape shown(const shape::Box& box, double) {
    ShownShape out;
    for (unsigned corner = 0; corner < 8; ++corner) {
        const auto end = [&](unsigned axis) { return (corner >> axis & 1 ? 1 : -1) * box.half_extents[axis]; };
        add_vertex(out, end(0), end(1), end(2));
    }
    out.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                     {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    return out;
}

ShownShape shown(const shape::Capsule& capsule, double) {
    std::vector<Ring> rings;
    add_ball_rings(rings, {capsule.radius, -capsule.length / 2}, -1, 0);
    add_ball_rings(rings, {capsule.radius, capsule.length / 2}, 0, 1);
    return revolved(rings);
}

ShownShape shown(const shape::Cylinder& cylinder, double) {
    const double half = cylinder.length / 2;
    return revolved({{0, -half}, {cylinder.radius, -half}, {cylinder.radius, half}, {0, half}});
}

ShownShape shown(const shape::Cone& cone, double) {
    const double half = cone.length / 2;
    return revolved({{0, -half}, {cone.radius, -half}, {0, half}});
}

ShownShape shown(const shape::Ellipsoid& ellipsoid, double) {
    ShownShape out = shown(shape::Sphere{1}, 0);
    for (auto& vertex : out.vertices) {
        for (std::size_t axis = 0; axis < 3; ++axis) vertex[axis] *= float(ellipsoid.radii[axis]);
    }
    return out;
}

ShownShape shown(const shape::Plane& plane, double extent) {
    const double length = std::hypot(plane.normal[0], plane.normal[1], plane.normal[2]);
    Point3d normal = plane.normal;
    for (double& value : normal) value /= length;
    Point3d across = {0, 0, 0};
    across[std::abs(normal[0]) < 0.9 ? 0 : 1] = 1;
    Point3d right = cross(normal, across);
    const double width = std::hypot(right[0], right[1], right[2]);
    for (double& value : right) value /= width;
    const Point3d up = cross(normal, right);
    const double distance = plane.offset / length;
    ShownShape out;
    for (const auto& [x, y] : {std::pair(-1, -1), std::pair(1, -1), std::pair(1, 1), std::pair(-1, 1)}) {
        Point3d corner;
        for (std::size_t i = 0; i < 3; ++i) corner[i] = normal[i] * distance + (right[i] * x + up[i] * y) * extent;
        add_vertex(out, corner[0], corner[1], corner[2]);
    }
    out.triangles = {{0, 1, 2}, {0, 2, 3}};
    return out;
}

/// Builds the convex hull of points by adding one point after another. Precise enough for drawing only: nearly flat faces may be
/// missing or dented.
class HullBuilder {
public:
    explicit HullBuilder(const std::vector<Point3d>& points) : points_(points) {}

    std::vector<Triangle> triangles() {
        if (!start()) return {};
        for (std::uint32_t i = 0; i < points_.size(); ++i) add(i);
        return faces_;
    }

private:
    double volume(const Triangle& face, std::uint32_t point) const {
        const Point3d &a = points_[face[0]], &b = points_[face[1]], &c = points_[face[2]];
        return dot(cross(minus(b, a), minus(c, a)), minus(points_[point], a));
    }

    /// Makes a tetrahedron of the points that are furthest apart. Returns false if all are in a plane.
    bool start() {
        if (points_.size() < 4) return false;
        const auto furthest = [&](const auto& measure) {
            std::uint32_t best = 0;
            for (std::uint32_t i = 1; i < points_.size(); ++i) {
                if (measure(i) > measure(best)) best = i;
            }
            return best;
        };
        const std::uint32_t a = furthest([&](auto i) { return points_[i][0]; });
        const auto away = [&](auto i) { return dot(minus(points_[i], points_[a]), minus(points_[i], points_[a])); };
        const std::uint32_t b = furthest(away);
        const Point3d line = minus(points_[b], points_[a]);
        const auto off_line = [&](auto i) {
            const Point3d product = cross(line, minus(points_[i], points_[a]));
            return dot(product, product);
        };
        const std::uint32_t c = furthest(off_line);
        const std::uint32_t d = furthest([&](auto i) { return std::abs(volume({a, b, c}, i)); });
        const double size = std::sqrt(away(b));
        least_ = 1e-9 * size * size * size;
        if (std::abs(volume({a, b, c}, d)) <= least_) return false;
        faces_ = {{a, b, c}, {a, d, b}, {b, d, c}, {c, d, a}};
        if (volume({a, b, c}, d) > 0) {
            for (Triangle& face : faces_) std::swap(face[1], face[2]);
        }
        return true;
    }

    /// Adds a point outside the hull: removes the faces that are visible from the point, and joins the border of the hole to the point.
    void add(std::uint32_t point) {
        std::map<std::pair<std::uint32_t, std::uint32_t>, int> border;
        std::vector<Triangle> kept;
        for (const Triangle& face : faces_) {
            if (volume(face, point) <= least_) {
                kept.push_back(face);
                continue;
            }
            for (std::size_t i = 0; i < 3; ++i) {
                const std::pair edge(face[i], face[(i + 1) % 3]);
                if (border.erase({edge.second, edge.first}) == 0) border[edge] = 1;
            }
        }
        if (kept.size() == faces_.size()) return;
        faces_ = std::move(kept);
        for (const auto& [edge, count] : border) faces_.push_back({edge.first, edge.second, point});
    }

    const std::vector<Point3d>& points_;
    std::vector<Triangle> faces_;
    double least_ = 0;
};

/// Returns a shape with vertices at these points, and without triangles.
ShownShape with_vertices(const std::vector<Point3d>& points) {
    ShownShape out;
    if (points.empty()) return out;
    Point3d low = points.front(), high = low;
    for (const Point3d& point : points) {
        for (std::size_t i = 0; i < 3; ++i) {
            low[i] = std::min(low[i], point[i]);
            high[i] = std::max(high[i], point[i]);
        }
    }
    for (std::size_t i = 0; i < 3; ++i) out.centre[i] = low[i] / 2 + high[i] / 2;
    for (const Point3d& point : points) {
        const Point3d from_centre = minus(point, out.centre);
        add_vertex(out, from_centre[0], from_centre[1], from_centre[2]);
    }
    return out;
}

ShownShape shown(const shape::ConvexHull& hull, double) {
    ShownShape out = with_vertices(hull.points);
    out.triangles = HullBuilder(hull.points).triangles();
    return out;
}

ShownShape shown(const shape::Mesh& mesh, double) {
    ShownShape out = with_vertices(mesh.vertices);
    out.triangles = mesh.triangles;
    return out;
}

constexpr std::string_view kinds[] = {"sphere",    "box",   "capsule",     "cylinder", "cone",
                                      "ellipsoid", "plane", "convex hull", "mesh"};

}  // namespace

ShownShape shown_shape(const shape::Any& shape, double extent) {
    ShownShape out = std::visit([&](const auto& some) { return shown(some, extent); }, shape);
    out.kind = kinds[shape.index()];
    return out;
}

}  // namespace octopair::viewer
