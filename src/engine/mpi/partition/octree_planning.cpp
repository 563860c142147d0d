#include "engine/mpi/partition/octree_planning.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>
#include <vector>

#include "base/stop.hpp"
#include "base/tuning.hpp"
#include "engine/mpi/comm/agreement.hpp"
#include "octree/plan/octree_plan.hpp"

namespace octopair {

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

/// A box of the sample that is sent to the rank that grows an octant.
struct SentBox {
    OctantIndex octant;  ///< left octant of the shared top
    std::uint32_t kept;  ///< 1 if the octant or an ancestor keeps the entry, else 0
    std::array<std::uint32_t, 3> lo, hi;
};

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

}  // namespace

OctreePlanning::OctreePlanning(Communicator& comm, const JointCall& call, const BoxSource& own, std::stop_token stop)
    : comm_(comm), growth_(split_rule(call.objects(), stop)), stop_(std::move(stop)) {
    Agreement agreement(comm);
    OwnSample sample;
    agreement.together([&] { sample = own_sample(call, own); });
    shared_.space = fit_together(comm, sample.for_space, call.objects());
    agreement.together([&] {
        sampled_.resize(sample.boxes.size());
        shared_.space.cells(sample.boxes, sampled_);
    });
    const std::uint64_t most = octant_sample(call.objects()).size() / (tuning().ranks.octants * comm.size());
    top_.emplace(comm, growth_, most, sampled_);
    agreement.together([&] { shared_.directory = Directory(shared_.space, top_->shape()); });
}

OctreePlanning::OwnLayout OctreePlanning::grow(const OctantOwners& owners) {
    Agreement agreement(comm_);
    SentBoxes out;
    agreement.together([&] { out = boxes_to_send(*top_, sampled_, owners); });
    const Exchange counts = comm_.plan_exchange(std::move(out.to_each));
    std::vector<SentBox> in;
    agreement.together([&] { in.resize(counts.incoming()); });
    comm_.exchange(out.boxes.data(), in.data(), counts);
    OwnLayout own;
    agreement.together([&] {
        throw_if_stopped(stop_);
        const OctantIndex begin = owners.begin(comm_.rank()), end = owners.end(comm_.rank());
        std::vector<SampledOctant> octants(end - begin);
        for (const SentBox& box : in) {
            SampledOctant& sampled = octants[box.octant - begin];
            (box.kept != 0 ? sampled.kept : sampled.inside)
                .push_back({{box.lo[0], box.lo[1], box.lo[2], 0}, {box.hi[0], box.hi[1], box.hi[2], 0}});
        }
        const SplitFlags& top = top_->shape();
        SplitFlags shape(top.begin(), top.begin() + std::ptrdiff_t(begin));
        for (OctantIndex i = begin; i < end; ++i) {
            const SharedTop::SharedOctant& shared = top_->octants()[i];
            if (!shared.left) {
                shape.push_back(top[i]);
                continue;
            }
            octants[i - begin].octant = shared.octant;
            growth_.grow(std::exchange(octants[i - begin], {}), shape);
        }
        own.begin = begin;
        own.end = OctantIndex(shape.size());
        shape.insert(shape.end(), top.begin() + std::ptrdiff_t(end), top.end());
        own.layout.space = shared_.space;
        own.layout.directory = shape == top ? shared_.directory : Directory(shared_.space, shape);
    });
    return own;
}

}  // namespace octopair
