#include "narrow_phase/solid_samples.hpp"

#include <cmath>
#include <utility>

namespace octopair::test {

namespace {

void add_quad(shape::Mesh& mesh, const std::array<std::uint32_t, 4>& corners) {
    const auto& [a, b, c, d] = corners;
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
}

}  // namespace

Outline regular_outline(unsigned corners, double radius) {
    Outline outline;
    for (unsigned i = 0; i < corners; ++i) {
        const double angle = 2 * std::numbers::pi * i / corners;
        outline.push_back({radius * std::cos(angle), radius * std::sin(angle)});
    }
    return outline;
}

Outline rectangle(double half_width, double half_height) {
    return {
        {-half_width, -half_height}, {half_width, -half_height}, {half_width, half_height}, {-half_width, half_height}};
}

Outline gear_outline(unsigned teeth, double inner, double outer) {
    Outline outline;
    for (unsigned i = 0; i < 4 * teeth; ++i) {
        const double angle = 2 * std::numbers::pi * i / (4 * teeth);
        const double radius = i % 4 < 2 ? inner : outer;
        outline.push_back({radius * std::cos(angle), radius * std::sin(angle)});
    }
    return outline;
}

Outline scaled(Outline outline, double factor) {
    for (Point2d& point : outline) point = {point[0] * factor, point[1] * factor};
    return outline;
}

shape::Mesh prism(const Outline& outline, double low, double high) {
    shape::Mesh mesh;
    const auto count = std::uint32_t(outline.size());
    for (const Point2d& point : outline) mesh.vertices.push_back({point[0], point[1], low});
    for (const Point2d& point : outline) mesh.vertices.push_back({point[0], point[1], high});
    mesh.vertices.push_back({0, 0, low});
    mesh.vertices.push_back({0, 0, high});
    for (std::uint32_t i = 0; i < count; ++i) {
        const std::uint32_t next = (i + 1) % count;
        add_quad(mesh, {i, next, count + next, count + i});
        mesh.triangles.push_back({next, i, 2 * count});
        mesh.triangles.push_back({count + i, count + next, 2 * count + 1});
    }
    return mesh;
}

shape::Mesh ring(const Outline& outer, const Outline& inner, double low, double high) {
    shape::Mesh mesh;
    const auto count = std::uint32_t(outer.size());
    for (const Outline* outline : {&outer, &inner}) {
        for (const double z : {low, high}) {
            for (const Point2d& point : *outline) mesh.vertices.push_back({point[0], point[1], z});
        }
    }
    for (std::uint32_t i = 0; i < count; ++i) {
        const std::uint32_t next = (i + 1) % count;
        add_quad(mesh, {i, next, count + next, count + i});
        add_quad(mesh, {2 * count + next, 2 * count + i, 3 * count + i, 3 * count + next});
        add_quad(mesh, {next, i, 2 * count + i, 2 * count + next});
        add_quad(mesh, {count + i, count + next, 3 * count + next, 3 * count + i});
    }
    return mesh;
}

shape::Mesh revolved(const std::vector<Point2d>& profile, unsigned segments, bool closed) {
    shape::Mesh mesh;
    const auto count = std::uint32_t(profile.size());
    for (unsigned s = 0; s < segments; ++s) {
        const double angle = 2 * std::numbers::pi * s / segments;
        for (const auto& [radius, z] : profile) {
            mesh.vertices.push_back({radius * std::cos(angle), radius * std::sin(angle), z});
        }
    }
    const auto vertex = [&](unsigned s, std::uint32_t i) {
        // All segments share the points of the axis.
        return profile[i][0] == 0 ? i : (s % segments) * count + i;
    };
    for (unsigned s = 0; s < segments; ++s) {
        for (std::uint32_t i = 0; i < (closed ? count : count - 1); ++i) {
            const std::uint32_t next = (i + 1) % count;
            const std::array<std::uint32_t, 4> corners = {vertex(s, i), vertex(s, next), vertex(s + 1, next),
                                                          vertex(s + 1, i)};
            if (corners[0] != corners[3]) mesh.triangles.push_back({corners[0], corners[2], corners[3]});
            if (corners[1] != corners[2]) mesh.triangles.push_back({corners[0], corners[1], corners[2]});
        }
    }
    return mesh;
}

shape::Mesh comb(const std::vector<double>& xs, const std::vector<double>& top, double floor, double depth) {
    shape::Mesh mesh;
    const auto count = std::uint32_t(xs.size());
    for (const double y : {0.0, depth}) {
        for (std::uint32_t i = 0; i < count; ++i) mesh.vertices.push_back({xs[i], y, floor});
        for (std::uint32_t i = 0; i < count; ++i) mesh.vertices.push_back({xs[i], y, top[i]});
    }
    const auto low = [&](std::uint32_t i) { return i; };
    const auto high = [&](std::uint32_t i) { return count + i; };
    const std::uint32_t behind = 2 * count;
    for (std::uint32_t i = 0; i + 1 < count; ++i) {
        add_quad(mesh, {low(i), low(i + 1), high(i + 1), high(i)});
        add_quad(mesh, {behind + low(i + 1), behind + low(i), behind + high(i), behind + high(i + 1)});
        add_quad(mesh, {high(i), high(i + 1), behind + high(i + 1), behind + high(i)});
        add_quad(mesh, {low(i + 1), low(i), behind + low(i), behind + low(i + 1)});
    }
    add_quad(mesh, {low(0), high(0), behind + high(0), behind + low(0)});
    add_quad(mesh, {low(count - 1), behind + low(count - 1), behind + high(count - 1), high(count - 1)});
    return mesh;
}

shape::Mesh joined(shape::Mesh first, const shape::Mesh& second) {
    const auto count = std::uint32_t(first.vertices.size());
    first.vertices.insert(first.vertices.end(), second.vertices.begin(), second.vertices.end());
    for (const auto& [a, b, c] : second.triangles) first.triangles.push_back({a + count, b + count, c + count});
    return first;
}

shape::Mesh turned_inside_out(shape::Mesh mesh) {
    for (auto& corners : mesh.triangles) std::swap(corners[1], corners[2]);
    return mesh;
}

shape::Mesh moved(shape::Mesh mesh, const Point3d& by) {
    for (Point3d& vertex : mesh.vertices) {
        for (std::size_t axis = 0; axis < 3; ++axis) vertex[axis] += by[axis];
    }
    return mesh;
}

}  // namespace octopair::test
