#include "samples/meshes.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace octopair::samples {

namespace {

using Corners = std::array<std::uint32_t, 3>;

/// Divides each triangle into four. New vertices are the midpoints of edges, projected to the sphere.
class SphereSubdivision {
public:
    SphereSubdivision(shape::Mesh& mesh, double radius) : mesh_(mesh), radius_(radius) {}

    void subdivide() {
        std::vector<Corners> finer;
        for (const auto& [a, b, c] : mesh_.triangles) {
            const std::uint32_t ab = midpoint(a, b), bc = midpoint(b, c), ca = midpoint(c, a);
            finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
        }
        mesh_.triangles = std::move(finer);
    }

private:
    std::uint32_t midpoint(std::uint32_t a, std::uint32_t b) {
        const auto [at, is_new] = midpoints_.try_emplace(std::minmax(a, b), std::uint32_t(mesh_.vertices.size()));
        if (!is_new) return at->second;
        const Point3d &p = mesh_.vertices[a], &q = mesh_.vertices[b];
        Point3d point = {p[0] + q[0], p[1] + q[1], p[2] + q[2]};
        const double length = std::hypot(point[0], point[1], point[2]);
        for (double& coordinate : point) coordinate *= radius_ / length;
        mesh_.vertices.push_back(point);
        return at->second;
    }

    shape::Mesh& mesh_;
    double radius_;
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> midpoints_;
};

}  // namespace

shape::Mesh box_mesh(const Point3d& min, const Point3d& max) {
    shape::Mesh mesh;
    for (unsigned corner = 0; corner < 8; ++corner) {
        mesh.vertices.push_back(
            {corner & 1 ? max[0] : min[0], corner & 2 ? max[1] : min[1], corner & 4 ? max[2] : min[2]});
    }
    mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                      {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    return mesh;
}

shape::Mesh sphere_mesh(double radius, unsigned level) {
    shape::Mesh mesh;
    mesh.vertices = {{radius, 0, 0}, {-radius, 0, 0}, {0, radius, 0}, {0, -radius, 0}, {0, 0, radius}, {0, 0, -radius}};
    mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    for (unsigned i = 0; i < level; ++i) SphereSubdivision(mesh, radius).subdivide();
    return mesh;
}

shape::Mesh torus_mesh(const TorusRequest& request) {
    constexpr double minor_radius = 0.35, full_turn = 2 * std::numbers::pi;
    RandomStream random(request.seed, 0);
    shape::Mesh mesh;
    for (std::uint32_t ring = 0; ring < request.rings; ++ring) {
        const double major_angle = full_turn * ring / request.rings;
        for (std::uint32_t side = 0; side < request.sides; ++side) {
            const double minor_angle = full_turn * side / request.sides;
            const double radius = minor_radius * (1 + random.uniform(-request.bump, request.bump));
            const double from_axis = 1 + radius * std::cos(minor_angle);
            mesh.vertices.push_back(
                {from_axis * std::cos(major_angle), from_axis * std::sin(major_angle), radius * std::sin(minor_angle)});
            const std::uint32_t next_ring = (ring + 1) % request.rings, next_side = (side + 1) % request.sides;
            const std::uint32_t a = ring * request.sides + side, b = next_ring * request.sides + side;
            const std::uint32_t c = next_ring * request.sides + next_side, d = ring * request.sides + next_side;
            mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {a, c, d}});
        }
    }
    return mesh;
}

Pose random_pose(RandomStream& random, double width) {
    const std::array<double, 4> turn = {random.gaussian(), random.gaussian(), random.gaussian(), random.gaussian()};
    return make_pose({random.uniform(0, width), random.uniform(0, width), random.uniform(0, width)}, turn);
}

}  // namespace octopair::samples
