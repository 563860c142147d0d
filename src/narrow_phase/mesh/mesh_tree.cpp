#include "narrow_phase/mesh/mesh_tree.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

#include "geometry/rounding.hpp"

namespace octopair {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

struct Bounds {
    Point3d min = {infinity, infinity, infinity};
    Point3d max = {-infinity, -infinity, -infinity};

    void add(const Point3d& point) {
        for (int axis = 0; axis < 3; ++axis) {
            min[axis] = std::min(min[axis], point[axis]);
            max[axis] = std::max(max[axis], point[axis]);
        }
    }
    void add(const Bounds& other) {
        for (int axis = 0; axis < 3; ++axis) {
            min[axis] = std::min(min[axis], other.min[axis]);
            max[axis] = std::max(max[axis], other.max[axis]);
        }
    }
    Point3d centre() const {
        Point3d c;
        for (int axis = 0; axis < 3; ++axis) c[axis] = min[axis] / 2 + max[axis] / 2;
        return c;
    }
};

void set_node_box(MeshNode& node, const Bounds& bounds, const Point3d& origin) {
    for (int axis = 0; axis < 3; ++axis) {
        const double low = bounds.min[axis] - origin[axis], high = bounds.max[axis] - origin[axis];
        node.centre[axis] = float(low / 2 + high / 2);
        if (!std::isfinite(node.centre[axis])) node.centre[axis] = 0;
        // All rounding errors so far are far below 2^-40 of the numbers that they come from.
        const double centre = double(node.centre[axis]);
        const double made_of = std::abs(low) + std::abs(high) + std::abs(origin[axis]) * 0x1p-8;
        const double half = std::max(high - centre, centre - low) + made_of * 0x1p-44;
        node.half[axis] = rounding::next_above(float(half));
    }
}

/// A box in float32 for the division of triangles. Lanes 0 to 2 are its minima, lanes 4 to 6 its negated maxima: compilers turn
/// the loops over 4 and 8 lanes into SIMD instructions. Lanes 3 and 7 have no meaning.
struct alignas(32) LaneBox {
    static constexpr float none = std::numeric_limits<float>::infinity();
    std::array<float, 8> lanes = {none, none, none, none, none, none, none, none};

    void add(const LaneBox& other) {
        for (int k = 0; k < 8; ++k) lanes[k] = other.lanes[k] < lanes[k] ? other.lanes[k] : lanes[k];
    }
    /// Returns the box of one point: the sum of minima and maxima, which is twice the centre.
    LaneBox doubled_centre() const {
        LaneBox point;
        for (int k = 0; k < 4; ++k) {
            point.lanes[k] = lanes[k] - lanes[k + 4];
            point.lanes[k + 4] = lanes[k + 4] - lanes[k];
        }
        return point;
    }
    float low(int axis) const { return lanes[axis]; }
    float extent(int axis) const { return -lanes[axis + 4] - lanes[axis]; }
    /// Returns half the surface area. The surface area heuristic takes the probability of a hit to be proportional to the area.
    float area() const {
        const float x = extent(0), y = extent(1), z = extent(2);
        return x < 0 ? 0 : x * y + y * z + z * x;
    }
};

/// A triangle during the construction of the tree. Its box only steers the division, so float32 is enough. The box is relative to
/// the mesh's bounds: the largest extent has length 1.
class Item {
public:
    Item(const std::array<std::array<float, 3>, 3>& corners, std::uint32_t number) {
        for (const auto& [x, y, z] : corners) box_.add({{x, y, z, 0, -x, -y, -z, 0}});
        const std::uint32_t low = number % halves, high = number / halves;  // both exact in float32
        box_.lanes[3] = float(low);
        box_.lanes[7] = float(high);
    }

    const LaneBox& box() const { return box_; }
    float doubled_centre(int axis) const { return box_.lanes[axis] - box_.lanes[axis + 4]; }
    std::uint32_t number() const { return std::uint32_t(box_.lanes[3]) + std::uint32_t(box_.lanes[7]) * halves; }

private:
    static constexpr std::uint32_t halves = 65536;

    LaneBox box_;
};

class Builder {
public:
    Builder(const shape::Mesh& mesh, MeshTree& tree) : mesh_(mesh), tree_(tree) {}

    void build() {
        tree_.vertices = mesh_.vertices;
        if (mesh_.triangles.empty()) return;
        make_items();
        tree_.nodes.reserve(items_.size());
        tree_.nodes.emplace_back();
        divide({0, 0, std::uint32_t(items_.size()), 0, centres_of(items_)});
        tree_.triangles.reserve(items_.size());
        tree_.numbers.reserve(items_.size());
        for (const Item& item : items_) {
            tree_.triangles.push_back(mesh_.triangles[item.number()]);
            tree_.numbers.push_back(item.number());
        }
        items_ = {};
        set_boxes();
    }

private:
    /// A node that is not divided yet.
    struct OpenNode {
        std::uint32_t node, begin, end, depth;
        LaneBox centres;  // box of the doubled centres of the items [begin, end)
    };

    void make_items() {
        Bounds all;
        for (const auto& corners : mesh_.triangles) {
            for (const std::uint32_t corner : corners) all.add(mesh_.vertices[corner]);
        }
        tree_.origin = all.centre();
        double extent = 0;
        for (int axis = 0; axis < 3; ++axis) extent = std::max(extent, all.max[axis] - all.min[axis]);
        const double inverse = 1 / extent, scale = std::isfinite(inverse) ? inverse : 0;
        items_.reserve(mesh_.triangles.size());
        for (const auto& triangle : mesh_.triangles) {
            std::array<std::array<float, 3>, 3> corners;
            for (int k = 0; k < 3; ++k) {
                const Point3d& vertex = mesh_.vertices[triangle[k]];
                for (int axis = 0; axis < 3; ++axis)
                    corners[k][axis] = float((vertex[axis] - tree_.origin[axis]) * scale);
            }
            items_.emplace_back(corners, std::uint32_t(items_.size()));
        }
    }

    static LaneBox centres_of(std::span<const Item> items) {
        LaneBox centres;
        for (const Item& item : items) centres.add(item.box().doubled_centre());
        return centres;
    }

    /// Uses an explicit stack instead of recursion, because the mesh determines the depth of its tree.
    void divide(const OpenNode& root) {
        std::vector<OpenNode> waiting = {root};
        while (!waiting.empty()) {
            const OpenNode open = waiting.back();
            waiting.pop_back();
            if (open.end - open.begin <= MeshTree::leaf_size) {
                tree_.nodes[open.node].first = open.begin;
                tree_.nodes[open.node].count = open.end - open.begin;
                continue;
            }
            OpenNode left{0, open.begin, 0, open.depth + 1, {}}, right{0, 0, open.end, open.depth + 1, {}};
            split(open, left, right);
            left.node = std::uint32_t(tree_.nodes.size());
            right.node = left.node + 1;
            tree_.nodes.resize(left.node + 2);
            tree_.nodes[open.node].first = left.node;
            tree_.nodes[open.node].count = 0;
            waiting.push_back(right);
            waiting.push_back(left);
        }
    }

    /// Partitions the items of a node. Sets the end of the left part, the begin of the right part, and the bounds of the centres of
    /// both. Neither part is empty.
    void split(const OpenNode& open, OpenNode& left, OpenNode& right) {
        const std::span items(items_.data() + open.begin, open.end - open.begin);
        int axis = 0;
        for (int other = 1; other < 3; ++other) {
            if (open.centres.extent(other) > open.centres.extent(axis)) axis = other;
        }
        const float low = open.centres.low(axis), scale = bins / open.centres.extent(axis);
        std::size_t middle = 0;
        // Bins are not used near max_depth, or if all centres are equal. The items are then halved by count, which bounds the depth.
        if (open.depth + std::bit_width(items.size()) < MeshTree::max_depth && std::isfinite(scale)) {
            const auto bin_of = [&](const Item& item) {
                return std::min(int((item.doubled_centre(axis) - low) * scale), bins - 1);
            };
            const int cut = best_cut(items, bin_of);
            const auto is_left = [&](const Item& item) { return bin_of(item) < cut; };
            middle = std::size_t(std::partition(items.begin(), items.end(), is_left) - items.begin());
        }
        if (middle == 0 || middle == items.size()) middle = halve(items, axis);
        left.centres = centres_of(items.first(middle));
        right.centres = centres_of(items.subspan(middle));
        left.end = right.begin = open.begin + std::uint32_t(middle);
    }

    static std::size_t halve(std::span<Item> items, int axis) {
        const std::size_t half = items.size() / 2;
        std::nth_element(items.begin(), items.begin() + std::ptrdiff_t(half), items.end(),
                         [axis](const Item& a, const Item& b) {
                             const float at_a = a.doubled_centre(axis), at_b = b.doubled_centre(axis);
                             return at_a != at_b ? at_a < at_b : a.number() < b.number();
                         });
        return half;
    }

    static constexpr int bins = 16;

    /// Returns the first bin of the right side, for the smallest sum of area times count of both sides.
    template <typename BinOf>
    static int best_cut(std::span<const Item> items, const BinOf& bin_of) {
        std::array<LaneBox, bins> boxes;
        std::array<std::size_t, bins> counts = {};
        for (const Item& item : items) {
            const int bin = bin_of(item);
            boxes[bin].add(item.box());
            ++counts[bin];
        }
        std::array<float, bins> cost_right = {};
        LaneBox right;
        std::size_t count = 0;
        for (int cut = bins - 1; cut > 0; --cut) {
            right.add(boxes[cut]);
            count += counts[cut];
            cost_right[cut] = right.area() * float(count);
        }
        LaneBox left;
        count = 0;
        int best = bins / 2;
        float least = LaneBox::none;
        for (int cut = 1; cut < bins; ++cut) {
            left.add(boxes[cut - 1]);
            count += counts[cut - 1];
            const float cost = left.area() * float(count) + cost_right[cut];
            if (count == 0 || count == items.size() || !(cost < least)) continue;
            least = cost;
            best = cut;
        }
        return best;
    }

    /// Sets the boxes of all nodes, computed in float64 from the corners. Visits nodes from last to first, because children have
    /// greater numbers than their parents.
    void set_boxes() {
        std::vector<Bounds> bounds(tree_.nodes.size());
        for (std::size_t i = tree_.nodes.size(); i-- > 0;) {
            MeshNode& node = tree_.nodes[i];
            for (std::uint32_t k = 0; k < node.count; ++k) {
                for (const std::uint32_t corner : tree_.triangles[node.first + k])
                    bounds[i].add(tree_.vertices[corner]);
            }
            for (std::uint32_t child = node.first; !node.is_leaf() && child < node.first + 2; ++child)
                bounds[i].add(bounds[child]);
            set_node_box(node, bounds[i], tree_.origin);
        }
    }

    const shape::Mesh& mesh_;
    MeshTree& tree_;
    std::vector<Item> items_;
};

}  // namespace

std::shared_ptr<const MeshTree> make_mesh_tree(const shape::Mesh& mesh) {
    auto tree = std::make_shared<MeshTree>();
    Builder(mesh, *tree).build();
    tree->parts = find_parts(*tree);
    set_convex_solid(*tree);
    return tree;
}

MeshTree make_box_tree(const Box3d& box) {
    Bounds bounds;
    bounds.add(Point3d{box.min[0], box.min[1], box.min[2]});
    bounds.add(Point3d{box.max[0], box.max[1], box.max[2]});
    MeshTree tree;
    tree.origin = bounds.centre();
    tree.nodes = {{{}, 0, {}, 1}};
    set_node_box(tree.nodes[0], bounds, tree.origin);
    return tree;
}

}  // namespace octopair
