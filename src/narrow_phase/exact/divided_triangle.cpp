#include "narrow_phase/exact/divided_triangle.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "narrow_phase/exact/orientation.hpp"

namespace octopair {

DividedTriangle::DividedTriangle(const Triangle3d& triangle, const Projection& projection)
    : corners_(triangle), axis_(projection.axis) {
    if (projection.side < 0) std::swap(corners_[1], corners_[2]);
}

int DividedTriangle::side(const Segment3d& line, const Point3d& point) const {
    return line_side(line[0], line[1], point, axis_);
}

bool DividedTriangle::is_along_own_edge(const Segment3d& edge) const {
    for (std::size_t i = 0; i < 3; ++i) {
        if (side(own_edge(i), edge[0]) == 0 && side(own_edge(i), edge[1]) == 0) return true;
    }
    return false;
}

void DividedTriangle::divide(const Triangle3d& other) {
    const PlaneSides plane(corners_);
    std::array<bool, 3> in_plane;
    for (std::size_t i = 0; i < 3; ++i) in_plane[i] = plane(other[i]) == 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const Point3d &from = other[i], &to = other[(i + 1) % 3];
        if (!in_plane[i] || !in_plane[(i + 1) % 3] || from == to || is_along_own_edge({from, to})) continue;
        edges_.push_back(from < to ? Segment3d{from, to} : Segment3d{to, from});
        longest_ = std::max(longest_, edges_.back()[1][0] - edges_.back()[0][0]);
    }
}

bool DividedTriangle::any_face(const Visit& visit) {
    std::sort(edges_.begin(), edges_.end());
    edges_.erase(std::unique(edges_.begin(), edges_.end()), edges_.end());
    // Without edges there is one face, and a point near any corner lies in it. So one corner is enough.
    for (std::size_t i = 0; i < (edges_.empty() ? 1 : 3); ++i) {
        const NearbyPoint point(Place::at(corners_[i]), corners_[(i + 1) % 3], corners_[(i + 2) % 3], axis_);
        if (visit(point)) return true;
    }
    for (const Segment3d& edge : edges_) {
        list_places_on(edge);
        for (const Place& place : places_) {
            if (left_of(place, edge, visit) || left_of(place, {edge[1], edge[0]}, visit)) return true;
        }
    }
    return false;
}

/// Lists the places on an edge at which the face on either side of the edge may change: its ends, and its meetings with other edges.
void DividedTriangle::list_places_on(const Segment3d& edge) {
    places_ = {Place::at(edge[0]), Place::at(edge[1])};
    for (std::size_t i = 0; i < 3; ++i) list_meeting(edge, own_edge(i));
    // Edges are sorted by the x of their begins. An edge whose begin is more than `longest_` below the begin of this edge also ends
    // before this edge, so the search skips it. The factor covers the rounding of the difference.
    const double first = edge[0][0] - longest_ * (1 + 1e-12);
    const auto begins_before = [](const Segment3d& other, double x) { return other[0][0] < x; };
    for (auto other = std::lower_bound(edges_.begin(), edges_.end(), std::nextafter(first, -HUGE_VAL), begins_before);
         other != edges_.end() && (*other)[0][0] <= edge[1][0]; ++other) {
        list_meeting(edge, *other);
    }
}

void DividedTriangle::list_meeting(const Segment3d& edge, const Segment3d& other) {
    if (!boxes_meet(edge, other) || edge == other) return;
    const int begin = side(edge, other[0]), end = side(edge, other[1]);
    for (const auto& [at, point] : {std::pair(begin, other[0]), std::pair(end, other[1])}) {
        const Segment3d spot{point, point};
        if (at == 0 && boxes_meet(edge, spot) && point != edge[0] && point != edge[1]) {
            places_.push_back(Place::at(point));
        }
    }
    if (begin * end < 0 && side(other, edge[0]) * side(other, edge[1]) < 0) {
        places_.push_back(Place::of(edge, other, axis_));
    }
}

/// Visits the face to the left of an edge, just after `place` on the way from way[0] to way[1]. Does nothing if this face is outside the
/// triangle.
bool DividedTriangle::left_of(const Place& place, const Segment3d& way, const Visit& visit) const {
    if (!place.crossing && place.on[0] == way[1]) return false;
    const auto left =
        std::find_if(corners_.begin(), corners_.end(), [&](const Point3d& corner) { return side(way, corner) > 0; });
    if (left == corners_.end()) return false;
    const NearbyPoint point(place, way[1], *left, axis_);
    for (std::size_t i = 0; i < 3; ++i) {
        if (point.line_side(corners_[i], corners_[(i + 1) % 3], axis_) <= 0) return false;
    }
    return visit(point);
}

}  // namespace octopair
