// Tests that the checks of small scenes find every planted fault. Prints the check that found the fault and the number
// of scenes needed.
#include <gtest/gtest.h>

#include <array>
#include <map>
#include <ostream>

#include "exactness/small_scenes.hpp"

#ifdef OCTOPAIR_TEST_HOOKS

namespace octopair::test {
namespace {

struct Planted {
    const char* name;
    Fault fault;
};

void PrintTo(const Planted& planted, std::ostream* out) { *out << planted.name; }

std::string planted_name_of(const ::testing::TestParamInfo<Planted>& info) { return info.param.name; }

class PlantedFault : public ::testing::TestWithParam<Planted> {};

TEST_P(PlantedFault, IsFound) {
    constexpr std::uint64_t most = 1000;  // a tenth of the scenes of SmallScenes
    constexpr std::uint64_t enough = 5;
    const EngineFor engines = local_engines();
    std::map<std::string, std::uint64_t> found_by;
    std::uint64_t first = most, findings = 0;
    {
        const FaultScope planted(GetParam().fault);
        for (std::uint64_t seed = 0; seed < most && findings < enough; ++seed) {
            const auto finding = check_small_cases({seed, seed + 1}, engines);
            if (!finding) continue;
            if (findings++ == 0) first = seed;
            ++found_by[finding->check];
        }
    }
    EXPECT_LT(first, most);
    std::string checks;
    for (const auto& [check, count] : found_by) checks += "\n  " + std::to_string(count) + " scenes: " + check;
    std::printf("%s: first found by scene %llu%s\n", GetParam().name, static_cast<unsigned long long>(first),
                checks.c_str());
}

constexpr auto planted_here = std::to_array<Planted>({
    {"begins_bit_cleared", Fault::begins_bit_cleared},
    {"octant_border_open", Fault::octant_border_open},
    {"window_end_open", Fault::window_end_open},
    {"cell_window_end_open", Fault::cell_window_end_open},
    {"cell_depth_too_small", Fault::cell_depth_too_small},
    {"tile_end_open", Fault::tile_end_open},
    {"handed_to_wrong_child", Fault::handed_to_wrong_child},
    {"nested_space_moved", Fault::nested_space_moved},
    {"stream_windows_overlap", Fault::stream_windows_overlap},
    {"sweep_repeats_block", Fault::sweep_repeats_block},
    {"part_joined_twice", Fault::part_joined_twice},
});
// Five values of Fault are missing here: the first is no fault, tests/mpi plants the three faults of ranks, and tests/cli that of a class.
static_assert(planted_here.size() + 5 == fault_count);

INSTANTIATE_TEST_SUITE_P(, PlantedFault, ::testing::ValuesIn(planted_here), planted_name_of);

}  // namespace
}  // namespace octopair::test

#endif
