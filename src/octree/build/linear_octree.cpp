#include "octree/build/linear_octree.hpp"

#include <algorithm>
#include <chrono>

#include "base/stop.hpp"
#include "base/test_hooks.hpp"
#include "base/tuning.hpp"

namespace octopair {

namespace {

std::vector<NumberedBlock> blocks_of(std::size_t objects, unsigned width) {
    constexpr std::size_t max_objects = std::size_t(1) << 28;  // 32 bits number the entries of a block
    const std::size_t enough = std::max<std::size_t>(1, objects / tuning().build.min_block);
    std::vector<NumberedBlock> blocks(
        std::max(std::min<std::size_t>(width == 1 ? 1 : width * tuning().build.blocks_per_thread, enough),
                 objects / max_objects + 1));
    for (std::size_t i = 0; i < blocks.size(); ++i) {
        blocks[i] = {i, {objects * i / blocks.size(), objects * (i + 1) / blocks.size()}};
    }
    return blocks;
}

std::vector<NumberedOctants> ranges_of(std::size_t octants, std::size_t blocks, unsigned width) {
    const std::size_t enough = octants * blocks / tuning().build.counts_per_range + 1;
    std::vector<NumberedOctants> ranges(std::min<std::size_t>(width, enough));
    for (std::size_t i = 0; i < ranges.size(); ++i) {
        ranges[i] = {i, OctantIndex(octants * i / ranges.size()), OctantIndex(octants * (i + 1) / ranges.size())};
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
    source.pick(positions, sampled);  // invalid objects are ignored here: scatter finds them, with their positions
    return sampled;
}

}  // namespace

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

void LinearOctree::build(const EntrySource& source, Executor& executor, std::stop_token stop) {
    const auto begin = std::chrono::steady_clock::now();
    layout_ = make_layout(source, stop);
    fill(source, executor, stop, begin);
}

void LinearOctree::build(OctreeLayout layout, const EntrySource& source, Executor& executor, std::stop_token stop) {
    const auto begin = std::chrono::steady_clock::now();
    layout_ = std::move(layout);
    fill(source, executor, stop, begin);
}

void LinearOctree::refill(const EntrySource& source, Executor& executor, std::stop_token stop) {
    count_path(Path::refilled);
    fill(source, executor, stop, std::chrono::steady_clock::now());
}

void LinearOctree::fill(const EntrySource& source, Executor& executor, const std::stop_token& stop, Clock clock) {
    const auto blocks = blocks_of(source.size(), executor.width());
    const auto ranges = ranges_of(octants().size(), blocks.size(), executor.width());
    memory_.resize(source.size(), blocks.size(), octants().size(), ranges.size());
    count_path(blocks.size() == 1 ? Path::build_one_block : Path::build_blocks);
    if (ranges.size() > 1) count_path(Path::count_ranges);
    const BuildSteps steps{source, space(), directory(), memory_, stop};
    executor.for_each(blocks.size(), [&](std::size_t i) { steps.encode_and_scatter(blocks[i]); });
    for (const NumberedBlock& block : blocks) {
        if (memory_.valid[block.number] == 0) throw Invalid{block.objects.begin};
    }
    const double both = seconds_since(clock);
    seconds_.scatter = both * scatter_part(blocks.size());
    seconds_.encode = both - seconds_.scatter;

    executor.for_each(ranges.size(), [&](std::size_t i) { steps.count(ranges[i]); });
    join_ranges(ranges);
    seconds_.count = seconds_since(clock);
}

/// Returns the part of the time of encode and scatter that scatter took.
double LinearOctree::scatter_part(std::size_t blocks) const {
    BuildMemory::Seconds all;
    for (std::size_t block = 0; block < blocks; ++block) {
        all.encode += memory_.seconds[block].encode;
        all.scatter += memory_.seconds[block].scatter;
    }
    return all.scatter > 0 ? all.scatter / (all.encode + all.scatter) : 0;
}

/// Sets the positions where the entries of each octant begin, in the order of octants.
void LinearOctree::join_ranges(std::span<const NumberedOctants> ranges) {
    begins_.resize(octants().size() + 1);
    std::uint64_t at = 0;
    for (const NumberedOctants& range : ranges) {
        for (OctantIndex octant = range.begin; octant < range.end; ++octant)
            begins_[octant] = at + memory_.begins[octant];
        at += memory_.totals[range.number];
    }
    begins_.back() = at;
}

std::vector<CellEntry> LinearOctree::entries(OctantIndex octant) const {
    std::vector<CellEntry> all;
    all.reserve(std::size_t(entry_count(octant)));
    for_each_run(octant, [&](std::span<const CellEntry> run) { all.insert(all.end(), run.begin(), run.end()); });
    return all;
}

}  // namespace octopair
