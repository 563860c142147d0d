// Contacts of two meshes that meet: class, depth and contacts.
//
// Class     Penetrating if two triangles pass through each other, or if the interiors meet (mesh_interiors.cpp); otherwise
//           touching. Exact.
// Depth     Of two convex meshes the least translation that separates them. Of others a lower bound: the largest distance
//           from a sample inside the other mesh to the other's surface, or the depth of the deepest contact.
// Samples   Corners and centroids of the triangles of one mesh, and the centre of its bounding box if it is inside the mesh.
// Contacts  One for each pair of triangles that meet: the mean of their common points, with the normal and the depth of
//           these two triangles alone. Sorted by descending depth, then by the numbers of the triangles.
#include "narrow_phase/mesh/mesh_contacts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "geometry/vector.hpp"
#include "narrow_phase/convex/convex_pair.hpp"
#include "narrow_phase/exact/triangle_contact.hpp"
#include "narrow_phase/mesh/deepest_contacts.hpp"
#include "narrow_phase/mesh/mesh_leaves.hpp"
#include "narrow_phase/mesh/mesh_pair.hpp"
#include "narrow_phase/mesh/mesh_probe.hpp"

namespace octopair {

namespace {

Box3d world_box(const PosedMesh& mesh) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    Box3d box{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
    for (const auto& corners : mesh.tree.triangles) {
        for (const std::uint32_t corner : corners) {
            const Point3d place = vector::posed(mesh.pose, mesh.tree.vertices[corner]);
            for (int axis = 0; axis < 3; ++axis) {
                box.min[axis] = std::min(box.min[axis], place[axis]);
                box.max[axis] = std::max(box.max[axis], place[axis]);
            }
        }
    }
    return box;
}

bool contains(const Box3d& box, const Point3d& point) {
    for (int axis = 0; axis < 3; ++axis) {
        if (point[axis] < box.min[axis] || point[axis] > box.max[axis]) return false;
    }
    return true;
}

Point3d middle_of_box(const Box3d& box) {
    Point3d middle;
    for (int axis = 0; axis < 3; ++axis) middle[axis] = box.min[axis] / 2 + box.max[axis] / 2;
    return middle;
}

/// Finds the depth of the deepest sample of another mesh inside the mesh `outer`.
class DepthSearch {
public:
    DepthSearch(const PosedMesh& outer, const std::stop_token& stop)
        : outer_(outer), stop_(stop), box_(world_box(outer)), probe_(outer) {}

    double deepest(const PosedMesh& inner) {
        if (!outer_.tree.parts.any_closed) return 0;
        const Point3d middle = middle_of_box(world_box(inner));
        if (contains(box_, middle) && probe_.distance(middle, 0) > 0 && encloses(inner, middle)) test_place(middle);
        const std::vector<Point3d> places = places_of(inner);
        // Test every 64th place first: a large depth found early makes the tests of most other places cheap.
        for (const std::size_t step : {std::size_t(64), std::size_t(1)}) {
            for (std::size_t i = 0; i < places.size() && !stop_.stop_requested(); i += step) test_place(places[i]);
        }
        return deepest_;
    }

private:
    /// Returns those corners and centroids of triangles of `inner` that lie in the box of `outer`. Neighbouring places follow one another,
    /// because SurfaceProbe is then faster.
    std::vector<Point3d> places_of(const PosedMesh& inner) const {
        std::vector<Point3d> places;
        std::vector<bool> seen(inner.tree.vertices.size());
        const auto add = [&](const Point3d& place) {
            if (contains(box_, place)) places.push_back(place);
        };
        for (std::uint32_t i = 0; i < inner.tree.triangles.size(); ++i) {
            const Triangle3d triangle = inner.tree.world_triangle(inner.pose, i);
            for (int corner = 0; corner < 3; ++corner) {
                const std::uint32_t vertex = inner.tree.triangles[i][corner];
                if (!seen[vertex]) add(triangle[corner]);
                seen[vertex] = true;
            }
            add(middle_of(triangle));
        }
        return places;
    }

    /// Updates deepest_ if `place` is deeper. Runs cheap tests first, because few places are deeper than all places before.
    void test_place(const Point3d& place) {
        if (vector::length(vector::minus(place, outside_)) < outside_radius_) return;
        const double distance = probe_.distance(place, deepest_);
        if (distance <= deepest_) return;
        if (encloses(outer_, place)) {
            deepest_ = distance;
        } else {
            outside_ = place, outside_radius_ = distance * (1 - 1e-9);
        }
    }

    const PosedMesh& outer_;
    const std::stop_token& stop_;
    Box3d box_;
    SurfaceProbe probe_;
    double deepest_ = 0;
    // A ball around the last place that was found outside. The ball does not reach the surface, so each place in it is outside, too.
    Point3d outside_ = {};
    double outside_radius_ = 0;
};

class ContactSearch {
public:
    ContactSearch(const PosedMesh& a, const PosedMesh& b, const ContactRequest& request)
        : a_(a), b_(b), request_(request), contacts_(request.max_contacts) {}

    void run(Finding& finding) {
        visit_meeting_triangles(a_, b_, [&](const MeetingTriangles& at) {
            add(at);
            return !request_.stop.stop_requested();
        });
        const bool penetrating = crossing_ || interiors_meet(a_, b_, touching_, request_.stop);
        finding.collision_class = penetrating ? CollisionClass::penetrating : CollisionClass::touching;
        if (penetrating) {
            set_depth_of_meshes(a_, b_, request_, finding);
            if (finding.depth_kind == DepthKind::at_least) finding.depth = std::max(finding.depth, deepest_);
        } else {
            finding.depth = 0;
            finding.depth_kind = DepthKind::least;
        }
        contacts_.give(finding);
    }

private:
    void add(const MeetingTriangles& at) {
        const TriangleContact contact = triangle_contact(at.a, at.b);
        crossing_ |= contact.meeting == TriangleMeeting::crossing;
        if (!crossing_) touching_.push_back({at.place_a, at.place_b});
        Contact made = contact_of(at.a, at.b, contact);
        deepest_ = std::max(deepest_, made.depth);
        made.feature_a = at.number_a;
        made.feature_b = at.number_b;
        contacts_.add(made);
    }

    const PosedMesh &a_, &b_;
    const ContactRequest& request_;
    bool crossing_ = false;                    // triangles pass through each other
    std::vector<TouchingTriangles> touching_;  // all pairs of triangles that meet; incomplete once crossing_ is true
    double deepest_ = 0;                       // depth of the deepest contact, also of contacts beyond max_contacts
    DeepestContacts contacts_;
};

}  // namespace

bool meshes_penetrate(const PosedMesh& a, const PosedMesh& b, const std::stop_token& stop) {
    bool crossing = false;
    std::vector<TouchingTriangles> touching;
    visit_meeting_triangles(a, b, [&](const MeetingTriangles& at) {
        crossing = triangle_contact(at.a, at.b).meeting == TriangleMeeting::crossing;
        touching.push_back({at.place_a, at.place_b});
        return !crossing && !stop.stop_requested();
    });
    if (crossing) return true;
    if (touching.empty()) return encloses_part(a, b) || encloses_part(b, a);
    return interiors_meet(a, b, touching, stop);
}

void set_depth_of_meshes(const PosedMesh& a, const PosedMesh& b, const ContactRequest& request, Finding& finding) {
    if (is_solid(a, request.max_error) && is_solid(b, request.max_error)) {
        finding.depth = convex_contact({a.tree.solid, a.pose}, {b.tree.solid, b.pose}).depth;
        finding.depth_kind = DepthKind::least;
        return;
    }
    finding.depth_kind = DepthKind::at_least;
    if (a.tree.nodes.empty() || b.tree.nodes.empty()) return;
    finding.depth = std::max(DepthSearch(a, request.stop).deepest(b), DepthSearch(b, request.stop).deepest(a));
}

void find_mesh_contacts(const PosedMesh& a, const PosedMesh& b, const ContactRequest& request, Finding& finding) {
    ContactSearch(a, b, request).run(finding);
}

}  // namespace octopair
