#include "cli/detect/tolerance.hpp"

#include <algorithm>

namespace octopair::cli {

double tolerance_of(const DetectRequest& request, const SetPair& sets) {
    if (request.pipeline.tolerance) return *request.pipeline.tolerance;
    double largest = 0;
    for (const InputSet* set : {&sets.first, sets.second}) {
        if (set != nullptr) largest = std::max(largest, set->scene.largest_rounded);
    }
    constexpr double relative_step = 0x1p-23;
    return 2 * largest * relative_step;
}

}  // namespace octopair::cli
