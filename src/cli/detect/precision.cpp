#include "cli/detect/precision.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace octopair::cli {

namespace {

/// Largest coordinate of a set, by its absolute value, and the largest extent along an axis. 0 for an empty set.
struct Extent {
    double coordinate = 0, size = 0;
};

Extent extent_of(const InputSet& set) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    std::array<double, 3> low{infinity, infinity, infinity}, high{-infinity, -infinity, -infinity};
    std::visit(
        [&](const auto& boxes) {
            for (const auto& box : boxes.span()) {
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    low[axis] = std::min(low[axis], double(box.min[axis]));
                    high[axis] = std::max(high[axis], double(box.max[axis]));
                }
            }
        },
        set.scene.boxes);
    Extent extent;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (!(low[axis] <= high[axis])) continue;
        extent.coordinate = std::max({extent.coordinate, std::fabs(low[axis]), std::fabs(high[axis])});
        extent.size = std::max(extent.size, high[axis] - low[axis]);
    }
    return extent;
}

/// Returns the distance between neighbouring numbers of float32 at `value`. Requires: `value` is finite and > 0.
double float32_step(double value) { return std::ldexp(1.0, std::max(std::ilogb(value), -126) - 23); }

std::string name_of(const InputSet& set) {
    return set.parts.size() == 1 ? set.parts.front().path : fmt::format("{} and others", set.parts.front().path);
}

/// Returns a warning if the coordinates of a set are coarse, or an empty text.
std::string coarseness_of(const DetectRequest& request, const InputSet& set) {
    constexpr double fine = 1e-6;  // of the size of the scene
    if (!set.scene.rounded) return {};
    const Extent extent = extent_of(set);
    if (!(extent.coordinate > 0) || !std::isfinite(extent.coordinate)) return {};
    const double step = float32_step(extent.coordinate);
    const bool coarse = step > fine * extent.size;
    const bool too_coarse = request.pipeline.tolerance && *request.pipeline.tolerance < step;
    if (!coarse && !too_coarse) return {};
    std::string text = fmt::format("{}: coordinates up to {:.6g} were rounded to float32, in steps of {:.2g}",
                                   name_of(set), extent.coordinate, step);
    if (too_coarse) text += fmt::format(", more than the tolerance {:.3g}", *request.pipeline.tolerance);
    text += fmt::format("; the scene measures {:.3g}. Gaps and overlaps below a step are not reliable", extent.size);
    if (coarse) text += "; move the scene nearer to the origin, or use a format with float64";
    return text;
}

}  // namespace

double tolerance_of(const DetectRequest& request, const SetPair& sets) {
    if (request.pipeline.tolerance) return *request.pipeline.tolerance;
    double largest = 0;
    for (const InputSet* set : {&sets.first, sets.second}) {
        if (set != nullptr && set->scene.rounded) largest = std::max(largest, extent_of(*set).coordinate);
    }
    constexpr double relative_step = 0x1p-23;
    return 2 * largest * relative_step;
}

std::vector<std::string> coordinate_warnings(const DetectRequest& request, const SetPair& sets) {
    std::vector<std::string> warnings;
    for (const InputSet* set : {&sets.first, sets.second}) {
        if (set == nullptr || set->parts.empty()) continue;
        const std::string text = coarseness_of(request, *set);
        if (!text.empty()) warnings.push_back(text);
    }
    if (sets.second != nullptr && sets.first.scene.space.up != sets.second->scene.space.up &&
        sets.first.scene.space.up != io::UpAxis::unknown && sets.second->scene.space.up != io::UpAxis::unknown) {
        warnings.push_back(
            fmt::format("the formats of {} and {} have different axes up; coordinates are used as they are",
                        name_of(sets.first), name_of(*sets.second)));
    }
    return warnings;
}

}  // namespace octopair::cli
