#include "engine/mpi/partition/routing.hpp"

#include <hwy/cache_control.h>

#include <algorithm>
#include <functional>
#include <mutex>
#include <utility>

#include "base/stop.hpp"
#include "base/test_hooks.hpp"
#include "base/tuning.hpp"

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

std::vector<std::uint32_t> Routing::find_homes(Executor& executor) {
    std::vector<std::uint64_t> entries(layout_.directory.octants().size());
    // Each thread counts the entries of all octants in an array of its own; a single thread needs no copy.
    const std::size_t shares = std::min<std::size_t>(executor.width(), blocks_.size());
    std::mutex mutex;
    executor.for_each(shares, [&](std::size_t share) {
        std::vector<std::uint64_t> copy(shares > 1 ? entries.size() : 0);
        const std::span<std::uint64_t> own = shares > 1 ? copy : entries;
        for (std::size_t i = share; i < blocks_.size(); i += shares) find_homes(blocks_[i], own);
        const std::lock_guard lock(mutex);
        for (std::size_t octant = 0; octant < copy.size(); ++octant) entries[octant] += copy[octant];
    });
    for (const Block& block : blocks_) {
        if (block.bad) call_.refuse(source_, *block.bad);
    }
    const auto unit_bits = unsigned(std::max(0, int(std::bit_width(2 * call_.objects())) - 32));
    std::vector<std::uint32_t> counts(entries.size());
    std::ranges::transform(entries, counts.begin(),
                           [=](std::uint64_t count) { return std::uint32_t(count >> unit_bits); });
    return counts;
}

/// Finds the leaves of objects [begin, begin + count). Returns false if one of them is no valid box.
bool Routing::locate(std::size_t begin, std::size_t count, LocatedBatch& batch) const {
    std::array<Box3f, max_batch> room;
    const Float32Boxes some = source_.float32_boxes(begin, std::span(room).first(count));
    if (!some.boxes.empty()) return some.valid && locator_.locate(some.boxes, batch);
    std::array<Entry, max_batch> entries;
    const std::span<Entry> loaded = std::span(entries).first(count);
    if (!source_.load(begin, loaded)) return false;
    locator_.locate(loaded, batch);
    return true;
}

void Routing::find_homes(Block& block, std::span<std::uint64_t> entries) {
    const std::size_t batch_size = tuning().ranks.batch;
    LocatedBatch batch;
    for (std::size_t begin = block.objects.begin; begin < block.objects.end; begin += batch_size) {
        if ((begin - block.objects.begin) % check_interval < batch_size) throw_if_stopped(stop_);
        const std::size_t count = std::min(batch_size, block.objects.end - begin);
        if (!locate(begin, count, batch)) {
            block.bad = begin;
            return;
        }
        for (std::size_t i = 0; i < count; ++i) {
            places_[begin + i] = Directory::Leaf(batch.leaves[i]).octant();
            ++entries[places_[begin + i]];
        }
        for (std::size_t i = 0; i < batch.crossers; ++i) {
            const Directory::Leaf home(batch.leaf[i]), end(batch.end_leaf[i]);
            ++entries[end.octant()];
            block.crossers.push_back(
                {begin + batch.crosser[i], OctantOwners::reach(batch.cells(i), layout_.directory, home, end)});
        }
    }
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
    // Objects whose owners only the box shows: octants between the first and the last octant of a reach may not touch the box.
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
            owners_->for_each_owner(*next, layout_.directory, layout_.directory.leaf(next->lo),
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

bool Routing::are_positions_near(unsigned set) const {
    static_assert(2 * default_tuning.ranks.block <= std::size_t(1) << 16);
    if (planted(Fault::positions_always_near)) return true;
    return std::ranges::all_of(blocks_, [&](const Block& block) {
        return block.set != set || std::ranges::find(block.counts, std::uint64_t(0)) == block.counts.end();
    });
}

namespace {

/// A property of objects, and the arrays that it is copied to.
template <typename T, typename Value>
struct ColumnSource {
    ColumnSource(T* to_sent, T* to_own, Value of_object) : sent(to_sent), own(to_own), value(std::move(of_object)) {}

    T* sent;      // ordered by receiving rank
    T* own;       // receives the objects that stay on this rank; if null, `sent` receives them
    Value value;  // returns the property of an object
};

/// Where the next objects of a block go.
template <typename T, typename Value>
class Column {
public:
    /// `counts`: number of objects for each rank; `before`: how many of these objects are in earlier blocks.
    Column(const ColumnSource<T, Value>& source, const RankCounts& counts, const RankCounts& before, unsigned own_rank)
        : value_(source.value) {
        T* sent = source.sent;
        for (unsigned rank = 0; rank < counts.size(); ++rank) {
            const bool stays = rank == own_rank && source.own != nullptr;
            places_.push_back((stays ? source.own : sent) + before[rank]);
            sent += stays ? 0 : counts[rank];
        }
    }

    void copy(std::size_t object, std::uint32_t rank) {
        // Hardware prefetchers do not follow writes that alternate between many places.
        constexpr std::size_t ahead_bytes = 112;
        T* const place = places_[rank]++;
        *place = value_(object);
        hwy::Prefetch(reinterpret_cast<const std::byte*>(place) + ahead_bytes);
    }

private:
    std::vector<T*> places_;
    const Value& value_;
};

}  // namespace

/// Copies each object of a block to all of its owners, objects ascending.
template <typename... Columns>
void Routing::copy(const Block& block, Columns&&... columns) const {
    const std::uint32_t* owners = block.owners.data();
    for (std::size_t object = block.objects.begin; object < block.objects.end; ++object) {
        if (places_[object] != several_) {
            (columns.copy(object, places_[object]), ...);
        } else {
            for (std::uint32_t left = *owners++; left > 0; --left, ++owners) (columns.copy(object, *owners), ...);
        }
    }
}

/// Copies all objects of a set. `rank`: this rank.
template <typename... Sources>
void Routing::pack_columns(Executor& executor, unsigned set, unsigned rank, const Sources&... sources) const {
    std::vector<RankCounts> before(blocks_.size());
    RankCounts all(owners_->ranks(), 0);
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
        before[b] = all;
        if (blocks_[b].set == set) std::ranges::transform(all, blocks_[b].counts, all.begin(), std::plus<>());
    }
    executor.for_each(blocks_.size(), [&](std::size_t b) {
        if (blocks_[b].set == set) copy(blocks_[b], Column(sources, all, before[b], rank)...);
    });
}

void Routing::pack(Executor& executor, unsigned set, const Objects& objects, const Packed& to) const {
    const std::size_t begin = set == 0 ? 0 : std::size_t(call_.sizes[0]);
    const auto pack_with_names = [&](auto* names, const auto& name) {
        const auto pack_boxes = [&](auto* sent, auto* own, const auto boxes) {
            pack_columns(
                executor, set, to.rank,
                ColumnSource{sent, own + to.own_place, [=](std::size_t object) { return boxes[object - begin]; }},
                ColumnSource{names, decltype(names)(), name});
        };
        if (to.sent.wide) {
            pack_boxes(to.sent.wide_boxes.data(), to.own.wide_boxes.data(),
                       std::get<std::span<const Box3d>>(objects.boxes));
        } else {
            pack_boxes(to.sent.boxes.data(), to.own.boxes.data(), std::get<std::span<const Box3f>>(objects.boxes));
        }
    };
    const std::uint64_t first = call_.begins[set] - begin;  // position of object 0, modulo 2^64
    if (to.sent.indexed) {
        const auto indices = call_.indices[set];
        pack_with_names(to.sent.indices.data(), [=](std::size_t object) { return indices[object - begin]; });
    } else if (to.sent.near) {
        pack_with_names(to.sent.near_positions.data(),
                        [=](std::size_t object) { return near_position(std::uint32_t(first + object)); });
    } else {
        pack_with_names(to.sent.positions.data(), [=](std::size_t object) { return std::uint32_t(first + object); });
    }
    if (to.sent.padded) {
        const auto padding = [&](std::size_t object) { return objects.padding[object - begin]; };
        pack_columns(executor, set, to.rank,
                     ColumnSource{to.sent.padding.data(), to.own.padding.data() + to.own_place, padding});
    }
}

}  // namespace octopair
