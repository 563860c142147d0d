#include "engine/mpi/routing.hpp"

#include <algorithm>
#include <mutex>

#include "base/stop.hpp"
#include "engine/mpi/agreement.hpp"
#include "octree/octants_of.hpp"

namespace octopair {

namespace {

constexpr std::size_t batch_size = 256;
constexpr std::size_t check_interval = 1 << 15;  // objects between looks for a stop
constexpr std::size_t block_size = 1 << 16;      // objects

}  // namespace

Routing::Routing(const JointCall& call, const BoxSource& source, const PlantedOctants& octants, std::stop_token stop)
    : call_(call),
      source_(source),
      octants_(octants),
      stop_(std::move(stop)),
      homes_(source.size()),
      owners_(source.size()) {
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

void Routing::find(Block& block, std::span<std::uint64_t> work) {
    std::array<Entry, batch_size> entries;
    std::array<CellBox, batch_size> cells;
    std::array<Directory::Leaf, batch_size> leaves;
    for (std::size_t begin = block.objects.begin; begin < block.objects.end; begin += batch_size) {
        if ((begin - block.objects.begin) % check_interval == 0) throw_if_stopped(stop_);
        const std::size_t count = std::min(batch_size, block.objects.end - begin);
        const std::span<Entry> loaded = std::span(entries).first(count);
        if (!source_.load(begin, loaded)) {
            block.bad = begin;
            return;
        }
        octants_.frame.cells(loaded, cells);
        octants_.directory.leaves(std::span(cells).first(count), leaves);
        for (std::size_t i = 0; i < count; ++i) {
            const NodeIndex node = leaves[i].node();
            homes_[begin + i] = Home(node, !within(cells[i], leaves[i].level()));
            ++work[node];
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
    ranks_ = owners.ranks();
    executor.for_each(blocks_.size(), [&](std::size_t i) {
        blocks_[i].counts.assign(ranks_, 0);
        address(blocks_[i], owners);
    });
}

void Routing::address(Block& block, const OctantOwners& owners) {
    std::array<std::size_t, batch_size> crossers;
    std::array<Entry, batch_size> entries;
    std::array<CellBox, batch_size> cells;
    std::vector<std::uint32_t> found;
    for (std::size_t begin = block.objects.begin; begin < block.objects.end; begin += batch_size) {
        if ((begin - block.objects.begin) % check_interval == 0) throw_if_stopped(stop_);
        const std::size_t end = std::min(begin + batch_size, block.objects.end);
        std::size_t crossing = 0;
        for (std::size_t i = begin; i < end; ++i) {
            const unsigned owner = owners.owner(homes_[i].node());
            owners_[i] = owner;
            block.counts[owner] += homes_[i].crosses() ? 0 : 1;
            crossers[crossing] = i;
            crossing += homes_[i].crosses() ? 1 : 0;
        }
        source_.pick(std::span(crossers).first(crossing), std::span(entries).first(crossing));
        octants_.frame.cells(std::span(entries).first(crossing), cells);
        for (std::size_t i = 0; i < crossing; ++i) {
            found.clear();
            owners.for_each_owner(cells[i], octants_.directory.leaf(cells[i].lo),
                                  [&](std::uint32_t owner) { found.push_back(owner); });
            std::ranges::sort(found);
            found.erase(std::unique(found.begin(), found.end()), found.end());
            for (const std::uint32_t owner : found) ++block.counts[owner];
            owners_[crossers[i]] = found.front();
            if (found.size() == 1) continue;
            owners_[crossers[i]] = several;
            ++block.shared;
            block.owners.push_back(std::uint32_t(found.size()));
            block.owners.insert(block.owners.end(), found.begin(), found.end());
        }
    }
}

RankCounts Routing::counts(unsigned set) const {
    RankCounts all(ranks_, 0);
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
    auto next = block.owners.begin();
    for (std::size_t object = block.objects.begin; object < block.objects.end; ++object) {
        if (owners_[object] != several) {
            place(object, owners_[object]);
            continue;
        }
        for (std::uint32_t left = *next++; left > 0; --left) place(object, *next++);
    }
}

void Routing::pack(Executor& executor, unsigned set, const Objects& objects, ObjectArrays& out) const {
    // Where each block's go: by rank, then by block.
    std::vector<RankCounts> places(blocks_.size(), RankCounts(ranks_));
    std::uint64_t at = 0;
    for (unsigned rank = 0; rank < ranks_; ++rank) {
        for (std::size_t b = 0; b < blocks_.size(); ++b) {
            if (blocks_[b].set != set) continue;
            places[b][rank] = at;
            at += blocks_[b].counts[rank];
        }
    }
    out.resize(std::size_t(at));
    const std::size_t begin = set == 0 ? 0 : std::size_t(call_.sizes[0]);
    executor.for_each(blocks_.size(), [&](std::size_t b) {
        if (blocks_[b].set != set) return;
        for_each_copy(blocks_[b], [&](std::size_t object, std::uint32_t owner) {
            const std::size_t own = object - begin;
            out.put(std::size_t(places[b][owner]++), objects, own, std::uint32_t(call_.begins[set] + own));
        });
    });
}

}  // namespace octopair
