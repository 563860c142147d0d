// Kind: the class of objects that decides which pair test applies: mesh, convex solid or plane.
#pragma once

#include <cstdint>
#include <variant>

#include "narrow_phase/convex/convex_pair.hpp"
#include "narrow_phase/convex/posed_plane.hpp"
#include "narrow_phase/mesh/mesh_convex.hpp"
#include "narrow_phase/object_pair.hpp"

namespace octopair {

enum class Kind : std::uint8_t { mesh, solid, plane };

inline Kind kind_of(const PosedObject& object) {
    if (std::holds_alternative<shape::Mesh>(object.geometry.shape)) return Kind::mesh;
    return object.geometry.convex.exists() ? Kind::solid : Kind::plane;
}

// Views of an object, borrowed. Each requires that the object is of that kind.

inline PosedMesh mesh_of(const PosedObject& object) { return {*object.geometry.tree, object.pose}; }
inline PosedConvex solid_of(const PosedObject& object) { return {object.geometry.convex, object.pose}; }
inline BoxedSolid boxed_solid_of(const PosedObject& object) {
    return {object.geometry.convex, {*object.geometry.tree, object.pose}};
}
inline PosedPlane plane_of(const PosedObject& object) {
    return posed_plane(std::get<shape::Plane>(object.geometry.shape), object.pose);
}

}  // namespace octopair
