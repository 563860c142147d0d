// I-COLLIDE's sweep and prune (Cohen, Lin, Manocha, Ponamgi 1995; the paper's section 2.3.1).
//
// Three lists hold the ends of all intervals in order. A lower end stands before an upper end of equal value, because
// boxes are closed. Ends move little between frames, and insertion sort restores the order. Every swap of a lower end
// with an upper end of another object begins or ends an interval overlap.
//
// I-COLLIDE keeps a bit per axis for all n^2 / 2 pairs. Here, a swap that begins an overlap tests the other axes, so
// the state is only the set of pairs.
#include <algorithm>
#include <array>
#include <unordered_set>

#include "baselines/baselines.hpp"
#include "baselines/overlap.hpp"

namespace octopair::baselines {

namespace {

struct End {
    float value;
    bool upper;
    std::uint32_t object;
};

bool before(const End& a, const End& b) { return a.value != b.value ? a.value < b.value : a.upper < b.upper; }

std::uint64_t packed(Pair pair) { return std::uint64_t(pair.a) << 32 | pair.b; }
Pair unpacked(std::uint64_t key) { return {std::uint32_t(key >> 32), std::uint32_t(key)}; }

}  // namespace

struct ICollide::State {
    std::span<const Box3f> boxes;  // boxes of the current frame
    std::array<std::vector<End>, 3> ends;
    std::unordered_set<std::uint64_t> pairs;

    void start() {
        for (unsigned axis = 0; axis < 3; ++axis) {
            ends[axis].clear();
            for (std::uint32_t i = 0; i < boxes.size(); ++i) {
                ends[axis].push_back({boxes[i].min[axis], false, i});
                ends[axis].push_back({boxes[i].max[axis], true, i});
            }
            std::sort(ends[axis].begin(), ends[axis].end(), before);
        }
        pairs.clear();
        for (const Pair pair : sweep_and_prune(boxes)) pairs.insert(packed(pair));
    }

    void sort_again(unsigned axis) {
        std::vector<End>& list = ends[axis];
        for (End& end : list) end.value = end.upper ? boxes[end.object].max[axis] : boxes[end.object].min[axis];
        for (std::size_t i = 1; i < list.size(); ++i) {
            const End moving = list[i];
            std::size_t hole = i;
            for (; hole > 0 && before(moving, list[hole - 1]); --hole) {
                note_swap(moving, list[hole - 1]);
                list[hole] = list[hole - 1];
            }
            list[hole] = moving;
        }
    }

    /// Updates the pairs after `left` moves from behind `right` to before `right`.
    void note_swap(const End& left, const End& right) {
        if (left.upper == right.upper) return;
        const std::uint64_t key = packed(ordered(left.object, right.object));
        if (left.upper) {
            pairs.erase(key);
        } else if (overlap(boxes[left.object], boxes[right.object])) {
            pairs.insert(key);
        }
    }
};

ICollide::ICollide() : state_(std::make_unique<State>()) {}
ICollide::~ICollide() = default;

std::vector<Pair> ICollide::next_frame(std::span<const Box3f> boxes) {
    state_->boxes = boxes;
    if (state_->ends[0].size() != 2 * boxes.size()) {
        state_->start();
    } else {
        for (unsigned axis = 0; axis < 3; ++axis) state_->sort_again(axis);
    }
    state_->boxes = {};
    std::vector<Pair> pairs;
    pairs.reserve(state_->pairs.size());
    for (const std::uint64_t key : state_->pairs) pairs.push_back(unpacked(key));
    return pairs;
}

}  // namespace octopair::baselines
