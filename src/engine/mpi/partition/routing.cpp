#include "engine/mpi/partition/routing.hpp"

#include <algorithm>
#include <mutex>

#include "base/stop.hpp"
#include "base/test_hooks.hpp"
#include "base/tuning.hpp"
#include "octree/build/octants_of.hpp"

namespace octopair {

namespace {

constexpr std::size_t max_batch = default_tuning.ranks.batch;
static_assert(max_batch <= max_encoded);
constexpr std::size_t check_interval = 1 << 15;  // number of objects between two checks for a stop request

}  // namespace

// NOLINTNEXTLINE(readability-function-size): call, objects, octree, memory, stop.
Routing::Routing(const JointCall& call, const BoxSource& source, const OctreeLayout& layout, Memory& memory,
                 std::stop_token stop)
    : call_(call),
      source_(source),
      layout_(layout),
      locator_(layout.space, layout.directory),
      stop_(std::move(stop)),
      blocks_(memory.blocks_),
      places_(memory.places_) {
    counted_stride_ = std::max<std::size_t>(1, source.size() / tuning().ranks.counted);
    places_.resize_discard(source.size());
    const std::size_t objects_a_block = tuning().ranks.block;
    std::size_t count = 0, end = 0;
    for (unsigned set = 0; set < 2; ++set) {
        std::size_t begin = end;
        end += std::size_t(call.sizes[set]);
        for (; begin < end; begin += objects_a_block) {
            if (count == blocks_.size()) blocks_.emplace_back();
            blocks_[count++].begin(set, {begin, std::min(begin + objects_a_block, end)});
        }
    }
    blocks_.resize(count);
}

void Routing::find_homes(Executor& executor, std::span<OctantLoad> loads) {
    // The loads have one element for each octant. Each thread adds to a copy of its own; a single thread needs no copy.
    const std::size_t shares = std::min<std::size_t>(executor.width(), blocks_.size());
    std::mutex mutex;
    executor.for_each(shares, [&](std::size_t share) {
        std::vector<OctantLoad> copy(shares > 1 ? loads.size() : 0);
        const std::span<OctantLoad> own = shares > 1 ? std::span(copy) : loads;
        for (std::size_t i = share; i < blocks_.size(); i += shares) find_homes(blocks_[i], own);
        const std::lock_guard lock(mutex);
        for (std::size_t octant = 0; octant < copy.size(); ++octant) loads[octant].add(copy[octant]);
    });
    for (OctantLoad& load : loads) load.multiply(counted_stride_);
    for (const Block& block : blocks_) {
        if (block.bad) call_.refuse(source_, *block.bad);
    }
}

/// The boxes of a batch, in the form that the source has.
class Routing::SourceBatch {
public:
    explicit SourceBatch(const BoxSource& source) : source_(source) {}

    /// Loads objects [begin, begin + count) and finds their leaves. Returns false if one of them is no valid box.
    bool locate(std::size_t begin, std::size_t count, const BoxLocator& locator, LocatedBatch& batch) {
        plain_ = source_.plain(begin, count).boxes;
        if (!plain_.empty()) return locator.locate(plain_, batch);
        loaded_ = std::span(entries_).first(count);
        if (!source_.load(begin, std::span(entries_).first(count))) return false;
        locator.locate(loaded_, batch);
        return true;
    }
    void cells(const Space& space, std::span<CellBox> out) const {
        if (plain_.empty()) return space.cells(loaded_, out);
        space.cells(plain_, out);
    }

private:
    const BoxSource& source_;
    std::span<const Box3f> plain_;
    std::array<Entry, max_batch> entries_;
    std::span<const Entry> loaded_;
};

void Routing::find_homes(Block& block, std::span<OctantLoad> loads) {
    const Directory& directory = layout_.directory;
    const std::size_t batch_size = tuning().ranks.batch;
    SourceBatch boxes(source_);
    LocatedBatch batch;
    for (std::size_t begin = block.objects.begin; begin < block.objects.end; begin += batch_size) {
        if ((begin - block.objects.begin) % check_interval < batch_size) throw_if_stopped(stop_);
        const std::size_t count = std::min(batch_size, block.objects.end - begin);
        if (!boxes.locate(begin, count, locator_, batch)) {
            block.bad = begin;
            return;
        }
        for (std::size_t i = 0; i < count; ++i) places_[begin + i] = Directory::Leaf(batch.leaves[i]).octant();
        for (std::size_t i = 0; i < batch.crossers; ++i) {
            const Directory::Leaf home(batch.leaf[i]), end(batch.end_leaf[i]);
            block.crossers.push_back(
                {begin + batch.crosser[i], OctantOwners::reach(batch.cells(i), directory, home, end)});
        }
        if (begin / batch_size % counted_stride_ == 0) add_loads(boxes, count, batch, loads);
    }
}

void Routing::add_loads(const SourceBatch& boxes, std::size_t count, const LocatedBatch& batch,
                        std::span<OctantLoad> loads) const {
    std::array<CellBox, max_batch> cells;
    boxes.cells(layout_.space, std::span(cells).first(count));
    for (std::size_t i = 0; i < count; ++i) loads[Directory::Leaf(batch.leaves[i]).octant()].add(cells[i]);
    for (std::size_t i = 0; i < batch.crossers; ++i)
        loads[Directory::Leaf(batch.end_leaf[i]).octant()].add(cells[batch.crosser[i]]);
}

void Routing::assign_owners(Executor& executor, const OctantOwners& owners) {
    owners_ = &owners;
    several_ = owners.ranks();
    executor.for_each(blocks_.size(), [&](std::size_t i) { assign_owners(blocks_[i]); });
}

void Routing::assign_owners(Block& block) {
    block.counts.assign(several_ + 1, 0);
    for (std::size_t i = block.objects.begin; i < block.objects.end; ++i) {
        places_[i] = owners_->owner(places_[i]);
        ++block.counts[places_[i]];
    }
    std::vector<Crosser> shared;
    for (const Crosser& crosser : block.crossers) {
        std::uint32_t& place = places_[crosser.object];
        --block.counts[place];
        place = owners_->is_shared(crosser.reach) ? several_ : owners_->owner(crosser.reach.first);
        ++block.counts[place];
        if (place == several_) shared.push_back(crosser);
    }
    block.counts.pop_back();
    share(block, shared);
}

void Routing::share(Block& block, std::span<const Crosser> crossers) const {
    // Between the first and the last octant of a reach there may be octants that the box does not touch.
    std::vector<std::size_t> unclear;
    for (const Crosser& crosser : crossers) {
        if (!crosser.reach.only) unclear.push_back(crosser.object);
    }
    std::vector<Entry> entries(unclear.size());
    source_.pick(unclear, entries);
    std::vector<CellBox> cells(unclear.size());
    layout_.space.cells(entries, cells);

    const CellBox* next = cells.data();
    std::vector<std::uint32_t> owners;
    for (const Crosser& crosser : crossers) {
        owners = {owners_->owner(crosser.reach.first), owners_->owner(crosser.reach.last)};
        if (!crosser.reach.only) {
            owners.clear();
            owners_->for_each_owner(*next, layout_.directory.leaf(next->lo),
                                    [&](std::uint32_t owner) { owners.push_back(owner); });
            std::ranges::sort(owners);
            owners.erase(std::unique(owners.begin(), owners.end()), owners.end());
            ++next;
        }
        block.owners.push_back(std::uint32_t(owners.size()));
        block.owners.insert(block.owners.end(), owners.begin(), owners.end());
        if (owners.size() > 1) count_path(Path::object_on_ranks);
        block.shared += owners.size() > 1 ? 1 : 0;
        for (const std::uint32_t owner : owners) ++block.counts[owner];
    }
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

/// Calls place(object, to) for each copy of each object, objects ascending. next[rank]: place of the next object of a rank;
/// advanced by each copy.
template <typename Place>
void Routing::for_each_copy(const Block& block, RankCounts& next, const Place& place) const {
    const std::uint32_t* owners = block.owners.data();
    for (std::size_t object = block.objects.begin; object < block.objects.end; ++object) {
        if (places_[object] != several_) {
            place(object, next[places_[object]]++);
        } else {
            for (std::uint32_t left = *owners++; left > 0; --left) place(object, next[*owners++]++);
        }
    }
}

void Routing::pack(Executor& executor, unsigned set, const Objects& objects, ObjectArrays& out) const {
    // places[block][rank]: place of the block's first object for a rank. Places are ordered by rank, then by block.
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
        out.naming(call_.indices[set], call_.begins[set], [&](const auto& name) {
            executor.for_each(blocks_.size(), [&](std::size_t b) {
                if (blocks_[b].set != set) return;
                for_each_copy(blocks_[b], places[b], [&](std::size_t object, std::uint64_t to) {
                    copy(std::size_t(to), object - begin);
                    name(std::size_t(to), object - begin);
                });
            });
        });
    });
}

}  // namespace octopair
