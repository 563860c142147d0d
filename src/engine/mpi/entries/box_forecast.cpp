#include "engine/mpi/entries/box_forecast.hpp"

#include <algorithm>
#include <span>

#include "base/test_hooks.hpp"
#include "base/tuning.hpp"

namespace octopair {

namespace {

/// Estimates from a few entries of an octant how many others a sweep on cells tests each entry against, along the best of the axes.
double estimated_tests(const LinearOctree& octree, OctantIndex octant) {
    constexpr std::size_t per_run = 4, most_runs = 16;
    const auto runs = octree.arranged_runs(octant);
    const std::size_t stride = runs.size() / most_runs + 1;
    std::array<std::uint32_t, 3> first, last = {}, extents = {};
    first.fill(last_octant_cell);
    std::size_t count = 0;
    for (std::size_t i = 0; i < runs.size(); i += stride) {
        for (const CellEntry& entry : runs[i].first(std::min(runs[i].size(), per_run))) {
            for (unsigned k = 0; k < 3; ++k) {
                first[k] = std::min(first[k], entry.low(k));
                last[k] = std::max(last[k], entry.low(k));
                extents[k] += entry.high(k) - entry.low(k) + 1;
            }
            ++count;
        }
    }
    const auto entries = double(octree.entry_count(octant));
    double least = entries;
    for (unsigned k = 0; count > 0 && k < 3; ++k) {
        const double extent = double(extents[k]) / double(count);
        least = std::min(least, entries * extent / (double(last[k] - first[k]) + extent));
    }
    return least;
}

/// True if a sweep of the octant may cost too much for cells. `above`: number of entries that octants above keep.
bool may_be_crowd(const LinearOctree& octree, OctantIndex octant, std::size_t above) {
    const auto most_tests = double(tuning().scan.max_tests_per_box);
    const std::uint64_t entries = octree.entry_count(octant);
    if (entries == 0 || double(entries) + double(above) <= most_tests) return false;
    // Estimates of octants that were divided as far as the split rule wants are reliable. Others may have a dense core.
    const Tuning::Ranks& parts = tuning().ranks;
    const bool may_have_core = double(entries) > tuning().split.always_above;
    return double(above) > parts.handed_part * most_tests ||
           estimated_tests(octree, octant) > (may_have_core ? parts.core_part : parts.crowd_part) * most_tests;
}

}  // namespace

WantedObjects forecast_boxes(const JointCall& call, const OctreeRange& octants, const InnerEntries& inner) {
    WantedObjects wanted;
    const auto want = [&](const CellEntry& entry) {
        const unsigned set = call.join && entry.object >= call.totals[0] ? 1 : 0;
        wanted[set].push_back(entry.object - std::uint32_t(set == 1 ? call.totals[0] : 0));
    };
    const LinearOctree& octree = octants.octree;
    for (const CellEntry& entry : inner.all()) want(entry);
    for (OctantIndex octant = octants.begin; octant < octants.end; ++octant) {
        std::size_t above = 0;
        for (OctantIndex at = octant; at != 0 && !inner.all().empty();) {
            at = octree.octants()[at].parent;
            above += inner.of(at).size();
        }
        if (!may_be_crowd(octree, octant, above)) continue;
        count_path(Path::ranks_crowd_forecast);
        octree.for_each_run(octant, [&](std::span<const CellEntry> run) { std::ranges::for_each(run, want); });
    }
    for (auto& positions : wanted) {
        std::ranges::sort(positions);
        positions.erase(std::unique(positions.begin(), positions.end()), positions.end());
    }
    return wanted;
}

}  // namespace octopair
