#include "octree/build/linear_octree.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>
#include <utility>

#include "base/stop.hpp"
#include "base/test_hooks.hpp"
#include "base/tuning.hpp"
#include "octree/build/encoder.hpp"

namespace octopair {

namespace {

constexpr std::size_t check_interval = 1 << 15;  // objects between checks for a stop request
constexpr std::size_t timed_batches = 8;         // one batch in this many is timed
using Clock = std::chrono::steady_clock;

double seconds_between(Clock::time_point begin, Clock::time_point end) {
    return std::chrono::duration<double>(end - begin).count();
}

struct NumberedBlock {
    std::size_t number;
    ObjectBlock objects;
};

/// The steps over some objects and octants. Borrows all members.
struct BuildSteps {
    const EntrySource& source;
    const Space& space;
    const Directory& directory;
    BuildMemory& memory;
    const std::stop_token& stop;

    /// Encodes and scatters a block. Sets memory.valid, and stops at an object that is not a valid box.
    /// Throws: Error{cancelled}.
    void encode_and_scatter(const NumberedBlock& block) const;
    void count(const NumberedOctants& octants) const;

private:
    template <typename Writer>
    void encode_and_scatter_with(const NumberedBlock& block) const;
};

/// Encodes the objects of one block. `Writer`: ChunkWriter or StagedWriter.
template <typename Writer>
class BlockEncoder {
public:
    BlockEncoder(const BuildSteps& steps, std::size_t block)
        : steps_(steps),
          encoder_(steps.space, steps.directory, std::uint32_t(steps.memory.lists.lists())),
          writer_(steps.memory.lists, block) {}

    /// Returns false if an object is not a valid box. Adds the time of the steps to `seconds` unless it is null.
    bool add(std::size_t begin, std::size_t count, BuildMemory::Seconds* seconds) {
        const auto start = seconds != nullptr ? Clock::now() : Clock::time_point();
        if (!encode(begin, count)) return false;
        const auto encoded = seconds != nullptr ? Clock::now() : Clock::time_point();
        append_homes(count);
        append_ghosts();
        if (seconds != nullptr) {
            seconds->encode += seconds_between(start, encoded);
            seconds->scatter += seconds_between(encoded, Clock::now());
        }
        return true;
    }
    bool full() const { return writer_.full(); }
    void flush() { writer_.flush(); }
    void finish() { writer_.finish(); }

private:
    bool encode(std::size_t begin, std::size_t count) {
        boxes_ = steps_.source.float32_boxes(begin, std::span(rounded_).first(count));
        if (!boxes_.boxes.empty()) return boxes_.valid && encoder_.encode(boxes_, batch_);
        const std::span<Entry> entries = std::span(loaded_).first(count);
        if (!steps_.source.load(begin, entries)) return false;
        encoder_.encode(entries, batch_);
        return true;
    }

    /// Returns a box of the batch as an entry. Its mask has no class bits of this octree yet.
    Entry whole_entry(std::uint32_t position) const {
        if (boxes_.boxes.empty()) return loaded_[position];
        Entry entry{};
        std::memcpy(&entry, &boxes_.boxes[position], sizeof(Box3f));
        entry.object = boxes_.object(position);
        return entry;
    }

    void append_homes(std::size_t count) {
        for (std::size_t i = 0; i < count; ++i) {
            writer_.append(batch_.lists[i], batch_.homes[i]);
            if (i % 8 == 7) writer_.reset_discarded();
        }
        writer_.reset_discarded();
    }

    void append_ghosts() {
        GhostGroup group;
        const auto ghosts = std::uint32_t(steps_.memory.octants);
        for (std::size_t first = 0; first < batch_.crossers; first += GhostGroup::most) {
            const std::size_t count = std::min(batch_.crossers - first, GhostGroup::most);
            encoder_.ghosts(batch_, {first, count}, group);
            for (std::size_t k = 0; k < count; ++k) {
                if ((group.left_out >> k & 1u) != 0) {
                    append_ghosts_of(first + k);
                    continue;
                }
                count_path(Path::ghost_entries);
                const CellEntry& home = batch_.homes[batch_.crosser[first + k]];
                const std::size_t begin = GhostGroup::slots * k, end = begin + group.counts[k];
                for (std::size_t at = begin; at < end; ++at) {
                    append_ghost(ghosts + group.octants[at], group.entries[at], home);
                }
            }
        }
    }

    /// Finds the ghosts of one crosser by the general rule.
    void append_ghosts_of(std::size_t crosser) {
        const CellEntry& home = batch_.homes[batch_.crosser[crosser]];
        const std::uint32_t home_octant = batch_.lists[batch_.crosser[crosser]];
        const CellBox box = batch_.cells(crosser);
        count_path(home_octant == encoder_.no_list ? Path::kept_above_leaf : Path::ghosts_by_rule);
        const Directory::Leaf leaf(batch_.leaf[crosser]);
        const Entry whole = whole_entry(batch_.crosser[crosser]);
        for_each_octant_of(box, steps_.directory, leaf, [&](OctantIndex octant, unsigned begins) {
            if (octant == home_octant) return;
            const OctantCells cells(steps_.space, steps_.directory.octants()[octant]);
            Entry ghost = whole;
            ghost.mask |= begins;  // adds class bits to those of octrees around this one (boxes/entry.hpp)
            append_ghost(std::uint32_t(steps_.memory.ghost_list(octant)), cells.entry(ghost), home);
        });
    }

    void append_ghost(std::uint32_t list, CellEntry ghost, [[maybe_unused]] const CellEntry& home) {
        if constexpr (has_test_hooks) {
            for (unsigned k = 0; k < 3; ++k) {
                if ((home.ends[k] & CellEntry::class_bit) == 0) continue;
                count_path(Path::class_bits_brought);
                if (planted(Fault::begins_bit_cleared)) ghost.ends[k] &= ~CellEntry::class_bit;
            }
        }
        writer_.append(list, ghost);
    }

    const BuildSteps& steps_;
    BatchEncoder encoder_;
    Writer writer_;
    EncodedBatch batch_;
    Float32Boxes boxes_;                      // boxes of the batch, or none
    std::array<Box3f, max_encoded> rounded_;  // memory for the boxes of boxes_, if the source rounds them
    std::array<Entry, max_encoded> loaded_;   // entries of the batch, unless boxes_ has its boxes
};

void BuildSteps::encode_and_scatter(const NumberedBlock& block) const {
    if (memory.lists.lists() < tuning().large.min_lists) {
        encode_and_scatter_with<ChunkWriter>(block);
    } else {
        count_path(Path::scattered_twice);
        encode_and_scatter_with<StagedWriter>(block);
    }
}

template <typename Writer>
void BuildSteps::encode_and_scatter_with(const NumberedBlock& block) const {
    const std::size_t batch_size = tuning().build.batch;
    memory.valid[block.number] = 0;
    memory.seconds[block.number] = {};
    BlockEncoder<Writer> encoder(*this, block.number);
    for (std::size_t begin = block.objects.begin; begin < block.objects.end; begin += batch_size) {
        if ((begin - block.objects.begin) % check_interval < batch_size) throw_if_stopped(stop);
        const bool timed = (begin - block.objects.begin) / batch_size % timed_batches == 0;
        BuildMemory::Seconds* const seconds = timed ? &memory.seconds[block.number] : nullptr;
        if (!encoder.add(begin, std::min(batch_size, block.objects.end - begin), seconds)) return;
        if (!encoder.full()) continue;
        const auto start = Clock::now();
        encoder.flush();
        memory.seconds[block.number].scatter += seconds_between(start, Clock::now()) / double(timed_batches);
    }
    encoder.finish();
    memory.valid[block.number] = 1;
}

void BuildSteps::count(const NumberedOctants& octants) const {
    std::uint64_t at = 0;
    for (OctantIndex octant = octants.begin; octant < octants.end; ++octant) {
        memory.begins[octant] = at;
        const auto add = [&](std::span<const CellEntry> run) { at += run.size(); };
        memory.lists.for_each_run(memory.home_list(octant), add);
        memory.lists.for_each_run(memory.ghost_list(octant), add);
    }
    memory.totals[octants.number] = at;
}

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

/// Returns the time since `last`, and sets `last` to now.
double seconds_since(Clock::time_point& last) {
    const auto begin = std::exchange(last, Clock::now());
    return seconds_between(begin, last);
}

}  // namespace

void BuildMemory::resize(std::size_t objects, std::size_t blocks, std::size_t octant_count, std::size_t octant_ranges) {
    octants = octant_count;
    lists.resize(blocks, 2 * octants, max_entries_per_object * ((objects + blocks - 1) / blocks));
    begins.resize_discard(octants);
    totals.resize_discard(octant_ranges);
    valid.resize_discard(blocks);
    seconds.resize_discard(blocks);
}

void LinearOctree::build(const EntrySource& source, Executor& executor, std::stop_token stop) {
    const auto begin = Clock::now();
    layout_ = make_layout(source, stop);
    fill(source, executor, stop, begin);
}

void LinearOctree::build(OctreeLayout layout, const EntrySource& source, Executor& executor, std::stop_token stop) {
    const auto begin = Clock::now();
    layout_ = std::move(layout);
    fill(source, executor, stop, begin);
}

void LinearOctree::refill(const EntrySource& source, Executor& executor, std::stop_token stop) {
    count_path(Path::refilled);
    fill(source, executor, stop, Clock::now());
}

void LinearOctree::fill(const EntrySource& source, Executor& executor, const std::stop_token& stop,
                        TimePoint step_begin) {
    const auto blocks = blocks_of(source.size(), executor.width());
    const auto ranges = ranges_of(octants().size(), blocks.size(), executor.width());
    arranged_.reset();
    memory_.resize(source.size(), blocks.size(), octants().size(), ranges.size());
    count_path(blocks.size() == 1 ? Path::build_one_block : Path::build_blocks);
    if (ranges.size() > 1) count_path(Path::count_ranges);
    const BuildSteps steps{source, space(), directory(), memory_, stop};
    executor.for_each(blocks.size(), [&](std::size_t i) { steps.encode_and_scatter(blocks[i]); });
    for (const NumberedBlock& block : blocks) {
        if (memory_.valid[block.number] == 0) throw Invalid{block.objects.begin};
    }
    const double both = seconds_since(step_begin);
    seconds_.scatter = both * scatter_part(blocks.size());
    seconds_.encode = both - seconds_.scatter;

    executor.for_each(ranges.size(), [&](std::size_t i) { steps.count(ranges[i]); });
    join_ranges(ranges);
    seconds_.count = seconds_since(step_begin);
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

void LinearOctree::arrange(EntryRuns runs) {
    std::uint64_t at = 0;
    for (OctantIndex octant = 0; octant < octants().size(); ++octant) {
        begins_[octant] = at;
        for (const auto run : runs.of(octant)) at += run.size();
    }
    begins_.back() = at;
    arranged_ = std::move(runs);
}

std::vector<CellEntry> LinearOctree::entries(OctantIndex octant) const {
    std::vector<CellEntry> all;
    all.reserve(std::size_t(entry_count(octant)));
    for_each_run(octant, [&](std::span<const CellEntry> run) { all.insert(all.end(), run.begin(), run.end()); });
    return all;
}

}  // namespace octopair
