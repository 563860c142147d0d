// Half traversal of an LBVH: each leaf visits only later leaves in pre-order, so the traversal finds each pair once.
#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "baselines/baselines.hpp"
#include "baselines/lbvh_tree.hpp"
#include "baselines/overlap.hpp"

namespace octopair::baselines {

namespace {

void find_after(std::span<const LbvhNode> nodes, const LbvhNode& leaf, std::vector<Pair>& pairs) {
    const Box3f box = leaf.box;
    for (std::uint32_t i = leaf.escape; i < nodes.size();) {
        const LbvhNode& node = nodes[i];
        if (!overlap(node.box, box)) {
            i = node.escape;
            continue;
        }
        if (node.object != LbvhNode::no_object) pairs.push_back(ordered(leaf.object, node.object));
        ++i;
    }
}

std::vector<Pair> find_all(std::span<const LbvhNode> nodes) {
    tbb::enumerable_thread_specific<std::vector<Pair>> found;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, nodes.size(), 1024), [&](const auto& range) {
        std::vector<Pair>& pairs = found.local();
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
            if (nodes[i].object != LbvhNode::no_object) find_after(nodes, nodes[i], pairs);
        }
    });
    std::vector<Pair> all;
    for (std::vector<Pair>& pairs : found) {
        if (all.empty()) {
            all = std::move(pairs);
        } else {
            all.insert(all.end(), pairs.begin(), pairs.end());
        }
    }
    return all;
}

}  // namespace

std::vector<Pair> lbvh_pairs(std::span<const Box3f> boxes, unsigned threads) {
    // By default oneTBB limits the threads of an arena to the number of cores.
    const tbb::global_control leave(tbb::global_control::max_allowed_parallelism, threads);
    tbb::task_arena arena(int(threads), 1);
    return arena.execute([&] { return find_all(build_lbvh(boxes)); });
}

}  // namespace octopair::baselines
