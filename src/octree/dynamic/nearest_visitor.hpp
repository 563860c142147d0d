// NearestVisitor: a search of a MutableOctree for near objects, nearest regions first.
#pragma once

#include <cstdint>

#include "octopair/objects.hpp"

namespace octopair {

class NearestVisitor {
public:
    virtual ~NearestVisitor() = default;
    /// Returns a lower bound on the distance to every object whose box reaches into `region`; a value above limit() if none
    /// of them is wanted. The region is in the octree's coordinates and may be infinite.
    virtual double at_least(const Box3d& region) const = 0;
    /// Returns the distance beyond which objects are not wanted. May shrink during the search.
    virtual double limit() const = 0;
    /// Receives an object that may be near enough. May be called more than once for an object.
    virtual void take(std::uint32_t object) = 0;
};

}  // namespace octopair
