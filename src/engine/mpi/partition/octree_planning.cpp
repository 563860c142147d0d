#include "engine/mpi/partition/octree_planning.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>
#include <utility>
#include <vector>

#include "base/stop.hpp"
#include "base/test_hooks.hpp"
#include "base/tuning.hpp"
#include "engine/mpi/comm/agreement.hpp"
#include "engine/mpi/partition/even_cuts.hpp"
#include "octree/build/split_rule.hpp"

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

/// Returns the rank that computes measure `number` of the space.
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

/// A box of this rank's part of the sample, in an octant of the shared top.
struct SharedTopBox {
    std::uint32_t octant;  ///< number of the octant
    std::uint32_t box;     ///< number of the box in the sample
    bool kept;             ///< the entry is kept by this octant or by an ancestor
};

/// The octants at the top of the octree that all ranks divide together, level by level. Octants that are not decided here are
/// "left": one rank grows the subtree of each of them.
class SharedTop {
public:
    /// Divides octants until each one has at most `most` boxes of the sample, or is not to be divided. The sums that decide are
    /// the same on all ranks. `own`: this rank's part of the sample. Borrows `comm`, `growth` and `own`.
    SharedTop(Communicator& comm, const SplitRule& growth, std::uint64_t most, std::span<const CellBox> own)
        : comm_(comm), growth_(growth), most_(most), own_(own) {
        octants_.push_back({OctantCube{}});
        std::vector<SharedTopBox> boxes(own.size());
        for (std::uint32_t i = 0; i < own.size(); ++i) boxes[i] = {0, i, false};
        for (std::size_t level = 0; level < octants_.size();) {
            const std::size_t end = octants_.size();
            divide(level, boxes);
            level = end;
        }
        number_left(0);
    }

    /// Returns the number of sample boxes, on all ranks, of each octant that is left, in pre-order.
    const std::vector<std::uint64_t>& sizes() const { return left_sizes_; }
    /// Returns an octant that is left. `left`: its number among those in pre-order.
    const OctantCube& octant(std::size_t left) const { return octants_[left_[left]].octant; }
    /// Returns this rank's sample boxes in octants that are left.
    std::span<const SharedTopBox> boxes() const { return boxes_left_; }
    /// Returns the number of the box's octant among those that are left.
    std::uint32_t number(const SharedTopBox& box) const { return octants_[box.octant].number; }
    const CellBox& cells(const SharedTopBox& box) const { return own_[box.box]; }

    /// Returns the shape of the whole octree. `left`: the shapes of the octants that are left, in pre-order.
    SplitFlags shape(std::span<const std::uint8_t> left) const {
        SplitFlags whole;
        append_shape(0, left, whole);
        return whole;
    }

private:
    enum class State : std::uint8_t { left, whole, divided };
    struct SharedTopOctant {
        OctantCube octant;
        State state = State::left;
        std::uint32_t below = 0;   ///< number of the first of its eight children
        std::uint32_t number = 0;  ///< number among the octants that are left
        std::uint64_t size = 0;    ///< number of sample boxes, on all ranks
    };

    /// Divides the octants from `first` on. `boxes`: the boxes in these octants; replaced by those in their children.
    void divide(std::size_t first, std::vector<SharedTopBox>& boxes) {
        constexpr std::size_t each = 5;  // counts of an octant
        std::vector<std::uint64_t> sums;
        Agreement(comm_).together([&] {
            sums.resize(each * (octants_.size() - first), 0);
            for (SharedTopBox& box : boxes) count(box, std::span(sums).subspan(each * (box.octant - first), each));
        });
        comm_.add_up(sums);
        Agreement(comm_).together([&] {
            const std::size_t end = octants_.size();
            for (std::size_t i = first; i < end; ++i) {
                const std::uint64_t* sum = &sums[each * (i - first)];
                decide(i, {.inside = sum[0],
                           .kept = sum[1],
                           .beginning = sum[2],
                           .inside_below = sum[3],
                           .kept_below = sum[4]});
            }
            hand_down(boxes);
        });
    }

    void count(SharedTopBox& box, std::span<std::uint64_t> sum) const {
        const OctantCube& octant = octants_[box.octant].octant;
        const CellBox& cells = own_[box.box];
        box.kept |= octant.keeps(cells);
        const auto below = octant.level < deepest ? std::uint64_t(std::popcount(octant.touched_below(cells))) : 0;
        ++sum[box.kept ? 1 : 0];
        sum[2] += !box.kept && octant.holds_begin(cells) ? 1 : 0;
        sum[box.kept ? 4 : 3] += below;
    }

    void decide(std::size_t i, const OctantCounts& counts) {
        const OctantCube octant = octants_[i].octant;
        octants_[i].size = counts.inside + counts.kept;
        if (octant.level >= deepest || octants_[i].size <= most_ || !growth_.is_crowd(counts.inside)) return;
        const bool divided = SplitRule::worth_splitting(counts);
        if (divided) count_path(Path::ranks_top_divided);
        octants_[i].state = divided ? State::divided : State::whole;
        octants_[i].below = std::uint32_t(octants_.size());
        for (unsigned digit = 0; divided && digit < 8; ++digit) octants_.push_back({octant.child(digit)});
    }

    void hand_down(std::vector<SharedTopBox>& boxes) {
        std::vector<SharedTopBox> next;
        for (const SharedTopBox& box : boxes) {
            const SharedTopOctant& octant = octants_[box.octant];
            if (octant.state == State::left) boxes_left_.push_back(box);
            if (octant.state != State::divided) continue;
            unsigned touched = octant.octant.touched_below(own_[box.box]);
            for (; touched != 0; touched &= touched - 1)
                next.push_back({octant.below + std::uint32_t(std::countr_zero(touched)), box.box, box.kept});
        }
        boxes = std::move(next);
    }

    void number_left(std::size_t i) {
        SharedTopOctant& octant = octants_[i];
        if (octant.state == State::left) {
            octant.number = std::uint32_t(left_.size());
            left_.push_back(i);
            left_sizes_.push_back(octant.size);
        }
        if (octant.state != State::divided) return;
        for (std::size_t digit = 0; digit < 8; ++digit) number_left(octant.below + digit);
    }

    /// Appends the shape of octant `i` and its descendants. Removes the shapes that are used from the front of `left`.
    void append_shape(std::size_t i, std::span<const std::uint8_t>& left, SplitFlags& shape) const {
        const SharedTopOctant& octant = octants_[i];
        if (octant.state != State::left) {
            const bool divided = octant.state == State::divided;
            shape.push_back(divided ? 1 : 0);
            for (std::size_t digit = 0; divided && digit < 8; ++digit) append_shape(octant.below + digit, left, shape);
            return;
        }
        std::size_t open = 1, taken = 0;
        for (; open > 0; ++taken) open += left[taken] != 0 ? 7 : std::size_t(-1);
        shape.insert(shape.end(), left.begin(), left.begin() + std::ptrdiff_t(taken));
        left = left.subspan(taken);
    }

    Communicator& comm_;
    const SplitRule& growth_;
    std::uint64_t most_;
    std::span<const CellBox> own_;
    std::vector<SharedTopOctant> octants_;  // level by level
    std::vector<SharedTopBox> boxes_left_;
    std::vector<std::size_t> left_;  // numbers of the octants that are left, in pre-order
    std::vector<std::uint64_t> left_sizes_;
};

/// A sample box that is sent to the rank that grows its octant.
struct SentBox {
    std::uint32_t octant;  ///< number of the octant among those that are left
    std::uint32_t kept;    ///< 1 if the octant or an ancestor keeps the entry, else 0
    std::array<std::uint32_t, 3> lo, hi;
};

/// Collective. Sends sample boxes to the ranks that grow their octants. Returns the octants that this rank grows, with the
/// boxes of all ranks.
std::vector<SampledOctant> collect_octants(Communicator& comm, const SharedTop& top) {
    Agreement agreement(comm);
    const std::vector<std::size_t> cuts = even_cuts(top.sizes(), comm.size());
    std::vector<SentBox> out;
    RankCounts to_each(comm.size(), 0);
    agreement.together([&] {
        const auto rank_of = [&](const SharedTopBox& box) {
            return std::size_t(std::upper_bound(cuts.begin() + 1, cuts.end() - 1, top.number(box)) - cuts.begin()) - 1;
        };
        for (const SharedTopBox& box : top.boxes()) ++to_each[rank_of(box)];
        RankCounts places(comm.size(), 0);
        std::exclusive_scan(to_each.begin(), to_each.end(), places.begin(), std::uint64_t(0));
        out.resize(top.boxes().size());
        for (const SharedTopBox& box : top.boxes()) {
            const CellBox& cells = top.cells(box);
            out[std::size_t(places[rank_of(box)]++)] = {top.number(box),
                                                        box.kept ? 1u : 0u,
                                                        {cells.lo[0], cells.lo[1], cells.lo[2]},
                                                        {cells.hi[0], cells.hi[1], cells.hi[2]}};
        }
    });
    const Exchange counts = comm.plan_exchange(std::move(to_each));
    std::vector<SentBox> in;
    agreement.together([&] { in.resize(counts.incoming()); });
    comm.exchange(out.data(), in.data(), counts);
    const std::size_t first = cuts[comm.rank()], end = cuts[comm.rank() + 1];
    std::vector<SampledOctant> own;
    agreement.together([&] {
        own.resize(end - first);
        for (std::size_t i = first; i < end; ++i) own[i - first].octant = top.octant(i);
        for (const SentBox& box : in) {
            SampledOctant& sampled = own[box.octant - first];
            (box.kept != 0 ? sampled.kept : sampled.inside)
                .push_back({{box.lo[0], box.lo[1], box.lo[2], 0}, {box.hi[0], box.hi[1], box.hi[2], 0}});
        }
    });
    return own;
}

}  // namespace

OctreeLayout plan_together(Communicator& comm, const JointCall& call, const BoxSource& own,
                           const std::stop_token& stop) {
    Agreement agreement(comm);
    OwnSample sample;
    agreement.together([&] { sample = own_sample(call, own); });
    OctreeLayout layout;
    layout.space = fit_together(comm, sample.for_space, call.objects());

    std::vector<CellBox> cells;
    agreement.together([&] {
        cells.resize(sample.boxes.size());
        layout.space.cells(sample.boxes, cells);
    });
    const SplitRule growth = split_rule(call.objects(), stop);
    const std::uint64_t most = octant_sample(call.objects()).size() / (tuning().ranks.octants * comm.size());
    const SharedTop top(comm, growth, most, cells);
    std::vector<SampledOctant> own_octants = collect_octants(comm, top);
    SplitFlags own_shapes;
    agreement.together([&] {
        throw_if_stopped(stop);
        for (SampledOctant& octant : own_octants) growth.grow(std::exchange(octant, {}), own_shapes);
    });
    const auto shapes = comm.all_gather(std::span<const std::uint8_t>(own_shapes));
    agreement.together([&] { layout.directory = Directory(layout.space, top.shape(shapes.values)); });
    return layout;
}

}  // namespace octopair
