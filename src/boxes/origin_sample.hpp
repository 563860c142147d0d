// OriginSample: chooses the origin of outward rounding (outward_rounding.hpp) from a sample of the objects.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "base/private_export.hpp"

namespace octopair {

/// Positions of the objects that give the origin of outward rounding: the median of their low corners. The median is near the
/// bulk of the objects, even if a few objects are far away.
struct OCTOPAIR_PRIVATE_EXPORT OriginSample {
    using Corner = std::array<double, 3>;
    std::size_t objects;

    std::size_t size() const { return objects < most ? objects : most; }
    std::size_t operator[](std::size_t i) const { return i * objects / size(); }
    /// Ignores coordinates that are not finite. Returns 0 on an axis without finite coordinates.
    static std::array<double, 4> median(std::span<const Corner> corners);

private:
    static constexpr std::size_t most = 255;
};

}  // namespace octopair
