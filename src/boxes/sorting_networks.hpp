// Sorting networks: fixed sequences of exchanges that sort any 4, 8 or 16 numbers.
//
// Source: B. Dobbelaere, "List of sorting networks" (the fewest exchanges that are known: 5, 19 and 60).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace octopair {

/// Puts the smaller of two numbers at `low`, the other one at `high`.
struct Exchange {
    std::uint8_t low, high;
};

template <std::size_t numbers>
inline constexpr auto sorting_network = nullptr;

template <>
inline constexpr std::array<Exchange, 5> sorting_network<4> = {{{0, 1}, {2, 3}, {0, 2}, {1, 3}, {1, 2}}};

template <>
inline constexpr std::array<Exchange, 19> sorting_network<8> = {{
    {0, 1}, {2, 3}, {4, 5}, {6, 7}, {0, 2}, {1, 3}, {4, 6}, {5, 7}, {1, 2}, {5, 6},
    {0, 4}, {1, 5}, {2, 6}, {3, 7}, {2, 4}, {3, 5}, {1, 2}, {3, 4}, {5, 6},
}};

template <>
inline constexpr std::array<Exchange, 60> sorting_network<16> = {{
    {0, 13},  {1, 12}, {2, 15},  {3, 14},  {4, 8},   {5, 6}, {7, 11},  {9, 10},  {0, 5},   {1, 7},   {2, 9},   {3, 4},
    {6, 13},  {8, 14}, {10, 15}, {11, 12}, {0, 1},   {2, 3}, {4, 5},   {6, 8},   {7, 9},   {10, 11}, {12, 13}, {14, 15},
    {0, 2},   {1, 3},  {4, 10},  {5, 11},  {6, 7},   {8, 9}, {12, 14}, {13, 15}, {1, 2},   {3, 12},  {4, 6},   {5, 7},
    {8, 10},  {9, 11}, {13, 14}, {1, 4},   {2, 6},   {5, 8}, {7, 10},  {9, 13},  {11, 14}, {2, 4},   {3, 6},   {9, 12},
    {11, 13}, {3, 5},  {6, 8},   {7, 9},   {10, 12}, {3, 4}, {5, 6},   {7, 8},   {9, 10},  {11, 12}, {6, 7},   {8, 9},
}};

}  // namespace octopair
