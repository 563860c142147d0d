#include "narrow_phase/mesh/mesh_interiors.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include "narrow_phase/exact/nearby_point.hpp"
#include "narrow_phase/exact/orientation.hpp"
#include "narrow_phase/exact/segment_pair.hpp"

namespace octopair {

namespace {

/// A triangle with an area, and the edges of other triangles that lie in its plane. Visits a point in each of its faces.
class DividedTriangle {
public:
    /// `projection`: projection_of(triangle), in which the triangle has an area.
    DividedTriangle(const Triangle3d& triangle, const Projection& projection)
        : corners_(triangle), axis_(projection.axis) {
        if (projection.side < 0) std::swap(corners_[1], corners_[2]);
    }

    /// Adds the edges of a triangle that lie in the plane, except those along an edge of this triangle: they divide nothing.
    void divide(const Triangle3d& other) {
        const PlaneSides plane(corners_);
        std::array<bool, 3> in_plane;
        for (std::size_t i = 0; i < 3; ++i) in_plane[i] = plane(other[i]) == 0;
        for (std::size_t i = 0; i < 3; ++i) {
            const Point3d &from = other[i], &to = other[(i + 1) % 3];
            if (!in_plane[i] || !in_plane[(i + 1) % 3] || from == to || is_along_own_edge({from, to})) continue;
            edges_.push_back(from < to ? Segment3d{from, to} : Segment3d{to, from});
        }
    }

    /// Calls visit(point) for a point in each face, until it returns true. Returns whether it did.
    template <typename Visit>
    bool any_face(const Visit& visit) {
        std::sort(edges_.begin(), edges_.end());
        edges_.erase(std::unique(edges_.begin(), edges_.end()), edges_.end());
        // Without edges there is one face, and any corner will do.
        for (std::size_t i = 0; i < (edges_.empty() ? 1 : 3); ++i) {
            const NearbyPoint point(Place::at(corners_[i]), corners_[(i + 1) % 3], corners_[(i + 2) % 3], axis_);
            if (visit(point)) return true;
        }
        for (const Segment3d& edge : edges_) {
            list_places_on(edge);
            for (const Place& place : places_) {
                if (left_of(place, edge[0], edge[1], visit) || left_of(place, edge[1], edge[0], visit)) return true;
            }
        }
        return false;
    }

private:
    int side(const Segment3d& line, const Point3d& point) const { return line_side(line[0], line[1], point, axis_); }
    Segment3d own_edge(std::size_t i) const { return {corners_[i], corners_[(i + 1) % 3]}; }
    bool is_along_own_edge(const Segment3d& edge) const {
        for (std::size_t i = 0; i < 3; ++i) {
            if (side(own_edge(i), edge[0]) == 0 && side(own_edge(i), edge[1]) == 0) return true;
        }
        return false;
    }

    static bool boxes_meet(const Segment3d& s, const Segment3d& t) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (std::max(s[0][axis], s[1][axis]) < std::min(t[0][axis], t[1][axis])) return false;
            if (std::max(t[0][axis], t[1][axis]) < std::min(s[0][axis], s[1][axis])) return false;
        }
        return true;
    }

    /// Lists the places of an edge at which the faces beside it change: its ends, and where other edges cross it or end on it.
    void list_places_on(const Segment3d& edge) {
        places_ = {Place::at(edge[0]), Place::at(edge[1])};
        for (std::size_t i = 0; i < 3; ++i) list_meeting(edge, own_edge(i));
        for (const Segment3d& other : edges_) list_meeting(edge, other);
    }

    void list_meeting(const Segment3d& edge, const Segment3d& other) {
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

    /// Visits the face to the left of the way from `place` to `to`, if it is in the triangle. `from` and `to` are the ends of
    /// the edge.
    template <typename Visit>
    bool left_of(const Place& place, const Point3d& from, const Point3d& to, const Visit& visit) const {
        if (!place.crossing && place.on[0] == to) return false;
        const auto left = std::find_if(corners_.begin(), corners_.end(), [&](const Point3d& corner) {
            return side({from, to}, corner) > 0;
        });
        if (left == corners_.end()) return false;
        const NearbyPoint point(place, to, *left, axis_);
        for (std::size_t i = 0; i < 3; ++i) {
            if (point.line_side(corners_[i], corners_[(i + 1) % 3], axis_) <= 0) return false;
        }
        return visit(point);
    }

    Triangle3d corners_;  // counterclockwise along axis_
    unsigned axis_;
    std::vector<Segment3d> edges_;
    std::vector<Place> places_;
};

/// One mesh of a pair as seen by the other.
struct View {
    const PosedMesh& own;
    const PosedMesh& other;
    std::uint32_t TouchingTriangles::*own_place;
    std::uint32_t TouchingTriangles::*other_place;
};

/// Returns true if the face of the own mesh that `point` is in lies inside the other mesh, or on its surface with the interiors of
/// both on the same side.
bool face_meets(const View& view, NearbyPoint point) {
    std::array<bool, 2> inside;
    for (const std::size_t i : {0U, 1U}) {
        point.sense = i == 0 ? 1 : -1;
        inside[i] = encloses(view.other, point);
    }
    if (inside[0] == inside[1]) return inside[0];
    point.sense = inside[0] ? 1 : -1;
    return encloses(view.own, point);
}

/// Returns true if a face of an own triangle that touches meets the interior of the other mesh.
bool faces_meet(const View& view, std::vector<TouchingTriangles> touching, const std::stop_token& stop) {
    if (!view.other.tree.parts.any_closed) return false;
    std::sort(touching.begin(), touching.end(), [&](const TouchingTriangles& x, const TouchingTriangles& y) {
        return x.*view.own_place < y.*view.own_place;
    });
    for (std::size_t begin = 0, end = 0; begin < touching.size() && !stop.stop_requested(); begin = end) {
        const std::uint32_t place = touching[begin].*view.own_place;
        while (end < touching.size() && touching[end].*view.own_place == place) ++end;
        const Triangle3d triangle = view.own.tree.world_triangle(view.own.pose, place);
        const Projection projection = projection_of(triangle);
        if (projection.axis == 3) continue;  // the faces of its neighbours reach all its points
        DividedTriangle divided(triangle, projection);
        for (std::size_t i = begin; i < end; ++i) {
            divided.divide(view.other.tree.world_triangle(view.other.pose, touching[i].*view.other_place));
        }
        if (divided.any_face([&](const NearbyPoint& point) { return face_meets(view, point); })) return true;
    }
    return false;
}

/// Returns true if a part of the own mesh that touches nothing lies inside the other mesh.
bool part_is_inside(const View& view, std::span<const TouchingTriangles> touching) {
    const MeshParts& parts = view.own.tree.parts;
    std::vector<bool> touches(parts.corners.size());
    for (const TouchingTriangles& pair : touching) touches[parts.numbers[pair.*view.own_place]] = true;
    for (std::size_t part = 0; part < touches.size(); ++part) {
        if (!touches[part] && encloses(view.other, vector::posed(view.own.pose, parts.corners[part]))) return true;
    }
    return false;
}

/// Returns the side of the plane on which all triangles of a mesh lie, 1 or -1; or 0 if they lie on both sides or in the plane.
int side_of_mesh(const PlaneSides& plane, const PosedMesh& mesh) {
    int all = 0;
    for (const auto& corners : mesh.tree.triangles) {
        for (const std::uint32_t corner : corners) {
            const int side = plane(vector::posed(mesh.pose, mesh.tree.vertices[corner]));
            if (side * all < 0) return 0;
            all += all == 0 ? side : 0;
        }
    }
    return all;
}

/// Returns true if the plane of a triangle that touches separates the meshes. Tries a few only.
bool are_separated(const PosedMesh& a, const PosedMesh& b, std::span<const TouchingTriangles> touching) {
    constexpr std::size_t tries = 4;
    for (std::size_t i = 0; i < tries && i < touching.size(); ++i) {
        const TouchingTriangles& pair = touching[i * touching.size() / std::min(tries, touching.size())];
        for (const Triangle3d& triangle :
             {a.tree.world_triangle(a.pose, pair.a), b.tree.world_triangle(b.pose, pair.b)}) {
            if (projection_of(triangle).axis == 3) continue;
            const PlaneSides plane(triangle);
            const int side = side_of_mesh(plane, a);
            if (side != 0 && side_of_mesh(plane, b) == -side) return true;
        }
    }
    return false;
}

}  // namespace

bool interiors_meet(const PosedMesh& a, const PosedMesh& b, std::span<const TouchingTriangles> touching,
                    const std::stop_token& stop) {
    if (!a.tree.parts.any_closed && !b.tree.parts.any_closed) return false;
    if (are_separated(a, b, touching)) return false;
    const View of_a{a, b, &TouchingTriangles::a, &TouchingTriangles::b};
    const View of_b{b, a, &TouchingTriangles::b, &TouchingTriangles::a};
    if (part_is_inside(of_a, touching) || part_is_inside(of_b, touching)) return true;
    const std::vector<TouchingTriangles> pairs(touching.begin(), touching.end());
    return faces_meet(of_a, pairs, stop) || faces_meet(of_b, pairs, stop);
}

}  // namespace octopair
