#include "octree/build/build_steps.hpp"

#include <hwy/cache_control.h>

#include <algorithm>
#include <array>

#include "base/stop.hpp"
#include "base/test_hooks.hpp"
#include "base/tuning.hpp"
#include "octree/build/octants_of.hpp"

namespace octopair {

namespace {

constexpr std::size_t check_interval = 1 << 15;  // objects between checks for a stop request
constexpr std::size_t max_batch = default_tuning.build.batch;
constexpr std::size_t prefetched = 32;           // objects: distance at which their places are prefetched
constexpr std::size_t prefetched_ghosts = 8;     // ghosts: the same distance
constexpr std::size_t ghosts_at_once = 1 << 14;  // ghosts committed at a time; more than a batch can have

/// Collects the ghosts of a block, in the order in which they are found.
class GhostList {
public:
    GhostList(BuildMemory& memory, const ObjectBlock& block)
        : ghosts_(memory.ghosts), begin_(max_ghosts * block.begin), end_(max_ghosts * block.end) {}

    /// Makes room for the ghosts of one batch.
    void prepare() {
        if (size_ + max_ghosts * max_batch <= committed_) return;
        const std::size_t more = std::min(ghosts_at_once, end_ - begin_ - committed_);
        ghosts_.commit(begin_ + committed_, more);
        committed_ += more;
    }
    void add(OctantIndex octant, unsigned begins) { ghosts_[begin_ + size_++] = Ghost(octant, begins); }
    void end_box() { ghosts_[begin_ + size_ - 1].set_last(); }
    std::size_t size() const { return size_; }

private:
    Buffer<Ghost>& ghosts_;
    std::size_t begin_, end_;
    std::size_t size_ = 0;
    std::size_t committed_ = 0;
};

}  // namespace

void BuildMemory::resize(std::size_t objects, std::size_t blocks, std::size_t octant_count, std::size_t octant_ranges) {
    octants = octant_count;
    homes.resize_discard(objects);
    ghosts.reserve_discard(max_ghosts * objects);
    ghost_counts.resize_discard(blocks);
    counts.resize_discard(2 * blocks * octants);
    places.resize_discard(2 * blocks * octants);
    begins.resize_discard(octants);
    totals.resize_discard(octant_ranges);
    valid.resize_discard(blocks);
}

void BuildSteps::encode(const NumberedBlock& block) const {
    const auto above = OctantIndex(memory.octants);
    const ObjectBlock& objects = block.objects;
    std::vector<std::uint64_t> home_counts(above + 1, 0);  // last: boxes too large for the leaf that they begin in
    std::vector<std::uint64_t> ghost_counts(above, 0);
    GhostList ghosts(memory, objects);
    const std::size_t batch_size = tuning().build.batch;
    std::array<Entry, max_batch> batch;
    std::array<CellBox, max_batch> cells;
    std::array<Directory::Leaf, max_batch> leaves;
    std::array<std::uint32_t, max_batch> crossers;
    for (std::size_t begin = objects.begin; begin < objects.end; begin += batch_size) {
        if ((begin - objects.begin) % check_interval < batch_size) throw_if_stopped(stop);
        const std::size_t count = std::min(batch_size, objects.end - begin);
        if (const auto boxes = source.plain(begin, count); !boxes.empty()) {
            space.cells(boxes, cells);
        } else {
            const std::span<Entry> entries = std::span(batch).first(count);
            (void)source.load(begin, entries);
            space.cells(entries, cells);
        }
        directory.leaves(std::span(cells).first(count), leaves);
        std::size_t crossing = 0;
        for (std::size_t i = 0; i < count; ++i) {
            // No branch on whether a box crosses a border: its mispredictions cost more than all else in this loop.
            const bool crosses = !within(cells[i], leaves[i].level());
            const OctantIndex octant = natural_level(cells[i]) < leaves[i].level() ? above : leaves[i].octant();
            memory.homes[begin + i] = Home(octant, crosses);
            ++home_counts[octant];
            crossers[crossing] = std::uint32_t(i);
            crossing += crosses ? 1 : 0;
        }
        ghosts.prepare();
        for (const std::uint32_t i : std::span(crossers).first(crossing)) {
            const OctantIndex home = memory.homes[begin + i].octant();
            for_each_octant_of(cells[i], directory, leaves[i], [&](OctantIndex octant, unsigned begins) {
                if (octant == home) return;
                ++ghost_counts[octant];
                ghosts.add(octant, begins);
            });
            count_path(home == above ? Path::kept_above_leaf : Path::ghost_entries);
            ghosts.end_box();
        }
    }
    memory.ghost_counts[block.number] = ghosts.size();
    std::copy_n(home_counts.begin(), above, memory.home_part(memory.counts, block.number).begin());
    std::copy_n(ghost_counts.begin(), above, memory.ghost_part(memory.counts, block.number).begin());
}

void BuildSteps::count(const NumberedOctants& octants, std::span<const std::size_t> blocks) const {
    std::uint64_t at = 0;
    for (OctantIndex octant = octants.begin; octant < octants.end; ++octant) {
        memory.begins[octant] = at;
        for (const std::size_t block : blocks) {
            memory.home_part(memory.places, block)[octant] = at;
            at += memory.home_part(memory.counts, block)[octant];
        }
        for (const std::size_t block : blocks) {
            memory.ghost_part(memory.places, block)[octant] = at;
            at += memory.ghost_part(memory.counts, block)[octant];
        }
    }
    memory.totals[octants.number] = at;
}

namespace {

/// Returns the index of the next entry of each octant, for one block.
std::vector<std::uint64_t> places_of(std::span<const std::uint64_t> part, const ScatterTarget& target) {
    std::vector<std::uint64_t> places(part.begin(), part.end());
    for (const NumberedOctants& range : target.ranges) {
        const std::uint64_t begin = target.range_begins[range.number];
        for (OctantIndex octant = range.begin; octant < range.end; ++octant) places[octant] += begin;
    }
    return places;
}

}  // namespace

void BuildSteps::scatter(const NumberedBlock& block, const ScatterTarget& target) const {
    const auto above = OctantIndex(memory.octants);
    const ObjectBlock& objects = block.objects;
    const std::span<Entry> entries_out = target.entries;
    auto home_at = places_of(memory.home_part(memory.places, block.number), target);
    home_at.push_back(target.spare);
    auto ghost_at = places_of(memory.ghost_part(memory.places, block.number), target);
    const std::span<const Ghost> ghosts =
        std::as_const(memory.ghosts).span().subspan(max_ghosts * objects.begin, memory.ghost_counts[block.number]);
    const std::size_t batch_size = tuning().build.batch;
    std::array<Entry, max_batch> batch;
    std::array<std::uint32_t, max_batch> crossers;
    std::size_t ghost = 0;
    memory.valid[block.number] = 0;
    for (std::size_t begin = objects.begin; begin < objects.end; begin += batch_size) {
        if ((begin - objects.begin) % check_interval < batch_size) throw_if_stopped(stop);
        const std::span<Entry> entries(batch.data(), std::min(batch_size, objects.end - begin));
        if (!source.load(begin, entries)) return;
        const auto homes = std::as_const(memory.homes).span().subspan(begin, entries.size());
        std::size_t crossing = 0;
        for (std::size_t i = 0; i < entries.size(); ++i) {
            const Home soon = homes[std::min(i + prefetched, homes.size() - 1)];
            hwy::Prefetch(&entries_out[std::size_t(home_at[soon.octant()])]);
            const OctantIndex octant = homes[i].octant();
            std::uint64_t& at = home_at[octant];
            entries_out[std::size_t(at)] = entries[i];
            at += octant != above ? 1 : 0;
            crossers[crossing] = std::uint32_t(i);
            crossing += homes[i].crosses() ? 1 : 0;
        }
        for (const std::uint32_t i : std::span(crossers).first(crossing)) {
            for (bool last = false; !last; ++ghost) {
                last = ghosts[ghost].last();
                if (ghosts.size() - ghost > prefetched_ghosts) {
                    hwy::Prefetch(&entries_out[std::size_t(ghost_at[ghosts[ghost + prefetched_ghosts].octant()])]);
                }
                const OctantIndex octant = ghosts[ghost].octant();
                Entry& entry = entries_out[std::size_t(ghost_at[octant]++)];
                entry = entries[i];
                if ((entry.mask & begins_before) != 0) count_path(Path::class_bits_brought);
                if (planted(Fault::begins_bit_cleared)) entry.mask &= ~begins_before;
                entry.mask |= ghosts[ghost].begins();  // added to the bits that it has (boxes/entry.hpp)
            }
        }
    }
    memory.valid[block.number] = 1;
}

}  // namespace octopair
