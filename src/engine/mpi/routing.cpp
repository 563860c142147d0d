#include "engine/mpi/routing.hpp"

#include <algorithm>
#include <mutex>

#include "base/stop.hpp"
#include "engine/mpi/agreement.hpp"
#include "geometry/box_kernel.hpp"
#include "octree/octants_of.hpp"

namespace octopair {

namespace {

constexpr std::size_t batch_size = 256;
constexpr std::size_t check_interval = 1 << 15;  // objects between looks for a stop
constexpr std::size_t block_size = 1 << 16;      // objects

}  // namespace

Routing::Routing(const JointCall& call, const BoxSource& source, const PlantedOctants& octants, std::stop_token stop)
    : call_(call), source_(source), octants_(octants), stop_(std::move(stop)), homes_(source.size()) {
    std::size_t end = 0;
    for (unsigned set = 0; set < 2; ++set) {
        std::size_t begin = end;
        end += std::size_t(call.sizes[set]);
        for (; begin < end; begin += block_size) {
            blocks_.push_back({.set = set, .objects = {begin, std::min(begin + block_size, end)}});
        }
    }
}

void Routing::find(Executor& executor, std::span<std::uint64_t> work) {
    std::mutex mutex;
    executor.for_each(blocks_.size(), [&](std::size_t i) {
        std::vector<std::uint64_t> own(work.size(), 0);
        find(blocks_[i], own);
        const std::lock_guard lock(mutex);
        std::transform(own.begin(), own.end(), work.begin(), work.begin(), std::plus<>());
    });
    for (const Block& block : blocks_) {
        if (block.bad) refuse(*block.bad);
    }
}

namespace {

/// The cells of objects [begin, begin + cells.size()) of a source; false if one of them is not a box.
bool load_cells(const BoxSource& source, const Frame& frame, std::size_t begin, std::span<CellBox> cells) {
    if (const auto boxes = source.plain(begin, cells.size()); !boxes.empty()) {
        frame.cells(boxes, cells);
        return are_boxes(boxes);
    }
    std::array<Entry, batch_size> entries;
    const std::span<Entry> loaded = std::span(entries).first(cells.size());
    const bool good = source.load(begin, loaded);
    frame.cells(loaded, cells);
    return good;
}

}  // namespace

void Routing::find(Block& block, std::span<std::uint64_t> work) {
    const Directory& directory = octants_.directory;
    std::array<CellBox, batch_size> cells, ends;
    std::array<Directory::Leaf, batch_size> homes, end_leaves;
    std::array<std::uint32_t, batch_size> crossers;
    for (std::size_t begin = block.objects.begin; begin < block.objects.end; begin += batch_size) {
        if ((begin - block.objects.begin) % check_interval == 0) throw_if_stopped(stop_);
        const std::size_t count = std::min(batch_size, block.objects.end - begin);
        if (!load_cells(source_, octants_.frame, begin, std::span(cells).first(count))) {
            block.bad = begin;
            return;
        }
        directory.leaves(std::span(cells).first(count), homes);
        std::size_t crossing = 0;
        for (std::size_t i = 0; i < count; ++i) {
            const bool crosses = !within(cells[i], homes[i].level());
            homes_[begin + i] = Home(homes[i].node(), crosses);
            ++work[homes[i].node()];
            crossers[crossing] = std::uint32_t(i);
            crossing += crosses ? 1 : 0;
        }
        for (std::size_t i = 0; i < crossing; ++i) ends[i].lo = cells[crossers[i]].hi;
        directory.leaves(std::span(ends).first(crossing), end_leaves);
        for (std::size_t i = 0; i < crossing; ++i) {
            const std::uint32_t object = crossers[i];
            block.reaches.push_back(OctantOwners::reach(cells[object], directory, homes[object], end_leaves[i]));
        }
    }
}

/// The first from this one on.
void Routing::refuse(std::size_t object) const {
    Entry entry;
    while (object + 1 < source_.size() && source_.load(object, {&entry, 1})) ++object;
    try {
        source_.refuse(object, {call_.begins[0], call_.begins[1]});
    } catch (const Error& error) {
        throw BadObject{call_.position(object), error.what()};
    }
}

void Routing::address(Executor& executor, const OctantOwners& owners) {
    owners_ = &owners;
    executor.for_each(blocks_.size(), [&](std::size_t i) { address(blocks_[i]); });
}

/// Calls visit(object, owner), or visit_shared(object) where there may be several, objects ascending.
template <typename Visit, typename VisitShared>
void Routing::for_each_object(const Block& block, Visit&& visit, VisitShared&& visit_shared) const {
    const Reach* reach = block.reaches.data();
    for (std::size_t object = block.objects.begin; object < block.objects.end; ++object) {
        const Home home = homes_[object];
        if (!home.crosses()) {
            visit(object, owners_->owner(home.node()));
        } else if (const Reach own = *reach++; !owners_->is_shared(own)) {
            visit(object, owners_->owner(own.first));
        } else {
            visit_shared(object);
        }
    }
}

void Routing::address(Block& block) {
    block.counts.assign(owners_->ranks(), 0);
    for_each_object(
        block, [&](std::size_t, unsigned owner) { ++block.counts[owner]; },
        [&](std::size_t object) { share(block, object); });
}

/// Between the first and the last octant of its reach there may be some that it does not touch.
void Routing::share(Block& block, std::size_t object) {
    Entry entry;
    source_.pick({&object, 1}, {&entry, 1});
    const CellBox cells = octants_.frame.cells(entry);
    const std::size_t count_at = block.owners.size();
    block.owners.push_back(0);
    const auto begin = [&] { return block.owners.begin() + std::ptrdiff_t(count_at) + 1; };
    owners_->for_each_owner(cells, octants_.directory.leaf(cells.lo), [&](std::uint32_t owner) {
        if (std::find(begin(), block.owners.end(), owner) == block.owners.end()) block.owners.push_back(owner);
    });
    std::sort(begin(), block.owners.end());
    const std::size_t count = block.owners.size() - count_at - 1;
    block.owners[count_at] = std::uint32_t(count);
    block.shared += count > 1 ? 1 : 0;
    std::for_each(begin(), block.owners.end(), [&](std::uint32_t owner) { ++block.counts[owner]; });
}

RankCounts Routing::counts(unsigned set) const {
    RankCounts all(owners_->ranks(), 0);
    for (const Block& block : blocks_) {
        if (block.set == set) std::ranges::transform(all, block.counts, all.begin(), std::plus<>());
    }
    return all;
}

std::uint64_t Routing::shared_objects() const {
    std::uint64_t objects = 0;
    for (const Block& block : blocks_) objects += block.shared;
    return objects;
}

/// Calls place(object, owner), objects ascending.
template <typename Place>
void Routing::for_each_copy(const Block& block, Place&& place) const {
    const std::uint32_t* next = block.owners.data();
    for_each_object(block, place, [&](std::size_t object) {
        for (std::uint32_t left = *next++; left > 0; --left) place(object, *next++);
    });
}

void Routing::pack(Executor& executor, unsigned set, const Objects& objects, ObjectArrays& out) const {
    // Where each block's go: by rank, then by block.
    std::vector<RankCounts> places(blocks_.size(), RankCounts(owners_->ranks()));
    std::uint64_t at = 0;
    for (unsigned rank = 0; rank < owners_->ranks(); ++rank) {
        for (std::size_t b = 0; b < blocks_.size(); ++b) {
            if (blocks_[b].set != set) continue;
            places[b][rank] = at;
            at += blocks_[b].counts[rank];
        }
    }
    out.resize(std::size_t(at));
    const std::size_t begin = set == 0 ? 0 : std::size_t(call_.sizes[0]);
    out.copying(objects, [&](const auto& copy) {
        executor.for_each(blocks_.size(), [&](std::size_t b) {
            if (blocks_[b].set != set) return;
            std::uint64_t* const next = places[b].data();
            for_each_copy(blocks_[b], [&](std::size_t object, std::uint32_t owner) {
                const std::size_t to = std::size_t(next[owner]++), from = object - begin;
                copy(to, from);
                out.positions[to] = std::uint32_t(call_.begins[set] + from);
            });
        });
    });
}

}  // namespace octopair
