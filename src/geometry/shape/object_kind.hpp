// What a posed object is to the tests of pairs: a mesh, a convex solid or a plane.
#pragma once

#include <cstdint>
#include <variant>

#include "geometry/shape/convex_pair.hpp"
#include "geometry/shape/mesh_convex.hpp"
#include "geometry/shape/object_pair.hpp"
#include "geometry/shape/posed_plane.hpp"

namespace octopair {

enum class Kind : std::uint8_t { mesh, solid, plane };

inline Kind kind_of(const PosedObject& object) {
    if (std::holds_alternative<shape::Mesh>(object.geometry.shape)) return Kind::mesh;
    return object.geometry.convex.exists() ? Kind::solid : Kind::plane;
}

// Of objects of that kind, borrowed.

inline PosedMesh mesh_of(const PosedObject& object) { return {*object.geometry.tree, object.pose}; }
inline PosedConvex solid_of(const PosedObject& object) { return {object.geometry.convex, object.pose}; }
inline BoxedSolid boxed_solid_of(const PosedObject& object) {
    return {object.geometry.convex, {*object.geometry.tree, object.pose}};
}
inline PosedPlane plane_of(const PosedObject& object) {
    return posed_plane(std::get<shape::Plane>(object.geometry.shape), object.pose);
}

}  // namespace octopair
