// DxfTransform: where the entities of a DXF block are in the world.
#pragma once

#include <array>

#include "io/meshes/content/dxf_entities.hpp"

namespace octopair::io {

class DxfTransform {
public:
    /// Returns the transform that changes nothing.
    DxfTransform() = default;
    static DxfTransform move(const DxfPoint& by);
    static DxfTransform scale(const DxfPoint& by);
    /// Turns around z.
    static DxfTransform turn(double degrees);
    /// From the coordinates of an entity to those of the world, for the direction of extrusion of the entity (arbitrary axis algorithm).
    /// A direction of length 0 changes nothing.
    static DxfTransform from_entity(const DxfPoint& extrusion);

    DxfTransform operator*(const DxfTransform& first) const;
    DxfPoint operator*(const DxfPoint& point) const;

private:
    using Rows = std::array<std::array<double, 4>, 3>;
    explicit DxfTransform(const Rows& rows) : rows_(rows) {}

    Rows rows_ = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
};

}  // namespace octopair::io
