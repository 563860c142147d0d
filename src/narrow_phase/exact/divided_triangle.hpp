// DividedTriangle: a triangle, and the edges of other triangles that lie in its plane. The edges divide it into faces.
//
// Faces     Each side of each part of an edge is beside one face. The parts of an edge end where it ends, where another edge
//           crosses it, and where another edge ends on it. So a point near such a place, on each side, is in each face that an
//           edge bounds. A point near each corner is in the others.
#pragma once

#include <functional>
#include <vector>

#include "narrow_phase/exact/nearby_point.hpp"
#include "narrow_phase/exact/segment_pair.hpp"

namespace octopair {

class DividedTriangle {
public:
    /// `projection`: projection_of(triangle). Requires: the triangle has an area.
    DividedTriangle(const Triangle3d& triangle, const Projection& projection);

    /// Adds the edges of a triangle that lie in the plane, except those along an edge of this triangle: they divide nothing.
    void divide(const Triangle3d& other);

    using Visit = std::function<bool(const NearbyPoint&)>;
    /// Calls visit(point) for one or more points in each face, until `visit` returns true. Returns whether `visit` returned true.
    bool any_face(const Visit& visit);

private:
    int side(const Segment3d& line, const Point3d& point) const;
    Segment3d own_edge(std::size_t i) const { return {corners_[i], corners_[(i + 1) % 3]}; }
    bool is_along_own_edge(const Segment3d& edge) const;
    void list_places_on(const Segment3d& edge);
    void list_meeting(const Segment3d& edge, const Segment3d& other);
    bool left_of(const Place& place, const Segment3d& way, const Visit& visit) const;

    Triangle3d corners_;  // counterclockwise along axis_
    unsigned axis_;
    std::vector<Segment3d> edges_;  // each with its lexicographically smaller end first
    double longest_ = 0;            // greatest extent of an edge along x
    std::vector<Place> places_;     // places that list_places_on() found on the current edge
};

}  // namespace octopair
