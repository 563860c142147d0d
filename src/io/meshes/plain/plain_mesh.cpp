#include "io/meshes/plain/plain_mesh.hpp"

#include <cstddef>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "io/meshes/faces/face_cutter.hpp"

namespace octopair::io {

namespace {

/// Cuts the faces of a mesh, one after the other.
class PolygonCutter {
public:
    PolygonCutter(const PlainMesh& mesh, const std::stop_token& stop) : mesh_(mesh), cutter_(stop) {}

    /// Appends the triangles of a face. Returns false if the face crosses itself.
    bool cut(std::span<const std::uint32_t> corners, std::vector<std::array<std::uint32_t, 3>>& triangles) {
        if (corners.size() == 3) {
            triangles.push_back({corners[0], corners[1], corners[2]});
            return true;
        }
        places_.clear();
        for (const std::uint32_t corner : corners) places_.push_back(mesh_.vertices[corner]);
        const bool is_simple = cutter_.cut(places_);
        for (const auto& [a, b, c] : cutter_.triangles()) triangles.push_back({corners[a], corners[b], corners[c]});
        return is_simple;
    }

private:
    const PlainMesh& mesh_;
    FaceCutter cutter_;
    std::vector<Point3d> places_;  // places of the corners of a face
};

}  // namespace

std::uint64_t PlainMesh::triangles() const {
    std::uint64_t count = 0, begin = 0;
    for (const std::uint64_t end : ends) {
        count += end - begin > 2 ? end - begin - 2 : 0;
        begin = end;
    }
    return count;
}

shape::Mesh cut_into_triangles(PlainMesh mesh, CrossingFaces& crossing, const std::stop_token& stop) {
    shape::Mesh cut_mesh;
    cut_mesh.triangles.reserve(mesh.triangles());
    PolygonCutter cutter(mesh, stop);
    std::uint64_t begin = 0;
    for (std::size_t face = 0; face < mesh.ends.size(); ++face) {
        if (face % 65536 == 0 && stop.stop_requested()) cancel();
        const std::uint64_t end = mesh.ends[face];
        if (!cutter.cut(std::span(mesh.corners).subspan(begin, end - begin), cut_mesh.triangles))
            crossing.add(face, mesh.name);
        begin = end;
    }
    cut_mesh.vertices = std::move(mesh.vertices);
    return cut_mesh;
}

void FileContent::checkpoint(std::size_t offset) const {
    if (stop.stop_requested()) cancel();
    if (progress) progress(double(offset) / double(bytes.size()));
}

void FileContent::warn(std::string_view what) const {
    if (warnings != nullptr) warnings->push_back(fmt::format("{}: {}", path, what));
}

}  // namespace octopair::io
