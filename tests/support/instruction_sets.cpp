// Limits the fast kernels of a test program to the instruction set that OCTOPAIR_TEST_INSTRUCTIONS names. Possible
// values: AVX3_DL, AVX3, AVX2, SSE4, SSSE3.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include <hwy/highway.h>

namespace {

[[noreturn]] void refuse(std::string_view name) {
    std::fprintf(stderr, "OCTOPAIR_TEST_INSTRUCTIONS: %s is not the name of an instruction set\n", name.data());
    std::exit(2);
}

/// Highway gives a better instruction set a lower bit.
[[maybe_unused]] const bool are_limited = [] {
    const char* const name = std::getenv("OCTOPAIR_TEST_INSTRUCTIONS");
    if (name == nullptr) return false;
    for (std::int64_t target = 1; target < HWY_SCALAR; target <<= 1) {
        if (std::string_view(hwy::TargetName(target)) != name) continue;
        const std::int64_t left = hwy::SupportedTargets() & ~(target - 1);
        if (left != 0) hwy::SetSupportedTargetsForTest(left);
        hwy::GetChosenTarget().Update(hwy::SupportedTargets());
        return true;
    }
    refuse(name);
}();

}  // namespace
