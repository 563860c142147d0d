#include "octree/linear_octree.hpp"

#include <algorithm>
#include <chrono>
#include <numeric>

#include "base/stop.hpp"
#include "base/test_hooks.hpp"
#include "base/tuning.hpp"

namespace octopair {

namespace {

std::vector<NumberedBlock> blocks_of(std::size_t objects, unsigned width) {
    const std::size_t enough = std::max<std::size_t>(1, objects / tuning().build.least_block);
    std::vector<NumberedBlock> blocks(
        std::min<std::size_t>(width == 1 ? 1 : width * tuning().build.blocks_per_thread, enough));
    for (std::size_t i = 0; i < blocks.size(); ++i) {
        blocks[i] = {i, {objects * i / blocks.size(), objects * (i + 1) / blocks.size()}};
    }
    return blocks;
}

std::vector<NumberedNodes> ranges_of(std::size_t nodes, std::size_t blocks, unsigned width) {
    const std::size_t enough = nodes * blocks / tuning().build.counts_per_range + 1;
    std::vector<NumberedNodes> ranges(std::min<std::size_t>(width, enough));
    for (std::size_t i = 0; i < ranges.size(); ++i) {
        ranges[i] = {i, NodeIndex(nodes * i / ranges.size()), NodeIndex(nodes * (i + 1) / ranges.size())};
    }
    return ranges;
}

double seconds_since(std::chrono::steady_clock::time_point& last) {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - last).count();
    last = now;
    return seconds;
}

std::vector<Entry> sample_of(const EntrySource& source) {
    const Sample sample = octant_sample(source.size());
    std::vector<std::size_t> positions(sample.size());
    for (std::size_t i = 0; i < positions.size(); ++i) positions[i] = sample[i];
    std::vector<Entry> sampled(sample.size());
    source.pick(positions, sampled);  // what is invalid is found by sort, with its position
    return sampled;
}

}  // namespace

Sample octant_sample(std::uint64_t objects) {
    const Tuning::Sampling& sampling = tuning().sampling;
    return {std::size_t(objects), sampling.stride,
            std::max(sampling.most, std::size_t(objects) / sampling.most_stride)};
}

OctantGrowth octant_growth(std::uint64_t objects, const std::stop_token& stop) {
    const std::size_t sampled = octant_sample(objects).size();
    return {double(objects) / double(std::max<std::size_t>(1, sampled)), stop};
}

OctantPlan plan_octants(std::span<const Entry> sampled, std::uint64_t objects, const std::stop_token& stop) {
    OctantPlan plan;
    plan.frame = Frame::fit(sampled, objects);
    SampledOctant root;
    root.inside.resize(sampled.size());
    plan.frame.cells(sampled, root.inside);
    octant_growth(objects, stop).grow(std::move(root), plan.shape);
    return plan;
}

OctantPlan plan_octants(const EntrySource& source, const std::stop_token& stop) {
    // The sample is gone when the entries need the memory.
    const std::vector<Entry> sampled = sample_of(source);
    return plan_octants(sampled, source.size(), stop);
}

PlantedOctants plant_octants(const EntrySource& source, const std::stop_token& stop) {
    return plan_octants(source, stop).planted();
}

void LinearOctree::build(const EntrySource& source, Executor& executor, std::stop_token stop) {
    const auto begin = std::chrono::steady_clock::now();
    octants_ = plant_octants(source, stop);
    fill(source, executor, stop, begin);
}

void LinearOctree::build(PlantedOctants octants, const EntrySource& source, Executor& executor, std::stop_token stop) {
    const auto begin = std::chrono::steady_clock::now();
    octants_ = std::move(octants);
    fill(source, executor, stop, begin);
}

void LinearOctree::refill(const EntrySource& source, Executor& executor, std::stop_token stop) {
    count_path(Path::refilled);
    fill(source, executor, stop, std::chrono::steady_clock::now());
}

void LinearOctree::fill(const EntrySource& source, Executor& executor, const std::stop_token& stop, Clock clock) {
    const auto blocks = blocks_of(source.size(), executor.width());
    const auto ranges = ranges_of(nodes().size(), blocks.size(), executor.width());
    memory_.resize(source.size(), blocks.size(), nodes().size(), ranges.size());
    count_path(blocks.size() == 1 ? Path::build_one_block : Path::build_blocks);
    if (ranges.size() > 1) count_path(Path::merge_ranges);
    const BuildSteps steps{source, frame(), directory(), memory_, stop};
    executor.for_each(blocks.size(), [&](std::size_t i) { steps.encode(blocks[i]); });
    seconds_.encode = seconds_since(clock);

    std::vector<std::size_t> all(blocks.size());
    std::iota(all.begin(), all.end(), std::size_t(0));
    executor.for_each(ranges.size(), [&](std::size_t i) { steps.merge(ranges[i], all); });
    std::vector<std::uint64_t> range_begins;
    join_ranges(ranges, range_begins);
    seconds_.merge = seconds_since(clock);

    entries_.resize_discard(std::size_t(entry_count()) + blocks.size());
    executor.for_each(blocks.size(), [&](std::size_t i) {
        const SortTarget target{entries_.span(), range_begins, ranges, std::size_t(entry_count()) + i};
        steps.sort(blocks[i], target);
    });
    for (const NumberedBlock& block : blocks) {
        if (memory_.valid[block.number] == 0) throw Invalid{block.objects.begin};
    }
    memory_.ghosts.clear();
    if (crowded()) {
        count_path(Path::crowded_octree);
        memory_.homes.clear();  // the scan needs the memory more
    }
    seconds_.sort = seconds_since(clock);
}

/// Where each range of nodes begins among the entries, and each node.
void LinearOctree::join_ranges(std::span<const NumberedNodes> ranges, std::vector<std::uint64_t>& range_begins) {
    begins_.resize(nodes().size() + 1);
    std::uint64_t at = 0;
    for (const NumberedNodes& range : ranges) {
        range_begins.push_back(at);
        for (NodeIndex node = range.begin; node < range.end; ++node) begins_[node] = at + memory_.begins[node];
        at += memory_.totals[range.number];
    }
    begins_.back() = at;
}

/// Whether one octant holds half of the entries.
bool LinearOctree::crowded() const {
    for (NodeIndex node = 0; node < nodes().size(); ++node) {
        if (2 * entries(node).size() > entry_count()) return true;
    }
    return false;
}

void LinearOctree::assemble(PlantedOctants octants, std::span<const SortedList> lists, const std::stop_token& stop) {
    auto clock = std::chrono::steady_clock::now();
    octants_ = std::move(octants);
    std::uint64_t all = 0;
    for (const SortedList& list : lists) all += list.entries.size();
    entries_.resize_discard(std::size_t(all));
    begins_.resize(nodes().size() + 1);
    begins_.back() = merge_lists(lists, {entries_.span(), std::span(begins_).first(nodes().size()), {}}, stop);
    seconds_ = {};
    seconds_.merge = seconds_since(clock);
}

}  // namespace octopair
