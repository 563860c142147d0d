#include "octree/sweep/sweep.hpp"

#include <hwy/highway.h>

namespace octopair {

std::string sweep_instruction_set() {
    // The best of the supported targets is the one with the lowest bit set.
    const auto supported = hwy::SupportedTargets();
    return hwy::TargetName(supported & (~supported + 1));
}

void restrict_sweep_to_baseline(bool baseline_only) {
    hwy::DisableTargets(baseline_only ? ~(HWY_STATIC_TARGET) : 0);
    hwy::GetChosenTarget().DeInit();
}

}  // namespace octopair
