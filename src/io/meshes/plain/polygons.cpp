// cut_into_triangles(): faces with more than three corners become triangles.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>

#include "geometry/vector.hpp"
#include "io/meshes/plain/plain_mesh.hpp"

namespace octopair::io {

namespace {

/// A face in the projection along the longest axis of its normal, counterclockwise.
class Polygon {
public:
    Polygon(const PlainMesh& mesh, std::span<const std::uint32_t> corners) : corners_(corners.begin(), corners.end()) {
        Point3d normal = {};  // twice the area, by the first corner
        const Point3d& origin = mesh.vertices[corners[0]];
        for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
            const Point3d area = vector::cross(vector::minus(mesh.vertices[corners[i]], origin),
                                               vector::minus(mesh.vertices[corners[i + 1]], origin));
            normal = vector::plus(normal, area);
        }
        std::size_t axis = 0;
        for (std::size_t k = 1; k < 3; ++k) {
            if (std::fabs(normal[k]) > std::fabs(normal[axis])) axis = k;
        }
        const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
        const double sense = normal[axis] < 0 ? -1 : 1;
        for (const std::uint32_t corner : corners) {
            const Point3d way = vector::minus(mesh.vertices[corner], origin);
            places_.push_back({sense * way[u], way[v]});
        }
    }

    bool is_convex() const {
        for (std::size_t i = 0; i < places_.size(); ++i) {
            if (turn(i, (i + 1) % places_.size(), (i + 2) % places_.size()) < 0) return false;
        }
        return true;
    }

    /// Appends the triangles. Cuts off corners that bulge and have no other corner in their triangle; if there are none, as in
    /// a face that crosses itself, the next corner.
    void cut_ears(std::vector<std::array<std::uint32_t, 3>>& triangles) const {
        std::vector<std::size_t> left;
        for (std::size_t i = 0; i < corners_.size(); ++i) left.push_back(i);
        std::size_t at = 0, tried = 0;
        while (left.size() > 3) {
            const std::size_t before = left[(at + left.size() - 1) % left.size()], ear = left[at % left.size()],
                              after = left[(at + 1) % left.size()];
            if (is_ear(before, ear, after, left) || tried == left.size()) {
                triangles.push_back({corners_[before], corners_[ear], corners_[after]});
                left.erase(left.begin() + std::ptrdiff_t(at % left.size()));
                at = at % (left.size() + 1) == left.size() ? 0 : at % (left.size() + 1);
                tried = 0;
            } else {
                at = (at + 1) % left.size();
                ++tried;
            }
        }
        triangles.push_back({corners_[left[0]], corners_[left[1]], corners_[left[2]]});
    }

private:
    /// Twice the signed area of a triangle of corners.
    double turn(std::size_t a, std::size_t b, std::size_t c) const {
        const auto [au, av] = places_[a];
        return (places_[b].first - au) * (places_[c].second - av) - (places_[b].second - av) * (places_[c].first - au);
    }

    bool is_ear(std::size_t before, std::size_t ear, std::size_t after, const std::vector<std::size_t>& left) const {
        if (!(turn(before, ear, after) > 0)) return false;
        return std::none_of(left.begin(), left.end(), [&](std::size_t other) {
            if (other == before || other == ear || other == after) return false;
            return turn(before, ear, other) >= 0 && turn(ear, after, other) >= 0 && turn(after, before, other) >= 0;
        });
    }

    std::vector<std::uint32_t> corners_;
    std::vector<std::pair<double, double>> places_;
};

void cut(const PlainMesh& mesh, std::span<const std::uint32_t> corners,
         std::vector<std::array<std::uint32_t, 3>>& triangles) {
    if (corners.size() < 3) return;
    if (corners.size() > 3) {
        const Polygon polygon(mesh, corners);
        if (!polygon.is_convex()) return polygon.cut_ears(triangles);
    }
    for (std::size_t i = 1; i + 1 < corners.size(); ++i) triangles.push_back({corners[0], corners[i], corners[i + 1]});
}

}  // namespace

std::uint64_t PlainMesh::triangles() const {
    std::uint64_t count = 0, begin = 0;
    for (const std::uint64_t end : ends) {
        count += end - begin > 2 ? end - begin - 2 : 0;
        begin = end;
    }
    return count;
}

shape::Mesh cut_into_triangles(PlainMesh mesh) {
    shape::Mesh cut_mesh;
    cut_mesh.triangles.reserve(mesh.triangles());
    std::uint64_t begin = 0;
    for (const std::uint64_t end : mesh.ends) {
        cut(mesh, std::span(mesh.corners).subspan(begin, end - begin), cut_mesh.triangles);
        begin = end;
    }
    cut_mesh.vertices = std::move(mesh.vertices);
    return cut_mesh;
}

}  // namespace octopair::io
