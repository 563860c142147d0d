#include "engine/mpi/partition/shared_top.hpp"

#include <algorithm>
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
        touched_.resize(own.size());
        for (std::uint32_t i = 0; i < own.size(); ++i) touched_[i] = {0, i};
        while (first_ < octants_.size()) {
            std::vector<std::uint32_t> sums;
            Agreement(comm_).together([&] { sums = count(); });
            comm_.add_up(std::span(sums));
            Agreement(comm_).together([&] { divide(sums); });
        }
    }

    /// Stores the result in `top`, in pre-order.
    void finish(SharedTop& top) {
        append(0, top);
        top.boxes_.reserve(left_.size());
        for (const Touched& box : left_) top.boxes_.push_back({octants_[box.octant].number, box.box, box.kept});
    }

private:
    static constexpr double fraction_unit = 1 << 10;  // fractions are summed as integers, in units of 1 / fraction_unit

    struct Octant {
        OctantCube octant;
        bool divided = false;
        std::uint32_t below = 0;  // index in octants_ of the first of its eight children
        OctantIndex number = 0;   // its number in the pre-order of `top`
        std::uint32_t boxes = 0;
        double shortest = 0, overlap = 0;
    };
    /// A box of the sample and an octant that it touches.
    struct Touched {
        std::uint32_t octant;  // index in octants_
        std::uint32_t box;
        bool kept = false;
        std::uint8_t below = 0;  // bit mask of the children that it touches
    };
    /// The quantities that are summed over the boxes of an octant, by their place in the array of sums.
    enum Sum : std::uint8_t {
        inside,
        kept,
        beginning,
        inside_below,
        kept_below,
        shortest,
        overlapped,
        sums_per_octant
    };

    /// Returns the sums for each octant from `first_` on. Only the boxes of this rank count.
    std::vector<std::uint32_t> count() {
        std::vector<std::uint32_t> sums(sums_per_octant * (octants_.size() - first_), 0);
        for (Touched& box : touched_) count(box, &sums[sums_per_octant * (box.octant - first_)]);
        return sums;
    }

    void count(Touched& box, std::uint32_t* sums) const {
        const OctantCube& octant = octants_[box.octant].octant;
        const CellBox& cells = own_[box.box];
        box.kept |= octant.keeps(cells);
        box.below = octant.level < deepest ? std::uint8_t(octant.touched_below(cells)) : std::uint8_t(0);
        ++sums[box.kept ? kept : inside];
        sums[box.kept ? kept_below : inside_below] += std::uint32_t(std::popcount(box.below));
        sums[beginning] += !box.kept && octant.holds_begin(cells) ? 1 : 0;
        const double side = double(cells_per_axis >> octant.level);
        double least = 1, part = 1;
        for (unsigned axis = 0; axis < 3; ++axis) {
            const double extent = double(cells.hi[axis] - cells.lo[axis]) / side;
            least = std::min(least, extent);
            // Fraction of the positions in the octant at which a second box of equal extent overlaps this box.
            part *= std::min(1.0, 2 * extent);
        }
        sums[shortest] += std::uint32_t(least * fraction_unit);
        sums[overlapped] += std::uint32_t(part * fraction_unit);
    }

    /// Decides by the sums over all ranks which octants from `first_` on are divided. Hands the boxes of these octants down to children.
    void divide(std::span<const std::uint32_t> sums) {
        const std::size_t end = octants_.size();
        for (std::size_t i = first_; i < end; ++i) decide(i, &sums[sums_per_octant * (i - first_)]);
        hand_down();
        first_ = end;
    }

    void decide(std::size_t i, const std::uint32_t* sums) {
        const OctantCube octant = octants_[i].octant;
        const std::uint64_t boxes = std::uint64_t(sums[inside]) + sums[kept];
        const double unit = fraction_unit * double(std::max<std::uint64_t>(1, boxes));
        octants_[i].shortest = double(sums[shortest]) / unit;
        octants_[i].overlap = double(sums[overlapped]) / unit;
        octants_[i].boxes = std::uint32_t(boxes);
        if (octant.level >= deepest || boxes <= most_ || !rule_.is_crowd(sums[inside])) return;
        const bool divided = SplitRule::worth_splitting({.inside = sums[inside],
                                                         .kept = sums[kept],
                                                         .beginning = sums[beginning],
                                                         .inside_below = sums[inside_below],
                                                         .kept_below = sums[kept_below]});
        if (!divided) return;
        count_path(Path::ranks_top_divided);
        octants_[i].divided = true;
        octants_[i].boxes = 0;
        octants_[i].below = std::uint32_t(octants_.size());
        for (unsigned digit = 0; digit < 8; ++digit) octants_.push_back({octant.child(digit)});
    }

    void hand_down() {
        std::vector<Touched> next;
        next.reserve(touched_.size() + touched_.size() / 2);
        for (const Touched& box : touched_) {
            const Octant& octant = octants_[box.octant];
            if (!octant.divided) left_.push_back(box);
            for (unsigned below = octant.divided ? box.below : 0; below != 0; below &= below - 1)
                next.push_back({octant.below + std::uint32_t(std::countr_zero(below)), box.box, box.kept});
        }
        touched_ = std::move(next);
    }

    /// Appends octant `i` and its descendants to `top`.
    void append(std::size_t i, SharedTop& top) {
        Octant& octant = octants_[i];
        octant.number = OctantIndex(top.octants_.size());
        top.octants_.push_back({octant.octant, !octant.divided, octant.boxes, octant.shortest, octant.overlap});
        top.shape_.push_back(octant.divided ? 1 : 0);
        for (std::size_t digit = 0; octant.divided && digit < 8; ++digit) append(octant.below + digit, top);
    }

    Communicator& comm_;
    const SplitRule& rule_;
    std::uint64_t most_;
    std::span<const CellBox> own_;
    std::vector<Octant> octants_;   // level by level
    std::size_t first_ = 0;         // first octant that is not yet decided
    std::vector<Touched> touched_;  // boxes in the octants from `first_` on
    std::vector<Touched> left_;     // boxes in left octants
};

SharedTop::SharedTop(Communicator& comm, const SplitRule& growth, std::uint64_t most, std::span<const CellBox> own) {
    Growth octants(comm, growth, most, own);
    Agreement(comm).together([&] { octants.finish(*this); });
}

}  // namespace octopair
