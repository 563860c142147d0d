#include "self_intersections/surface.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>

namespace octopair::bench {

namespace {

Point3d of_length_one(const Point3d& v) {
    const double length = std::hypot(v[0], v[1], v[2]);
    return {v[0] / length, v[1] / length, v[2] / length};
}

/// Deformation of the sphere.
class Form {
public:
    explicit Form(std::uint32_t seed) {
        std::mt19937 random(seed);
        std::uniform_real_distribution<double> at(-1, 1);
        for (Point3d& arm : arms_) arm = of_length_one({at(random), at(random), at(random)});
        for (Point3d& wave : waves_) wave = {20 * at(random), 20 * at(random), 20 * at(random)};
    }

    Point3d operator()(const Point3d& place) const {
        double radius = 1;
        for (const Point3d& wave : waves_) radius += 0.01 * std::sin(dot(wave, place));
        Point3d moved = {radius * place[0], radius * place[1], radius * place[2]};
        for (const Point3d& arm : arms_) {
            const double angle = std::acos(std::clamp(dot(arm, place), -1.0, 1.0)) / arm_width;
            if (angle >= 1) continue;
            const double part = (1 - angle * angle) * (1 - angle * angle);
            for (std::size_t axis = 0; axis < 3; ++axis) moved[axis] -= arm_length * part * arm[axis];
        }
        return moved;
    }

private:
    static constexpr double arm_width = 0.4;   // radians
    static constexpr double arm_length = 2.3;  // radii of the sphere

    static double dot(const Point3d& a, const Point3d& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

    std::array<Point3d, 10> arms_;
    std::array<Point3d, 8> waves_;
};

/// Position on a cube of `side` squares per edge. Positions on edges belong to several sides.
using CubePlace = std::array<std::uint32_t, 3>;

class Builder {
public:
    Builder(std::uint32_t side, std::uint32_t seed) : side_(side), form_(seed) {}

    void add_side(std::size_t axis, bool far) {
        for (std::uint32_t u = 0; u < side_; ++u) {
            for (std::uint32_t v = 0; v < side_; ++v) {
                const auto corner = [&](std::uint32_t du, std::uint32_t dv) {
                    CubePlace place;
                    place[axis] = far ? side_ : 0;
                    place[(axis + 1) % 3] = u + du;
                    place[(axis + 2) % 3] = v + dv;
                    return vertex(place);
                };
                const std::uint32_t a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
                add_triangle({a, b, c}, far);
                add_triangle({a, c, d}, far);
            }
        }
    }

    shape::Mesh mesh;

private:
    void add_triangle(std::array<std::uint32_t, 3> corners, bool far) {
        if (!far) std::swap(corners[1], corners[2]);
        mesh.triangles.push_back(corners);
    }

    std::uint32_t vertex(const CubePlace& place) {
        const auto [known, is_new] = known_.try_emplace(place, std::uint32_t(mesh.vertices.size()));
        if (is_new) {
            Point3d at;
            // The tangent gives squares of similar size on the sphere.
            for (std::size_t axis = 0; axis < 3; ++axis) {
                at[axis] = std::tan((2.0 * place[axis] / side_ - 1) * std::atan(1.0));
            }
            mesh.vertices.push_back(form_(of_length_one(at)));
        }
        return known->second;
    }

    std::uint32_t side_;
    Form form_;
    std::map<CubePlace, std::uint32_t> known_;
};

}  // namespace

shape::Mesh make_surface(std::uint32_t triangles, std::uint32_t seed) {
    const auto side = std::max(2U, std::uint32_t(std::lround(std::sqrt(triangles / 12.0))));
    Builder builder(side, seed);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        builder.add_side(axis, false);
        builder.add_side(axis, true);
    }
    return std::move(builder.mesh);
}

}  // namespace octopair::bench
