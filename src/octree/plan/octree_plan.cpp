#include "octree/plan/octree_plan.hpp"

#include <algorithm>
#include <bit>
#include <utility>

#include "base/stop.hpp"
#include "base/test_hooks.hpp"
#include "base/tuning.hpp"

namespace octopair {

namespace {

using SampledBoxes = SampledOctant::Boxes;

/// Copies each box into the list `list` of each child of `octant` that the box touches.
/// Requires: all boxes touch `octant`.
void hand_down(const OctantCube& octant, const SampledBoxes& boxes, std::array<SampledOctant, 8>& below,
               SampledBoxes SampledOctant::*list) {
    for (SampledOctant& child : below) (child.*list).reserve(boxes.size() / 6);
    for (const CellBox& box : boxes) {
        for (unsigned touched = octant.touched_below(box); touched != 0; touched &= touched - 1)
            (below[unsigned(std::countr_zero(touched))].*list).push_back(box);
    }
}

std::vector<Entry> sample_of(const EntrySource& source) {
    const Sample sample = octant_sample(source.size());
    std::vector<std::size_t> positions(sample.size());
    for (std::size_t i = 0; i < positions.size(); ++i) positions[i] = sample[i];
    std::vector<Entry> sampled(sample.size());
    source.pick(positions, sampled);  // invalid objects are ignored here: scatter finds them, with their positions
    return sampled;
}

}  // namespace

void SampledOctant::keep() {
    const auto fits = [&](const CellBox& box) { return !octant.keeps(box); };
    const auto too_large = std::partition(inside.begin(), inside.end(), fits);
    kept.insert(kept.end(), too_large, inside.end());
    inside.erase(too_large, inside.end());
}

std::array<SampledOctant, 8> SampledOctant::divided() const {
    std::array<SampledOctant, 8> below;
    for (unsigned digit = 0; digit < 8; ++digit) below[digit].octant = octant.child(digit);
    hand_down(octant, inside, below, &SampledOctant::inside);
    hand_down(octant, kept, below, &SampledOctant::kept);
    return below;
}

OctantCounts OctantCounts::of(const SampledOctant& sampled, const std::array<SampledOctant, 8>& below) {
    OctantCounts counts{.inside = sampled.inside.size(), .kept = sampled.kept.size()};
    counts.beginning = std::uint64_t(
        std::ranges::count_if(sampled.inside, [&](const CellBox& box) { return sampled.octant.holds_begin(box); }));
    for (const SampledOctant& child : below) {
        counts.inside_below += child.inside.size();
        counts.kept_below += child.kept.size();
    }
    return counts;
}

bool SplitRule::is_crowd(std::uint64_t inside) const { return double(inside) * weight_ > tuning().split.always_above; }

bool SplitRule::crowded(const SampledOctant& sampled) const {
    const double objects = double(sampled.inside.size()) * weight_;
    if (objects <= tuning().split.never_up_to) {
        count_path(Path::octant_too_small);
        return false;
    }
    if (is_crowd(sampled.inside.size())) return true;
    const bool wide = tests_per_object(sampled) > tuning().split.max_tests_per_object;
    if (!wide) count_path(Path::octant_well_swept);
    return wide;
}

double SplitRule::tests_per_object(const SampledOctant& sampled) const {
    const OctantCube& octant = sampled.octant;
    const double objects = double(sampled.inside.size()) * weight_;
    double window = objects;
    for (unsigned axis = 0; axis < 3; ++axis) {
        std::uint32_t first = cells_per_axis;
        std::uint32_t last = 0;
        std::uint64_t extents = 0;
        const std::uint32_t end = octant.lo[axis] + ((cells_per_axis >> octant.level) - 1);
        for (const CellBox& box : sampled.inside) {
            const std::uint32_t lo = std::max(box.lo[axis], octant.lo[axis]);
            first = std::min(first, lo);
            last = std::max(last, lo);
            extents += std::min(box.hi[axis], end) - lo + 1;
        }
        const double extent = double(extents) / double(sampled.inside.size());
        window = std::min(window, objects * extent / (double(last - first) + extent));
    }
    return window;
}

bool SplitRule::is_too_large_for_sweep(std::uint64_t boxes, double tests) const {
    const double objects = double(boxes) * weight_;
    return objects > double(tuning().scan.max_swept_list) || tests > double(tuning().scan.max_tests_per_box);
}

bool SplitRule::worth_splitting(const OctantCounts& counts) {
    return double(counts.inside_below) <= tuning().split.max_entries_per_object * double(counts.beginning) &&
           double(counts.inside_below + counts.kept_below) <=
               tuning().split.max_handed_growth * double(counts.inside + counts.kept);
}

void SplitRule::grow(SampledOctant sampled, SplitFlags& shape, const CrowdSink& crowd) const {
    throw_if_stopped(stop_);
    const std::size_t index = shape.size();
    shape.push_back(0);
    sampled.keep();
    const auto stays_whole = [&](Path reason) {
        count_path(reason);
        if (crowd) crowd(sampled, index);
    };
    if (sampled.octant.level >= deepest) return stays_whole(Path::octant_deepest);
    if (!crowded(sampled)) return;
    std::array<SampledOctant, 8> below = sampled.divided();
    if (!worth_splitting(OctantCounts::of(sampled, below))) return stays_whole(Path::octant_multiplies);
    count_path(Path::octant_divided);
    sampled = {};
    shape[index] = 1;
    for (SampledOctant& child : below) grow(std::exchange(child, {}), shape, crowd);
}

Sample octant_sample(std::uint64_t objects) {
    const Tuning::Sampling& sampling = tuning().sampling;
    return {std::size_t(objects), std::clamp<std::size_t>(objects / sampling.min_objects, 1, sampling.stride),
            std::max(sampling.max_objects, std::size_t(objects) / sampling.max_stride)};
}

SplitRule split_rule(std::uint64_t objects, const std::stop_token& stop) {
    const std::size_t sampled = octant_sample(objects).size();
    return {double(objects) / double(std::max<std::size_t>(1, sampled)), stop};
}

OctreePlan plan_octree(std::span<const Entry> sampled, std::uint64_t objects, const std::stop_token& stop) {
    OctreePlan plan;
    plan.space = Space::fit(sampled, objects);
    SampledOctant root;
    root.inside.resize(sampled.size());
    plan.space.cells(sampled, root.inside);
    split_rule(objects, stop).grow(std::move(root), plan.shape);
    return plan;
}

OctreePlan plan_octree(const EntrySource& source, const std::stop_token& stop) {
    // The sample is freed when this function returns, before the entries need the memory.
    const std::vector<Entry> sampled = sample_of(source);
    return plan_octree(sampled, source.size(), stop);
}

OctreeLayout make_layout(const EntrySource& source, const std::stop_token& stop) {
    return plan_octree(source, stop).layout();
}

}  // namespace octopair
