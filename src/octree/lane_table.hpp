// LaneTable: for each set of lanes of a SIMD register, the numbers of its lanes. Used to move chosen lanes to the front.
//
// It replaces Highway's own table, which g++ 12 copies on each use.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace octopair {

struct LaneTable {
    static constexpr std::size_t lanes = 8;
    std::array<std::array<std::uint8_t, lanes>, 1 << lanes> of{};  ///< by set, as bits: its lanes, ascending
    std::array<std::array<std::uint8_t, lanes>, 1 << lanes>
        rank{};                                    ///< by set: for each lane, the number of its lanes before
    std::array<std::uint8_t, 1 << lanes> count{};  ///< by set: number of its lanes

    constexpr LaneTable() {
        for (std::size_t set = 0; set < of.size(); ++set) {
            for (std::uint8_t lane = 0; lane < lanes; ++lane) {
                rank[set][lane] = count[set];
                if (set >> lane & 1u) of[set][count[set]++] = lane;
            }
        }
    }
};
inline constexpr LaneTable lanes_in;

}  // namespace octopair
