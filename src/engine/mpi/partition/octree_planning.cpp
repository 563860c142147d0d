#include "engine/mpi/partition/octree_planning.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "base/stop.hpp"
#include "base/test_hooks.hpp"
#include "base/tuning.hpp"
#include "engine/mpi/comm/agreement.hpp"
#include "octree/plan/octree_plan.hpp"

namespace octopair {

/// A box of the sample that is sent to the rank that grows an octant.
struct SentBox {
    OctantIndex octant;  ///< left octant of the shared top
    std::uint32_t kept;  ///< 1 if the octant or an ancestor keeps the entry, else 0
    std::array<std::uint32_t, 3> lo, hi;
};

namespace {

/// This rank's part of the sample.
struct OwnSample {
    std::vector<Entry> boxes;
    std::vector<Entry> for_space;  ///< subset of `boxes` that the space is fitted to
};

OwnSample own_sample(const JointCall& call, const BoxSource& own) {
    const Sample sample = octant_sample(call.objects());
    const SpaceSample chosen(sample.size());
    std::vector<std::size_t> positions;
    std::vector<std::size_t> for_space;
    for_each_own(call, sample, [&](std::size_t i, std::size_t position) {
        if (chosen.has(i)) for_space.push_back(positions.size());
        positions.push_back(position);
    });
    OwnSample taken;
    taken.boxes.resize(positions.size());
    own.pick(positions, taken.boxes);
    for (const std::size_t i : for_space) taken.for_space.push_back(taken.boxes[i]);
    return taken;
}

constexpr unsigned space_measures = 3 * SpaceSample::measures;

/// Returns the rank that computes one of the nine measures that the space is fitted to (SpaceSample). `number`: of the measure.
unsigned measurer(unsigned number, unsigned ranks) {
    return ranks < space_measures ? number % ranks : number * ranks / space_measures;
}

Space fit_together(Communicator& comm, std::span<const Entry> own, std::uint64_t objects) {
    using Interval = SpaceSample::Interval;
    const unsigned ranks = comm.size();
    Agreement agreement(comm);
    std::vector<Interval> out;
    RankCounts to_each(ranks, 0);
    agreement.together([&] {
        for (unsigned rank = 0; rank < ranks; ++rank) {
            for (unsigned number = 0; number < space_measures; ++number) {
                if (measurer(number, ranks) != rank) continue;
                const unsigned axis = number / SpaceSample::measures;
                for (const Entry& box : own) out.push_back({box.min[axis], box.max[axis]});
                to_each[rank] += own.size();
            }
        }
    });
    const Exchange counts = comm.plan_exchange(std::move(to_each));
    std::vector<Interval> in;
    agreement.together([&] { in.resize(counts.incoming()); });
    comm.exchange(out.data(), in.data(), counts);

    std::vector<unsigned> numbers;  // measures that this rank computes
    for (unsigned number = 0; number < space_measures; ++number) {
        if (measurer(number, ranks) == comm.rank()) numbers.push_back(number);
    }
    std::vector<SpaceSample::Measured> measured;
    agreement.together([&] {
        for (std::size_t i = 0; i < numbers.size(); ++i) {
            // Each rank has sent equally many intervals for each measure.
            std::vector<Interval> intervals;
            auto from = in.begin();
            for (const std::uint64_t received : counts.received) {
                const auto each = std::ptrdiff_t(received / numbers.size());
                intervals.insert(intervals.end(), from + std::ptrdiff_t(i) * each, from + std::ptrdiff_t(i + 1) * each);
                from += std::ptrdiff_t(received);
            }
            measured.push_back(
                SpaceSample::measure(intervals, SpaceSample::Measure(numbers[i] % SpaceSample::measures)));
        }
    });
    const auto by_rank = comm.all_gather(std::span<const SpaceSample::Measured>(measured));
    SpaceSample::AllMeasured all;
    std::vector<std::size_t> next = by_rank.begins;
    for (unsigned number = 0; number < space_measures; ++number) {
        all[number] = by_rank.values[next[measurer(number, ranks)]++];
    }
    return Space::fit(all, objects);
}

/// Boxes of the sample to send, ordered by receiving rank.
struct SentBoxes {
    std::vector<SentBox> boxes;
    RankCounts to_each;
};

SentBoxes boxes_to_send(const SharedTop& top, std::span<const CellBox> cells, const OctantOwners& owners) {
    SentBoxes sent{{}, RankCounts(owners.ranks(), 0)};
    for (const SharedTop::SampledBox& box : top.boxes()) ++sent.to_each[owners.owner(box.octant)];
    RankCounts places(owners.ranks(), 0);
    std::exclusive_scan(sent.to_each.begin(), sent.to_each.end(), places.begin(), std::uint64_t(0));
    sent.boxes.resize(top.boxes().size());
    for (const SharedTop::SampledBox& box : top.boxes()) {
        const auto& [lo, hi] = cells[box.box];
        sent.boxes[std::size_t(places[owners.owner(box.octant)]++)] = {
            box.octant, box.kept ? 1u : 0u, {lo[0], lo[1], lo[2]}, {hi[0], hi[1], hi[2]}};
    }
    return sent;
}

/// Cost of the work on an entry apart from box tests and pairs, in box tests and in pairs: this work takes as long as 64 box tests, or as
/// 8 pairs. Measured.
constexpr double tests_per_entry_cost = 64;
constexpr double pairs_per_entry_cost = 8;

}  // namespace

std::uint64_t OctantEstimate::work(double entries) const {
    const double tests = std::min(entries * shortest, most_tests);
    const double pairs = entries / 2 * overlap;
    return std::uint64_t(entries * (1 + tests / tests_per_entry_cost + pairs / pairs_per_entry_cost));
}

OctreePlanning::OctreePlanning(Communicator& comm, const JointCall& call, const BoxSource& own, std::stop_token stop)
    : comm_(comm),
      objects_(call.objects()),
      growth_(split_rule(call.objects(), stop)),
      exact_(call.form.exact),
      stop_(std::move(stop)) {
    Agreement agreement(comm);
    OwnSample sample;
    agreement.together([&] { sample = own_sample(call, own); });
    space_ = fit_together(comm, sample.for_space, call.objects());
    std::vector<CellBox> cells;
    agreement.together([&] {
        cells.resize(sample.boxes.size());
        space_.cells(sample.boxes, cells);
    });
    // If all ranks will store the octree, its octants are distributed later. Then a rank needs no more than one octant to grow.
    const std::uint64_t octants = is_shared(estimated_octants()) ? 1 : tuning().ranks.octants;
    const std::uint64_t most = octant_sample(call.objects()).size() / (octants * comm.size());
    const SharedTop top(comm, growth_, most, cells);
    agreement.together([&] {
        estimate(top);
        std::vector<std::uint64_t> work;
        for (std::size_t i = 0; i < estimates_.size(); ++i)
            work.push_back(estimates_[i].work(growth_.objects(top.octants()[i].boxes)));
        growers_ = OctantOwners(work, comm.size());
    });
    const std::vector<SentBox> boxes = exchange_boxes(top, cells);
    Grown grown;
    agreement.together([&] { grown = grow(top, boxes); });
    share(top, std::move(grown));
}

/// True if all ranks store an octree of this many octants.
bool OctreePlanning::is_shared(std::uint64_t octants) const {
    return octants * tuning().ranks.objects_per_octant * comm_.size() <= objects_;
}

/// Returns the number of octants of an octree if the objects are distributed evenly over space: octants are half full.
std::uint64_t OctreePlanning::estimated_octants() const {
    return std::uint64_t(2 * double(objects_) / tuning().split.always_above);
}

/// Sets the estimates of the octants of the shared top.
void OctreePlanning::estimate(const SharedTop& top) {
    for (const SharedTop::SharedOctant& shared : top.octants()) {
        // The rank that grows a left octant divides it until each entry has few tests.
        const double most_tests = shared.left ? tuning().split.max_tests_per_object : infinite;
        estimates_.push_back({shared.shortest, shared.overlap, most_tests});
    }
}

/// Collective. Sends each sampled box to the ranks that grow the octants that it touches. Returns the boxes that this rank receives.
std::vector<SentBox> OctreePlanning::exchange_boxes(const SharedTop& top, std::span<const CellBox> cells) {
    Agreement agreement(comm_);
    SentBoxes out;
    agreement.together([&] { out = boxes_to_send(top, cells, growers_); });
    const Exchange counts = comm_.plan_exchange(std::move(out.to_each));
    std::vector<SentBox> in;
    agreement.together([&] { in.resize(counts.incoming()); });
    comm_.exchange(out.boxes.data(), in.data(), counts);
    return in;
}

/// Measures a crowded leaf by its sampled boxes.
OctreePlanning::Crowd OctreePlanning::crowd_of(const SampledOctant& leaf, std::size_t place) const {
    constexpr std::size_t most = 256;  // boxes that are tested against each other
    const std::span<const CellBox> boxes = leaf.inside;
    const Sample chosen(boxes.size(), 1, most);
    std::uint64_t overlaps = 0;
    std::array<std::uint64_t, 3> overlaps_on = {};  // by axis
    for (std::size_t i = 0; i < chosen.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            const CellBox &a = boxes[chosen[i]], &b = boxes[chosen[j]];
            bool overlap = true;
            for (unsigned axis = 0; axis < 3; ++axis) {
                const bool on_axis = a.lo[axis] <= b.hi[axis] && b.lo[axis] <= a.hi[axis];
                overlaps_on[axis] += on_axis ? 1 : 0;
                overlap &= on_axis;
            }
            overlaps += overlap ? 1 : 0;
        }
    }
    const double tested = double(chosen.size()) * double(chosen.size() - 1) / 2;
    // A sweep tests boxes that overlap on its axis, each pair once.
    const double shortest = double(*std::ranges::min_element(overlaps_on)) / tested / 2;
    return {OctantIndex(place), float(shortest), float(double(overlaps) / tested)};
}

/// Grows the octants of this rank's part of the shared top.
OctreePlanning::Grown OctreePlanning::grow(const SharedTop& top, std::span<const SentBox> boxes) const {
    throw_if_stopped(stop_);
    const OctantIndex begin = growers_.begin(comm_.rank()), end = growers_.end(comm_.rank());
    std::vector<SampledOctant> octants(end - begin);
    for (const SentBox& box : boxes) {
        SampledOctant& sampled = octants[box.octant - begin];
        (box.kept != 0 ? sampled.kept : sampled.inside)
            .push_back({{box.lo[0], box.lo[1], box.lo[2], 0}, {box.hi[0], box.hi[1], box.hi[2], 0}});
    }
    Grown grown;
    const auto add_crowd = [&](const SampledOctant& leaf, std::size_t place) {
        if (leaf.inside.size() < 2) return;
        if (growth_.is_crowd(leaf.inside.size())) grown.crowds.push_back(crowd_of(leaf, place));
        grown.needs_coordinates |= growth_.is_too_large_for_sweep(leaf.inside.size(), growth_.tests_per_object(leaf));
    };
    for (OctantIndex i = begin; i < end; ++i) {
        if (top.octants()[i].left) {
            octants[i - begin].octant = top.octants()[i].octant;
            growth_.grow(std::exchange(octants[i - begin], {}), grown.shape, add_crowd);
        } else {
            grown.shape.push_back(1);
        }
    }
    return grown;
}

/// Collective. Gives the whole octree to all ranks, or to each rank its own octants if the octree is too large.
void OctreePlanning::share(const SharedTop& top, Grown grown) {
    struct Part {
        std::uint64_t octants;
        std::uint64_t needs_coordinates;
    };
    const auto parts = comm_.all_gather(Part{grown.shape.size(), grown.needs_coordinates ? 1u : 0u});
    std::uint64_t octants = 0, before_own = 0;  // number of octants of all ranks, and of the ranks before this one
    for (unsigned rank = 0; rank < comm_.size(); ++rank) {
        if (rank < comm_.rank()) before_own += parts[rank].octants;
        octants += parts[rank].octants;
        needs_coordinates_ |= parts[rank].needs_coordinates != 0;
    }
    for (Crowd& crowd : grown.crowds) crowd.octant += OctantIndex(before_own);
    Agreement agreement(comm_);
    whole_ = is_shared(octants);
    count_path(whole_ ? Path::ranks_whole_octree : Path::ranks_part_of_octree);
    if (whole_) {
        const SplitFlags shape = comm_.all_gather(std::span<const std::uint8_t>(grown.shape)).values;
        const auto crowds = comm_.all_gather(std::span<const Crowd>(grown.crowds)).values;
        agreement.together([&] {
            shared_ = {space_, Directory(space_, shape)};
            refine(top);
            for (const Crowd& crowd : crowds) estimates_[crowd.octant] = {crowd.shortest, crowd.overlap, infinite};
        });
        return;
    }
    agreement.together([&] {
        shared_ = {space_, Directory(space_, top.shape())};
        const auto begin = top.shape().begin() + std::ptrdiff_t(growers_.begin(comm_.rank()));
        const auto end = top.shape().begin() + std::ptrdiff_t(growers_.end(comm_.rank()));
        SplitFlags shape(top.shape().begin(), begin);
        own_.begin = OctantIndex(shape.size());
        shape.insert(shape.end(), grown.shape.begin(), grown.shape.end());
        own_.end = OctantIndex(shape.size());
        shape.insert(shape.end(), end, top.shape().end());
        own_.layout = {space_, Directory(space_, shape)};
    });
}

/// Replaces the estimates of the shared top by those of the whole octree. An octant at a lower level has the same number of overlaps for
/// each box, among fewer boxes.
void OctreePlanning::refine(const SharedTop& top) {
    const std::span<const Octant> octants = shared_.directory.octants();
    std::vector<OctantEstimate> all;
    all.reserve(octants.size());
    OctantIndex next = 0;
    const unsigned fine_level = first_fine_level(space_, exact_);
    std::size_t fine = 0;  // number of leaves of that level or a deeper one
    for (std::size_t i = 0; i < top.octants().size(); ++i) {
        const OctantIndex end = top.octants()[i].left ? octants[next].next : next + 1;
        for (const unsigned level = octants[next].level; next < end; ++next) {
            const double finer = double(1u << (octants[next].level - level));
            all.push_back({std::min(1.0, estimates_[i].shortest * finer),
                           std::min(1.0, estimates_[i].overlap * finer * finer * finer), estimates_[i].most_tests});
            fine += octants[next].leaf() && octants[next].level >= fine_level ? 1 : 0;
        }
    }
    needs_coordinates_ |= double(fine) > tuning().ranks.max_fine_part * double(octants.size());
    estimates_ = std::move(all);
}

/// Returns the first level whose octants have so few float32 coordinates on an axis that many ends of boxes are equal, or differ by less
/// than rounding could cause. Then cells decide few hits. `exact`: boxes are not rounded.
unsigned OctreePlanning::first_fine_level(const Space& space, bool exact) {
    const double least = exact ? tuning().ranks.coordinates : tuning().ranks.rounded_coordinates;
    int level = int(deepest);
    for (unsigned axis = 0; axis < 3; ++axis) {
        const SpaceMap& map = space.map();
        const double origin = map.origin[axis], side = double(SpaceMap::last_fine_cell + 1) / map.scale[axis];
        const double end = origin + double(map.last[axis]) / map.scale[axis];
        const double spacing = std::max(std::abs(origin), std::abs(end)) * 0x1p-23;
        // The integer part of a logarithm: it is the same on all machines.
        if (side > 0 && spacing > 0) level = std::min(level, std::ilogb(side / (spacing * least)));
    }
    return unsigned(std::max(0, level)) + 1;
}

std::vector<std::uint64_t> OctreePlanning::work(std::span<const std::uint32_t> entries) const {
    std::vector<std::uint64_t> work(entries.size());
    for (std::size_t i = 0; i < work.size(); ++i) work[i] = estimates_[i].work(double(entries[i]));
    return work;
}

OctantOwners OctreePlanning::owners(std::span<const std::uint32_t> entries) const {
    return whole_ ? OctantOwners(work(entries), comm_.size()) : growers_;
}

OctreePlanning::OwnLayout OctreePlanning::take_own(const OctantOwners& owners) {
    if (!whole_) return std::move(own_);
    return {std::move(shared_), owners.begin(comm_.rank()), owners.end(comm_.rank())};
}

}  // namespace octopair
