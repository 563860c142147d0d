#include "narrow_phase/thickness/overlap_surface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "narrow_phase/mesh/mesh_leaves.hpp"
#include "narrow_phase/mesh/world_boxes.hpp"

namespace octopair {

namespace {

constexpr std::size_t max_parts = 32;

/// Returns the bounding box of points. Requires: there is a point.
template <typename Points>
Box3d box_of(const Points& points) {
    const Point3d& first = points[0];
    Box3d box{{first[0], first[1], first[2]}, {first[0], first[1], first[2]}};
    for (const Point3d& point : points) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            box.min[axis] = std::min(box.min[axis], point[axis]);
            box.max[axis] = std::max(box.max[axis], point[axis]);
        }
    }
    return box;
}

/// Returns a box around the mesh, from the root of its hierarchy.
Box3d root_box(const PosedMesh& mesh) {
    const WorldBoxes boxes(mesh);
    Box3d box;
    for (int row = 0; row < 3; ++row) {
        const auto [low, high] = boxes.span(mesh.tree.nodes[0], row);
        box.min[row] = low, box.max[row] = high;
    }
    return box;
}

Box3d common_box_of(const Box3d& a, const Box3d& b) {
    Box3d common;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        common.min[axis] = std::max(a.min[axis], b.min[axis]);
        common.max[axis] = std::min(a.max[axis], b.max[axis]);
    }
    return common;
}

/// Calls visit(place in the tree's order) for each triangle of leaves whose boxes overlap `box`.
template <typename Visit>
void visit_triangles_near(const PosedMesh& mesh, const Box3d& box, const Visit& visit) {
    const WorldBoxes boxes(mesh);
    NodeStack<std::uint32_t> waiting;
    waiting.push(0);
    while (!waiting.empty()) {
        const MeshNode& node = mesh.tree.nodes[waiting.pop()];
        bool apart = false;
        for (int row = 0; row < 3; ++row) {
            const auto [low, high] = boxes.span(node, row);
            apart |= low > box.max[row] || high < box.min[row];
        }
        if (apart) continue;
        if (!node.is_leaf()) {
            waiting.push(node.first + 1);
            waiting.push(node.first);
            continue;
        }
        for (std::uint32_t i = node.first; i < node.first + node.count; ++i) visit(i);
    }
}

/// Sets box and plane of a triangle. Returns false if the triangle has no area: the triangles around it reach all its points.
bool set_plane(NearTriangle& triangle) {
    const auto& [p, q, r] = triangle.corners;
    const Point3d normal = vector::cross(vector::minus(q, p), vector::minus(r, p));
    const double length = vector::length(normal);
    if (!(length > 0)) return false;
    triangle.plane.normal = vector::times(normal, 1 / length);
    triangle.plane.offset = vector::dot(triangle.plane.normal, p);
    triangle.box = box_of(triangle.corners);
    return true;
}

/// Returns the index of the triangle at a place of the tree's order; nothing if it is not near.
std::optional<std::uint32_t> index_of(const std::vector<NearTriangle>& triangles, std::uint32_t place) {
    const auto at = std::lower_bound(triangles.begin(), triangles.end(), place,
                                     [](const NearTriangle& triangle, std::uint32_t p) { return triangle.place < p; });
    if (at == triangles.end() || at->place != place) return std::nullopt;
    return std::uint32_t(at - triangles.begin());
}

/// Returns whether the polygon lies in the plane.
bool lies_in(const Polygon& polygon, const CutPlane& plane, double rounding) {
    const auto [low, high] = extent_along(plane.normal, polygon);
    return low >= plane.offset - rounding && high <= plane.offset + rounding;
}

/// Returns whether two planes are the same but for the last bits. Planes that are called different cost time only.
bool are_same(const CutPlane& a, const CutPlane& b) {
    const double sense = vector::dot(a.normal, b.normal) < 0 ? -1 : 1;
    return a.normal == vector::times(b.normal, sense) && a.offset == sense * b.offset;
}

/// Replaces each polygon by its parts on the two sides of the plane.
void cut_all(std::vector<Polygon>& polygons, const CutPlane& plane, double rounding) {
    const std::size_t count = polygons.size();
    for (std::size_t i = 0; i < count; ++i) {
        SplitPolygon parts = split(polygons[i], plane, rounding);
        if (parts.below.empty() || parts.above.empty()) continue;
        polygons[i] = std::move(parts.below);
        polygons.push_back(std::move(parts.above));
    }
}

}  // namespace

OverlapSurface::OverlapSurface(const PosedMesh& a, const PosedMesh& b, double reach) : meshes_{&a, &b}, reach_(reach) {
    common_ = common_box_of(root_box(a), root_box(b));
    double largest = reach;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        largest = std::max({largest, std::abs(common_.min[axis]), std::abs(common_.max[axis])});
        centre_[axis] = common_.min[axis] / 2 + common_.max[axis] / 2;
        common_.min[axis] -= centre_[axis];
        common_.max[axis] -= centre_[axis];
    }
    rounding_ = largest * 0x1p-44;
    // Not finite beyond the range of float32. Then nothing is near, and the caller must not decide anything.
    if (!std::isfinite(rounding_ + centre_[0] + centre_[1] + centre_[2])) {
        rounding_ = std::numeric_limits<double>::infinity();
    }
}

void OverlapSurface::find_triangles() {
    find_near();
    find_meetings();
}

void OverlapSurface::find_near() {
    Box3d near = common_;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        near.min[axis] += centre_[axis] - reach_ - rounding_;
        near.max[axis] += centre_[axis] + reach_ + rounding_;
    }
    for (const unsigned number : {0U, 1U}) {
        const PosedMesh& mesh = *meshes_[number];
        OverlapSide& side = sides_[number];
        visit_triangles_near(mesh, near, [&](std::uint32_t place) {
            NearTriangle triangle;
            triangle.corners = mesh.tree.world_triangle(mesh.pose, place);
            for (Point3d& corner : triangle.corners) corner = vector::minus(corner, centre_);
            triangle.place = place;
            if (set_plane(triangle)) side.triangles.push_back(triangle);
        });
        std::sort(side.triangles.begin(), side.triangles.end(),
                  [](const NearTriangle& x, const NearTriangle& y) { return x.place < y.place; });
    }
}

void OverlapSurface::find_meetings() {
    std::array<std::vector<std::pair<std::uint32_t, std::uint32_t>>, 2> meetings;
    visit_meeting_triangles(*meshes_[0], *meshes_[1], [&](const MeetingTriangles& at) {
        const auto a = index_of(sides_[0].triangles, at.place_a), b = index_of(sides_[1].triangles, at.place_b);
        if (!a || !b) return true;
        meetings[0].emplace_back(*a, *b);
        meetings[1].emplace_back(*b, *a);
        return true;
    });
    for (const unsigned number : {0U, 1U}) {
        OverlapSide& side = sides_[number];
        std::sort(meetings[number].begin(), meetings[number].end());
        for (const auto& [own, other] : meetings[number]) {
            NearTriangle& triangle = side.triangles[own];
            if (triangle.met_begin == triangle.met_end) triangle.met_begin = std::uint32_t(side.met.size());
            side.met.push_back(other);
            triangle.met_end = std::uint32_t(side.met.size());
            triangle.membership = Membership::meets;
        }
    }
}

NearLists OverlapSurface::all_near() const {
    NearLists all;
    for (const std::size_t side : {0U, 1U}) {
        all[side].resize(sides_[side].triangles.size());
        std::iota(all[side].begin(), all[side].end(), 0U);
    }
    return all;
}

Membership OverlapSurface::membership(unsigned side, NearTriangle& triangle) const {
    if (triangle.membership == Membership::unknown) {
        const PosedMesh& own = *meshes_[side];
        const bool inside = encloses(*meshes_[1 - side], own.tree.world_triangle(own.pose, triangle.place)[0]);
        triangle.membership = inside ? Membership::inside : Membership::outside;
    }
    return triangle.membership;
}

bool OverlapSurface::find_pieces(const Box3d& box, const NearLists& near, std::size_t most, FoundPieces& found) {
    for (const unsigned side : {0U, 1U}) {
        for (const std::uint32_t i : near[side]) {
            NearTriangle& triangle = sides_[side].triangles[i];
            if (!boxes_overlap(triangle.box, box)) continue;
            const Polygon polygon = clipped(triangle.corners, box);
            if (polygon.empty() || membership(side, triangle) == Membership::outside) continue;
            found.near[side].push_back(i);
            if (found.pieces.size() <= most) add_pieces(side, triangle, polygon, found.pieces);
        }
    }
    return found.pieces.size() <= most;
}

void OverlapSurface::add_pieces(unsigned side, const NearTriangle& triangle, const Polygon& polygon,
                                std::vector<Piece>& pieces) const {
    const OverlapSide &own = sides_[side], &other = sides_[1 - side];
    const Box3d box = box_of(polygon.corners);
    std::vector<Polygon> parts = {polygon};
    std::vector<const CutPlane*> cuts;
    bool on_surface = false;
    for (std::uint32_t i = triangle.met_begin; i < triangle.met_end; ++i) {
        const NearTriangle& met = other.triangles[own.met[i]];
        if (!boxes_overlap(met.box, box)) continue;
        if (lies_in(polygon, met.plane, rounding_)) {
            on_surface = true;
            continue;
        }
        const auto same = [&](const CutPlane* plane) { return are_same(*plane, met.plane); };
        if (std::any_of(cuts.begin(), cuts.end(), same)) continue;
        cuts.push_back(&met.plane);
        cut_all(parts, met.plane, rounding_);
        // A polygon in many parts is rare in small boxes; undivided, it counts as inside.
        if (parts.size() > max_parts) {
            parts = {polygon};
            on_surface = true;
            break;
        }
    }
    const bool decided = cuts.empty() && triangle.membership != Membership::meets;
    for (Polygon& part : parts) {
        if (!decided && !on_surface && !in_solid(1 - side, middle_of(part))) continue;
        const double area = area_of(part);
        pieces.push_back({std::move(part), triangle.plane.normal, area, side});
    }
}

}  // namespace octopair
