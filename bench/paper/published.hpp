// Times published in the paper.
//
// Source: Lucchesi, Egbert, Harris 2014, sections 5.2 (tables 1 and 2) and 5.3 (components).
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace octopair::paper {

struct PublishedTime {
    unsigned processors;  ///< two on each machine, except in the first row
    std::uint64_t microseconds;
};

struct PublishedTable {
    std::uint64_t objects;
    std::array<PublishedTime, 6> times;
};

inline constexpr std::array<PublishedTable, 2> published_tables = {{
    {1'000'000,
     {{{1, 29'537'415}, {2, 15'596'299}, {10, 3'615'147}, {20, 2'177'746}, {30, 1'682'112}, {40, 1'480'608}}}},
    {2'000'000,
     {{{1, 59'706'876}, {2, 31'332'310}, {10, 7'215'860}, {20, 4'298'207}, {30, 3'331'193}, {40, 2'889'864}}}},
}};

/// Returns the rows for this number of objects; empty if the paper has no rows for this number.
constexpr std::span<const PublishedTime> published_times(std::uint64_t objects) {
    for (const PublishedTable& table : published_tables) {
        if (table.objects == objects) return table.times;
    }
    return {};
}

/// Times of the components, in microseconds. The paper does not give the number of objects. The sum of the times is
/// close to the paper's time for 2,000,000 objects. The paper gives no time for the scan.
struct PublishedComponents {
    unsigned processors;
    std::uint64_t octal_codes;    ///< ResolveObject() on a slave
    std::uint64_t sort;           ///< qsort() on a slave
    std::uint64_t merge_machine;  ///< MergeSlaveResults() on a networked slave
    std::uint64_t merge_master;   ///< MergeSlaveResults() on the master
};

inline constexpr PublishedComponents published_components = {40, 1'307'631, 88'953, 38'622, 791'490};

}  // namespace octopair::paper
