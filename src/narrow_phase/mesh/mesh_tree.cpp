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

struct TriangleBounds {
    Point3d min = {infinity, infinity, infinity};
    Point3d max = {-infinity, -infinity, -infinity};

    void add(const Point3d& point) {
        for (int axis = 0; axis < 3; ++axis) {
            min[axis] = std::min(min[axis], point[axis]);
            max[axis] = std::max(max[axis], point[axis]);
        }
    }
    void add(const TriangleBounds& other) {
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
    /// Half the surface area, to which the surface area heuristic takes the probability of a hit to be proportional.
    double area() const {
        const double x = max[0] - min[0], y = max[1] - min[1], z = max[2] - min[2];
        return x < 0 ? 0 : x * y + y * z + z * x;
    }
};

void set_node_box(MeshNode& node, const TriangleBounds& bounds, const Point3d& origin) {
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

/// A triangle during the construction of the tree.
struct Item {
    TriangleBounds bounds;
    Point3d centre;
    std::uint32_t number;
};

class Builder {
public:
    Builder(const shape::Mesh& mesh, MeshTree& tree) : mesh_(mesh), tree_(tree) {}

    void build() {
        tree_.vertices = mesh_.vertices;
        if (mesh_.triangles.empty()) return;
        TriangleBounds all;
        items_.reserve(mesh_.triangles.size());
        for (const auto& corners : mesh_.triangles) {
            Item item{{}, {}, std::uint32_t(items_.size())};
            for (const std::uint32_t corner : corners) item.bounds.add(mesh_.vertices[corner]);
            item.centre = item.bounds.centre();
            all.add(item.bounds);
            items_.push_back(item);
        }
        tree_.origin = all.centre();
        tree_.nodes.reserve(items_.size());
        tree_.nodes.emplace_back();
        divide({0, 0, std::uint32_t(items_.size()), 0});
        for (const Item& item : items_) {
            tree_.triangles.push_back(mesh_.triangles[item.number]);
            tree_.numbers.push_back(item.number);
        }
    }

private:
    struct Task {
        std::uint32_t node, begin, end, depth;
    };

    /// Uses an explicit stack instead of recursion, because the mesh determines the depth of its tree.
    void divide(const Task& root) {
        std::vector<Task> tasks = {root};
        while (!tasks.empty()) {
            const Task task = tasks.back();
            tasks.pop_back();
            set_box(task);
            if (task.end - task.begin <= MeshTree::leaf_size) {
                tree_.nodes[task.node].first = task.begin;
                tree_.nodes[task.node].count = task.end - task.begin;
                continue;
            }
            const std::uint32_t middle = split(task);
            const auto child = std::uint32_t(tree_.nodes.size());
            tree_.nodes.resize(child + 2);
            tree_.nodes[task.node].first = child;
            tree_.nodes[task.node].count = 0;
            tasks.push_back({child + 1, middle, task.end, task.depth + 1});
            tasks.push_back({child, task.begin, middle, task.depth + 1});
        }
    }

    void set_box(const Task& task) {
        TriangleBounds bounds;
        for (std::uint32_t i = task.begin; i < task.end; ++i) bounds.add(items_[i].bounds);
        set_node_box(tree_.nodes[task.node], bounds, tree_.origin);
    }

    /// Partitions the items of a node and returns the begin of the second part. Neither part is empty.
    std::uint32_t split(const Task& task) {
        const std::span items(items_.data() + task.begin, task.end - task.begin);
        TriangleBounds centres;
        for (const Item& item : items) centres.add(item.centre);
        int axis = 0;
        for (int other = 1; other < 3; ++other) {
            if (centres.max[other] - centres.min[other] > centres.max[axis] - centres.min[axis]) axis = other;
        }
        const double low = centres.min[axis], width = centres.max[axis] - low;
        // Beyond this depth, halving keeps the tree within max_depth. Equal centres, and extents that overflow, are halved too.
        if (task.depth + std::bit_width(items.size()) < MeshTree::max_depth && width > 0 && std::isfinite(width)) {
            const double scale = bins / width;
            const auto bin_of = [&](const Item& item) {
                return std::min(int((item.centre[axis] - low) * scale), bins - 1);
            };
            const int cut = best_cut(items, bin_of);
            const auto middle =
                std::partition(items.begin(), items.end(), [&](const Item& item) { return bin_of(item) < cut; });
            if (middle != items.begin() && middle != items.end()) {
                return task.begin + std::uint32_t(middle - items.begin());
            }
        }
        const auto half = items.begin() + std::ptrdiff_t(items.size() / 2);
        std::nth_element(items.begin(), half, items.end(), [axis](const Item& a, const Item& b) {
            return a.centre[axis] != b.centre[axis] ? a.centre[axis] < b.centre[axis] : a.number < b.number;
        });
        return task.begin + std::uint32_t(items.size() / 2);
    }

    static constexpr int bins = 16;

    /// Returns the first bin of the right side, for the smallest sum of area times count of both sides.
    template <typename BinOf>
    static int best_cut(std::span<const Item> items, const BinOf& bin_of) {
        std::array<TriangleBounds, bins> bounds;
        std::array<std::size_t, bins> counts = {};
        for (const Item& item : items) {
            bounds[bin_of(item)].add(item.bounds);
            ++counts[bin_of(item)];
        }
        std::array<double, bins> cost_right = {};
        TriangleBounds right;
        std::size_t count = 0;
        for (int cut = bins - 1; cut > 0; --cut) {
            right.add(bounds[cut]);
            count += counts[cut];
            cost_right[cut] = right.area() * double(count);
        }
        TriangleBounds left;
        count = 0;
        int best = bins / 2;
        double least = infinity;
        for (int cut = 1; cut < bins; ++cut) {
            left.add(bounds[cut - 1]);
            count += counts[cut - 1];
            const double cost = left.area() * double(count) + cost_right[cut];
            if (count == 0 || count == items.size() || !(cost < least)) continue;
            least = cost;
            best = cut;
        }
        return best;
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
    TriangleBounds bounds;
    bounds.add(Point3d{box.min[0], box.min[1], box.min[2]});
    bounds.add(Point3d{box.max[0], box.max[1], box.max[2]});
    MeshTree tree;
    tree.origin = bounds.centre();
    tree.nodes = {{{}, 0, {}, 1}};
    set_node_box(tree.nodes[0], bounds, tree.origin);
    return tree;
}

}  // namespace octopair
