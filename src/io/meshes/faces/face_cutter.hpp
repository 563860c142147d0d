// FaceCutter: cuts faces with any number of corners into triangles. CrossingFaces: counts the faces that have no correct triangles.
// Start here to change how faces are cut into triangles.
//
// - All decisions are exact. They are made in a plane of two coordinate axes: that in which the area of the outline is largest.
// - A convex face is cut from its first corner. Other faces are cut by a sweep (outline_sweep.hpp). The triangles fill the inside of the
//   outline, also if it touches itself, and turn the same way as the outline.
// - A face that crosses itself or folds in the plane has no such triangles. It is cut into ears, within the convex hull of its corners.
// - Besides the edges of the outline, all edges of triangles cancel in pairs. So a closed mesh stays closed.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "io/meshes/faces/plane_outline.hpp"

namespace octopair::io {

class FaceCutter {
public:
    using Triangle = std::array<std::uint32_t, 3>;

    /// Borrows `stop`: it must outlive this object.
    explicit FaceCutter(const std::stop_token& stop) : check_(stop) {}

    /// Cuts a face, given by the places of its corners in order. A face with fewer than three corners has no triangles.
    /// Returns false if the outline crosses itself or folds.
    /// Throws: Error{cancelled}. Complexity: O(n log n) for n corners.
    bool cut(std::span<const Point3d> outline);
    /// Returns the triangles of the last face, by the positions of its corners.
    std::span<const Triangle> triangles() const { return triangles_; }

private:
    void cut_from_first_corner(std::size_t corners);

    StopCheck check_;
    std::vector<Triangle> triangles_;
};

/// Counts the faces of a file that cross themselves, for a warning.
class CrossingFaces {
public:
    /// Counts face `face` of an object.
    void add(std::uint64_t face, std::string_view object);
    /// Appends a warning about the faces of the file, if there are any.
    void append_warning(std::string_view path, std::vector<std::string>& warnings) const;

private:
    std::uint64_t count_ = 0, first_ = 0;
    std::string object_;
};

}  // namespace octopair::io
