#include "engine/mpi/partition/shared_top.hpp"

#include <bit>
#include <utility>

#include "base/test_hooks.hpp"
#include "engine/mpi/comm/agreement.hpp"

namespace octopair {

/// The division of octants, level by level.
class SharedTop::Growth {
public:
    /// Borrows all arguments.
    Growth(Communicator& comm, const SplitRule& rule, std::uint64_t most, std::span<const CellBox> own)
        : comm_(comm), rule_(rule), most_(most), own_(own) {
        octants_.push_back({OctantCube{}});
        std::vector<Touched> boxes(own.size());
        for (std::uint32_t i = 0; i < own.size(); ++i) boxes[i] = {0, i, false};
        for (std::size_t level = 0; level < octants_.size();) {
            const std::size_t end = octants_.size();
            divide(level, boxes);
            level = end;
        }
    }

    /// Stores the result in `top`, in pre-order.
    void finish(SharedTop& top) {
        append(0, top);
        top.boxes_.reserve(boxes_left_.size());
        for (const Touched& box : boxes_left_) top.boxes_.push_back({octants_[box.octant].number, box.box, box.kept});
    }

private:
    enum class State : std::uint8_t { left, whole, divided };
    struct Octant {
        OctantCube octant;
        State state = State::left;
        std::uint32_t below = 0;  // number of the first of its eight children, by level
        OctantIndex number = 0;   // in pre-order
    };
    /// A box of the sample and an octant that it touches.
    struct Touched {
        std::uint32_t octant;  // number by level
        std::uint32_t box;
        bool kept;
    };

    /// Divides the octants from `first` on. `boxes`: the boxes in these octants; replaced by those in their children.
    void divide(std::size_t first, std::vector<Touched>& boxes) {
        constexpr std::size_t each = 5;  // counts of an octant
        std::vector<std::uint32_t> sums;
        Agreement(comm_).together([&] {
            sums.resize(each * (octants_.size() - first), 0);
            for (Touched& box : boxes) count(box, std::span(sums).subspan(each * (box.octant - first), each));
        });
        comm_.add_up(std::span(sums));
        Agreement(comm_).together([&] {
            const std::size_t end = octants_.size();
            for (std::size_t i = first; i < end; ++i) {
                const std::uint32_t* sum = &sums[each * (i - first)];
                decide(i, {.inside = sum[0],
                           .kept = sum[1],
                           .beginning = sum[2],
                           .inside_below = sum[3],
                           .kept_below = sum[4]});
            }
            hand_down(boxes);
        });
    }

    void count(Touched& box, std::span<std::uint32_t> sum) const {
        const OctantCube& octant = octants_[box.octant].octant;
        const CellBox& cells = own_[box.box];
        box.kept |= octant.keeps(cells);
        const auto below = octant.level < deepest ? std::uint32_t(std::popcount(octant.touched_below(cells))) : 0;
        ++sum[box.kept ? 1 : 0];
        sum[2] += !box.kept && octant.holds_begin(cells) ? 1 : 0;
        sum[box.kept ? 4 : 3] += below;
    }

    void decide(std::size_t i, const OctantCounts& counts) {
        const OctantCube octant = octants_[i].octant;
        const bool small = counts.inside + counts.kept <= most_;
        if (octant.level >= deepest || small || !rule_.is_crowd(counts.inside)) return;
        const bool divided = SplitRule::worth_splitting(counts);
        if (divided) count_path(Path::ranks_top_divided);
        octants_[i].state = divided ? State::divided : State::whole;
        octants_[i].below = std::uint32_t(octants_.size());
        for (unsigned digit = 0; divided && digit < 8; ++digit) octants_.push_back({octant.child(digit)});
    }

    void hand_down(std::vector<Touched>& boxes) {
        std::vector<Touched> next;
        for (const Touched& box : boxes) {
            const Octant& octant = octants_[box.octant];
            if (octant.state == State::left) boxes_left_.push_back(box);
            if (octant.state != State::divided) continue;
            unsigned touched = octant.octant.touched_below(own_[box.box]);
            for (; touched != 0; touched &= touched - 1)
                next.push_back({octant.below + std::uint32_t(std::countr_zero(touched)), box.box, box.kept});
        }
        boxes = std::move(next);
    }

    /// Appends octant `i` and its descendants to `top`.
    void append(std::size_t i, SharedTop& top) {
        Octant& octant = octants_[i];
        octant.number = OctantIndex(top.octants_.size());
        const bool divided = octant.state == State::divided;
        top.octants_.push_back({octant.octant, octant.state == State::left});
        top.shape_.push_back(divided ? 1 : 0);
        for (std::size_t digit = 0; divided && digit < 8; ++digit) append(octant.below + digit, top);
    }

    Communicator& comm_;
    const SplitRule& rule_;
    std::uint64_t most_;
    std::span<const CellBox> own_;
    std::vector<Octant> octants_;  // level by level
    std::vector<Touched> boxes_left_;
};

SharedTop::SharedTop(Communicator& comm, const SplitRule& growth, std::uint64_t most, std::span<const CellBox> own) {
    Growth octants(comm, growth, most, own);
    Agreement(comm).together([&] { octants.finish(*this); });
}

}  // namespace octopair
