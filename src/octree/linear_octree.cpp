#include "octree/linear_octree.hpp"

#include <hwy/cache_control.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <deque>
#include <utility>

#include "base/stop.hpp"
#include "octree/octants_of.hpp"
#include "octree/sample.hpp"

namespace octopair {

namespace {

constexpr std::size_t sample_stride = 64;        // one object of so many is sampled, but
constexpr std::size_t most_samples = 1 << 21;    // no more than these
constexpr std::size_t check_interval = 1 << 15;  // objects between looks for a stop
constexpr std::size_t blocks_per_thread = 2;     // each counts entries per octant
constexpr std::size_t batch_size = 256;          // objects loaded at a time: they stay in the first cache
constexpr std::size_t prefetched = 32;           // objects ahead whose places are fetched,
constexpr std::ptrdiff_t prefetched_ghosts = 8;  // and ghosts

/// The mask of an entry put into `node`: its class bits there, on top of those it brought where the node lies on the
/// frame's low border (the box then begins before the octant that this frame was made within).
std::uint32_t mask_in(const Node& node, std::uint32_t brought, std::uint32_t begins) {
    std::uint32_t border = 0;
    for (unsigned axis = 0; axis < 3; ++axis) border |= std::uint32_t(node.lo[axis] == 0) << axis;
    return (brought & ~begins_before) | begins | (brought & border);
}

double seconds_since(std::chrono::steady_clock::time_point& last) {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - last).count();
    last = now;
    return seconds;
}

}  // namespace

/// An entry of a box beyond the one in its home. Those of a box stand together, boxes ascending.
class Ghost {
public:
    Ghost(NodeIndex node, unsigned begins) : packed_(node << 4 | begins) {}

    NodeIndex node() const { return packed_ >> 4; }
    /// The class bits.
    unsigned begins() const { return packed_ & begins_before; }
    /// Whether it is the last one of its box.
    bool last() const { return (packed_ & last_bit) != 0; }
    void set_last() { packed_ |= last_bit; }

private:
    static constexpr std::uint32_t last_bit = 8;
    std::uint32_t packed_;
};

/// A share of the objects.
struct LinearOctree::Block {
    std::size_t begin = 0, end = 0;
    bool valid = true;
    std::deque<Ghost> ghosts;
    std::vector<std::uint64_t> home_at;  // per node: first the number of entries, after merge the next one's place
    std::vector<std::uint64_t> ghost_at;
};

void LinearOctree::build(const EntrySource& source, Executor& executor, std::stop_token stop) {
    const auto begin = std::chrono::steady_clock::now();
    plant(source, stop);
    fill(source, executor, stop, begin);
}

void LinearOctree::refill(const EntrySource& source, Executor& executor, std::stop_token stop) {
    fill(source, executor, stop, std::chrono::steady_clock::now());
}

void LinearOctree::fill(const EntrySource& source, Executor& executor, std::stop_token stop, Clock clock) {
    homes_.resize_discard(source.size());
    const std::size_t enough = std::max<std::size_t>(1, source.size() / (8 * batch_size));
    std::vector<Block> blocks(
        std::min<std::size_t>(executor.width() == 1 ? 1 : executor.width() * blocks_per_thread, enough));
    for (std::size_t i = 0; i < blocks.size(); ++i) {
        blocks[i].begin = source.size() * i / blocks.size();
        blocks[i].end = source.size() * (i + 1) / blocks.size();
    }
    executor.for_each(blocks.size(), [&](std::size_t i) { encode(source, blocks[i], stop); });
    seconds_.encode = seconds_since(clock);
    merge(blocks);
    seconds_.merge = seconds_since(clock);
    entries_.resize_discard(std::size_t(entry_count()) + blocks.size());
    executor.for_each(blocks.size(), [&](std::size_t i) { sort(source, blocks[i], stop); });
    const auto invalid = std::find_if(blocks.begin(), blocks.end(), [](const Block& block) { return !block.valid; });
    if (invalid != blocks.end()) throw Invalid{invalid->begin};
    if (crowded()) homes_ = {};  // the scan needs the memory more
    seconds_.sort = seconds_since(clock);
}

/// Whether one octant holds half of the entries.
bool LinearOctree::crowded() const {
    for (NodeIndex node = 0; node < nodes().size(); ++node) {
        if (2 * entries(node).size() > entry_count()) return true;
    }
    return false;
}

/// Frame and directory, from a sample that is gone when the entries need the memory.
void LinearOctree::plant(const EntrySource& source, std::stop_token stop) {
    const std::vector<Entry> sampled = sample(source);
    frame_ = Frame::fit(sampled, source.size());
    Directory::Boxes cells(sampled.size());
    frame_.cells(sampled, cells);
    const double weight = double(source.size()) / double(std::max<std::size_t>(1, cells.size()));
    directory_ = Directory(frame_, std::move(cells), weight, stop);
}

std::vector<Entry> LinearOctree::sample(const EntrySource& source) const {
    const Sample sample(source.size(), sample_stride, most_samples);
    std::vector<std::size_t> positions(sample.size());
    for (std::size_t i = 0; i < positions.size(); ++i) positions[i] = sample[i];
    std::vector<Entry> sampled(sample.size());
    source.pick(positions, sampled);  // what is invalid is found by sort, with its position
    return sampled;
}

void LinearOctree::encode(const EntrySource& source, Block& block, std::stop_token stop) {
    const auto above = NodeIndex(nodes().size());
    block.home_at.assign(above + 1, 0);  // the last one counts the boxes too large for the leaf they begin in
    block.ghost_at.assign(above, 0);
    std::array<Entry, batch_size> batch;
    std::array<CellBox, batch_size> cells;
    std::array<Directory::Leaf, batch_size> leaves;
    std::array<std::uint32_t, batch_size> crossers;
    for (std::size_t begin = block.begin; begin < block.end; begin += batch_size) {
        if ((begin - block.begin) % check_interval == 0) throw_if_stopped(stop);
        const std::size_t count = std::min(batch_size, block.end - begin);
        if (const auto boxes = source.plain(begin, count); !boxes.empty()) {
            frame_.cells(boxes, cells);
        } else {
            const std::span<Entry> entries = std::span(batch).first(count);
            (void)source.load(begin, entries);
            frame_.cells(entries, cells);
        }
        directory_.leaves(std::span(cells).first(count), leaves);
        std::size_t crossing = 0;
        for (std::size_t i = 0; i < count; ++i) {
            // No branch on whether a box crosses: mispredicting it cost more than everything else here.
            const bool crosses = !within(cells[i], leaves[i].level());
            const NodeIndex node = natural_level(cells[i]) < leaves[i].level() ? above : leaves[i].node();
            homes_[begin + i] = Home(node, crosses);
            ++block.home_at[node];
            crossers[crossing] = std::uint32_t(i);
            crossing += crosses ? 1 : 0;
        }
        for (const std::uint32_t i : std::span(crossers).first(crossing)) {
            const NodeIndex home = homes_[begin + i].node();
            for_each_octant_of(cells[i], directory_, leaves[i], [&](NodeIndex node, unsigned begins) {
                if (node == home) return;
                ++block.ghost_at[node];
                block.ghosts.emplace_back(node, begins);
            });
            block.ghosts.back().set_last();
        }
    }
}

void LinearOctree::merge(std::span<Block> blocks) {
    begins_.resize(nodes().size() + 1);
    std::uint64_t at = 0;
    const auto place = [&](std::uint64_t& count) { at += std::exchange(count, at); };
    for (std::size_t node = 0; node < nodes().size(); ++node) {
        begins_[node] = at;
        for (Block& block : blocks) place(block.home_at[node]);
        for (Block& block : blocks) place(block.ghost_at[node]);
    }
    begins_.back() = at;
    // Beyond the entries each block has one to write the boxes to that are too large for a leaf.
    for (Block& block : blocks) block.home_at.back() = at++;
}

void LinearOctree::sort(const EntrySource& source, Block& block, std::stop_token stop) {
    const auto above = NodeIndex(nodes().size());
    std::array<Entry, batch_size> batch;
    std::array<std::uint32_t, batch_size> crossers;
    auto ghost = block.ghosts.begin();
    for (std::size_t begin = block.begin; begin < block.end; begin += batch_size) {
        if ((begin - block.begin) % check_interval == 0) throw_if_stopped(stop);
        const std::span<Entry> entries(batch.data(), std::min(batch_size, block.end - begin));
        if (!source.load(begin, entries)) {
            block.valid = false;
            return;
        }
        const auto homes = homes_.span().subspan(begin, entries.size());
        std::size_t crossing = 0;
        for (std::size_t i = 0; i < entries.size(); ++i) {
            const Home soon = homes[std::min(i + prefetched, homes.size() - 1)];
            hwy::Prefetch(&entries_[std::size_t(block.home_at[soon.node()])]);
            const NodeIndex node = homes[i].node();
            std::uint64_t& at = block.home_at[node];
            entries_[std::size_t(at)] = entries[i];
            if ((entries[i].mask & begins_before) != 0 && node != above) {
                entries_[std::size_t(at)].mask = mask_in(nodes()[node], entries[i].mask, 0);
            }
            at += node != above ? 1 : 0;
            crossers[crossing] = std::uint32_t(i);
            crossing += homes[i].crosses() ? 1 : 0;
        }
        for (const std::uint32_t i : std::span(crossers).first(crossing)) {
            for (bool last = false; !last; ++ghost) {
                last = ghost->last();
                if (block.ghosts.end() - ghost > prefetched_ghosts) {
                    hwy::Prefetch(&entries_[std::size_t(block.ghost_at[ghost[prefetched_ghosts].node()])]);
                }
                Entry& entry = entries_[std::size_t(block.ghost_at[ghost->node()]++)];
                entry = entries[i];
                entry.mask = mask_in(nodes()[ghost->node()], entry.mask, ghost->begins());
            }
        }
    }
    block.ghosts.clear();
}

}  // namespace octopair
