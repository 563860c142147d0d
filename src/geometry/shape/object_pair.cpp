#include "geometry/shape/object_pair.hpp"

#include "geometry/shape/mesh_contacts.hpp"
#include "geometry/shape/mesh_pair.hpp"

namespace octopair {

namespace {

bool judge_meshes(const PosedMesh& a, const PosedMesh& b, double reach, Finding& finding) {
    if (surfaces_meet(a, b)) {
        finding.collision_class = CollisionClass::collision;
        return true;
    }
    if (encloses_part(a, b) || encloses_part(b, a)) {
        finding.collision_class = CollisionClass::contained;
        return true;
    }
    if (!(reach > 0)) return false;
    const auto gap = surface_gap(a, b, reach);
    if (!gap) return false;
    finding.collision_class = CollisionClass::clearance;
    finding.distance = gap->distance;
    finding.nearest = gap->nearest;
    return true;
}

}  // namespace

bool judge_objects(const PosedObject& a, const PosedObject& b, double reach, Finding& finding) {
    return judge_meshes({*a.geometry.tree, a.pose}, {*b.geometry.tree, b.pose}, reach, finding);
}

}  // namespace octopair
