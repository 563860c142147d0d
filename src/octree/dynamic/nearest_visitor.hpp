// NearestVisitor: something that is looked for in a MutableOctree, nearest first.
#pragma once

#include <cstdint>

#include "octopair/objects.hpp"

namespace octopair {

class NearestVisitor {
public:
    virtual ~NearestVisitor() = default;
    /// At most what any object could be away whose box reaches into a region (of the octree's coordinates, perhaps
    /// infinite); more than limit() if none is wanted.
    virtual double at_least(const Box3d& region) const = 0;
    /// What is farther away is of no interest any more.
    virtual double limit() const = 0;
    /// Maybe more than once for an object.
    virtual void take(std::uint32_t object) = 0;
};

}  // namespace octopair
