#include "verification/box_tree.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "base/stop.hpp"
#include "octopair/error.hpp"

namespace octopair {

namespace {

constexpr unsigned coordinates = 6;

template <typename Real>
Real coordinate(const Box<Real>& box, unsigned which) {
    return which < 3 ? box.min[which] : box.max[which - 3];
}

template <typename Real>
bool is_valid(const Box<Real>& box) {
    for (int axis = 0; axis < 3; ++axis) {
        if (!(box.min[axis] <= box.max[axis] && std::isfinite(box.min[axis]) && std::isfinite(box.max[axis]))) {
            return false;
        }
    }
    return true;
}

/// Throws: Error{engine_failed} unless `valid`. The check is needed because NaN coordinates would break the sorting of boxes.
void check_valid(bool valid, std::size_t object, const char* what) {
    if (valid) return;
    throw Error(ErrorCode::engine_failed, "verification failed: the " + std::string(what) + " of object " +
                                              std::to_string(object) + " is not valid, but the engine accepted it");
}

}  // namespace

/// Orders the boxes and fills in the nodes.
template <typename Real>
class BoxTree<Real>::Builder {
public:
    Builder(BoxTree& tree, const std::stop_token& stop) : tree_(tree), stop_(stop) {
        for (const Item& item : tree.items_) {
            for (int axis = 0; axis < 3; ++axis) {
                const double half = double(item.box.max[axis]) * 0.5 - double(item.box.min[axis]) * 0.5;
                extent_[axis] += half / double(tree.items_.size());
            }
        }
        for (double& extent : extent_) extent = std::max(extent, std::numeric_limits<double>::min());
    }

    /// Builds level by level while a level has too few nodes for all threads. Then each task builds a subtree.
    void build(Team& team) {
        std::vector<Place> level = {{0, 0, (tree_.items_.size() + leaf_boxes - 1) / leaf_boxes}};
        std::vector<Place> above;
        unsigned depth = 0;
        const std::size_t enough = team.threads() > 1 ? 8 * team.threads() : 1;
        // The first run of a level is its shortest.
        for (; level.size() < enough && level[0].leaves > 1; ++depth) {
            team.for_each(level.size(), [&](std::size_t i, unsigned) { halve(level[i], depth); });
            above.insert(above.end(), level.begin(), level.end());
            level = children_of(level);
        }
        team.for_each(level.size(), [&](std::size_t i, unsigned) { build_subtree(level[i], depth); });
        for (std::size_t i = above.size(); i-- > 0;) join_children(above[i]);
    }

private:
    /// Requires: each run has two leaves or more.
    std::vector<Place> children_of(const std::vector<Place>& level) const {
        std::vector<Place> children;
        for (const Place& place : level) {
            children.push_back(tree_.left_of(place));
            children.push_back(tree_.right_of(place));
        }
        return children;
    }

    /// Returns the coordinate that separates the boxes of a run best: the one with the largest interquartile range in a sample,
    /// in units of the mean extent of all boxes on its axis. Among equally good coordinates, the choice changes with `depth`.
    unsigned best_coordinate(const Place& place, unsigned depth) const {
        const std::size_t begin = tree_.begin_of(place), count = tree_.end_of(place) - begin;
        std::array<double, samples> sample;
        unsigned best = depth % coordinates;
        double most = 0;
        for (unsigned turn = 0; turn < coordinates; ++turn) {
            const unsigned which = (depth + turn) % coordinates;
            for (std::size_t i = 0; i < samples; ++i) {
                sample[i] = double(coordinate(tree_.items_[begin + i * count / samples].box, which));
            }
            std::sort(sample.begin(), sample.end());
            const double range = (sample[3 * samples / 4] * 0.5 - sample[samples / 4] * 0.5) / extent_[which % 3];
            if (!(range > most)) continue;
            most = range;
            best = which;
        }
        return best;
    }

    /// Partitions the boxes of a node: moves the boxes of its left child before the boxes of its right child.
    void halve(const Place& place, unsigned depth) {
        if (place.leaves < 2) return;
        const unsigned which = best_coordinate(place, depth);
        unsigned comparisons = 0;
        const auto less = [&](const Item& a, const Item& b) {
            if ((++comparisons & 0xfffff) == 0) throw_if_stopped(stop_);
            return coordinate(a.box, which) < coordinate(b.box, which);
        };
        throw_if_stopped(stop_);
        const auto items = tree_.items_.begin();
        std::nth_element(items + std::ptrdiff_t(tree_.begin_of(place)),
                         items + std::ptrdiff_t(tree_.begin_of(tree_.right_of(place))),
                         items + std::ptrdiff_t(tree_.end_of(place)), less);
    }

    void build_subtree(const Place& place, unsigned depth) {
        if (place.leaves < 2) return fill_leaf(place);
        halve(place, depth);
        build_subtree(tree_.left_of(place), depth + 1);
        build_subtree(tree_.right_of(place), depth + 1);
        join_children(place);
    }

    void fill_leaf(const Place& place) {
        const Item& first = tree_.items_[tree_.begin_of(place)];
        Node node{first.box, first.index, tree_.padding_of(first.index)};
        for (std::size_t i = tree_.begin_of(place) + 1; i < tree_.end_of(place); ++i) {
            const Item& item = tree_.items_[i];
            node = joined(node, {item.box, item.index, tree_.padding_of(item.index)});
        }
        tree_.nodes_[place.node] = node;
    }

    void join_children(const Place& place) {
        tree_.nodes_[place.node] =
            joined(tree_.nodes_[tree_.left_of(place).node], tree_.nodes_[tree_.right_of(place).node]);
    }

    static Node joined(const Node& a, const Node& b) {
        Node node{a.hull, std::max(a.largest, b.largest), std::max(a.padding, b.padding)};
        for (int axis = 0; axis < 3; ++axis) {
            node.hull.min[axis] = std::min(a.hull.min[axis], b.hull.min[axis]);
            node.hull.max[axis] = std::max(a.hull.max[axis], b.hull.max[axis]);
        }
        return node;
    }

    static constexpr std::size_t samples = 16;

    BoxTree& tree_;
    const std::stop_token& stop_;
    std::array<double, 3> extent_ = {};  // half the mean extent of all boxes, by axis
};

template <typename Real>
BoxTree<Real>::BoxTree(std::span<const Box<Real>> boxes, std::span<const double> padding, Team& team,
                       const std::stop_token& stop)
    : padding_(padding) {
    if (boxes.empty()) return;
    items_.resize(boxes.size());
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        items_[i] = {boxes[i], std::uint32_t(i)};  // copied first, because the caller's boxes may change meanwhile
        check_valid(is_valid(items_[i].box), i, "box");
        check_valid(padding_of(i) >= 0 && std::isfinite(padding_of(i)), i, "padding");
    }
    nodes_.resize(2 * ((boxes.size() + leaf_boxes - 1) / leaf_boxes) - 1);
    Builder(*this, stop).build(team);
}

template <typename Real>
std::size_t BoxTree<Real>::end_of(const Place& place) const {
    return std::min((place.first_leaf + place.leaves) * leaf_boxes, items_.size());
}

template <typename Real>
void BoxTree<Real>::find(const BoxQuery& query, std::vector<std::uint32_t>& found) const {
    if (nodes_.empty()) return;
    // On each level at most one place waits. A level has half the leaves of the level above, and the root has at most 2^28 leaves.
    std::array<Place, 64> waiting;
    std::size_t count = 0;
    waiting[count++] = {0, 0, (nodes_.size() + 1) / 2};
    while (count > 0) {
        const Place place = waiting[--count];
        const Node& node = nodes_[place.node];
        if (std::int64_t(node.largest) <= query.above || !is_within_reach(query, node.hull, node.padding)) continue;
        if (place.leaves == 1) {
            find_in_leaf(query, place, found);
        } else {
            waiting[count++] = right_of(place);
            waiting[count++] = left_of(place);
        }
    }
}

/// Stores each index, but advances the count only after a hit. So there is no branch on the test's outcome, which the processor could not
/// predict.
template <typename Real>
void BoxTree<Real>::find_in_leaf(const BoxQuery& query, const Place& leaf, std::vector<std::uint32_t>& found) const {
    std::array<std::uint32_t, leaf_boxes> hits;
    std::size_t count = 0;
    for (std::size_t i = begin_of(leaf); i < end_of(leaf); ++i) {
        const Item& item = items_[i];
        const bool wanted = std::int64_t(item.index) > query.above;
        hits[count] = item.index;
        count += std::size_t(wanted & is_within_reach(query, item.box, padding_of(item.index)));
    }
    found.insert(found.end(), hits.begin(), hits.begin() + std::ptrdiff_t(count));
}

template class BoxTree<float>;
template class BoxTree<double>;

}  // namespace octopair
