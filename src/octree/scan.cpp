#include "octree/scan.hpp"

#include <algorithm>
#include <array>
#include <initializer_list>
#include <vector>

#include "base/stop.hpp"
#include "octree/recursive_sweep.hpp"

namespace octopair {

namespace {

constexpr std::size_t large_node = 1 << 15;     // entries: shared out among threads on its own
constexpr std::size_t share_entries = 1 << 13;  // entries of a share at most, so that stops are seen soon
constexpr std::size_t shares_per_thread = 64;
constexpr std::size_t hot_node = 4096;      // entries: swept at once where the first axis does
constexpr std::uint64_t good_window = 192;  // tests a box
constexpr double worth_splitting = 0.75;    // of the entries may be left in the largest octant of an own octree

using Handed = std::vector<Entry>;

/// The boxes handed down to the nodes on one path, level by level; each with its class bits in that node.
class HandedDown {
public:
    explicit HandedDown(const LinearOctree& octree) : octree_(octree) {}

    /// Those that touch `node`, kept by the octants above. Nodes must come in pre-order, from any first one.
    const Handed& at(NodeIndex node) {
        const unsigned level = octree_.nodes()[node].level;
        if (lists_.size() <= level) {
            lists_.resize(level + 1);
            owners_.resize(level + 1, none);
        }
        if (owners_[level] == node) return lists_[level];
        if (level == 0) {
            lists_[0].clear();
        } else {
            const NodeIndex parent = octree_.nodes()[node].parent;
            (void)at(parent);
            lists_[level].clear();
            hand(lists_[level - 1], node);
            hand(octree_.entries(parent), node);
        }
        owners_[level] = node;
        return lists_[level];
    }

private:
    static constexpr NodeIndex none = ~NodeIndex(0);

    void hand(std::span<const Entry> from, NodeIndex to) {
        std::array<CellBox, 64> cells;
        while (!from.empty()) {
            const auto some = from.first(std::min(from.size(), cells.size()));
            octree_.frame().cells(some, cells);
            for (std::size_t i = 0; i < some.size(); ++i) hand(some[i], cells[i], to);
            from = from.subspan(some.size());
        }
    }

    void hand(const Entry& entry, const CellBox& box, NodeIndex to) {
        const Node& node = octree_.nodes()[to];
        if (!node.touches(box)) return;
        // Bits are added, never taken back: see entry.hpp.
        Entry& handed = lists_[node.level].emplace_back(entry);
        for (unsigned axis = 0; axis < 3; ++axis) handed.mask |= std::uint32_t(box.lo[axis] < node.lo[axis]) << axis;
    }

    const LinearOctree& octree_;
    std::vector<Handed> lists_;
    std::vector<NodeIndex> owners_;
};

/// The entries of a join as those of a scene: rows, then columns.
class EntriesOf final : public EntrySource {
public:
    explicit EntriesOf(const Join& join) : join_(join) {}
    std::size_t size() const override { return join_.rows.size() + (join_.self ? 0 : join_.columns.size()); }
    bool load(std::size_t begin, std::span<Entry> out) const override {
        for (std::size_t i = 0; i < out.size(); ++i) out[i] = at(begin + i);
        return true;
    }
    void pick(std::span<const std::size_t> positions, std::span<Entry> out) const override {
        for (std::size_t i = 0; i < out.size(); ++i) out[i] = at(positions[i]);
    }

private:
    const Entry& at(std::size_t i) const {
        return i < join_.rows.size() ? join_.rows[i] : join_.columns[i - join_.rows.size()];
    }

    const Join& join_;
};

/// Scans single nodes, keeping its memory from node to node. One thread at a time.
class NodeScan {
public:
    NodeScan(const ScanContext& context, Executor& executor)
        : context_(context), executor_(executor), order_(context.stop) {}

    /// Pairs of the octant's own entries, and of these with what was handed down.
    void scan(std::span<const Entry> own, std::span<const Entry> handed, unsigned axis) {
        const EntryList own_list{own}, handed_list{handed};
        const bool laid_out = lay_out(own_list, axis, own_set_);
        if (own.size() > 1 && !(laid_out && swept({{own_set_, own_set_, SweepKind::self}}))) {
            crowded({own_list, own_list, true, {}});
        }
        if (!handed.empty() && !(laid_out && lay_out(handed_list, axis, handed_set_) && swept_between())) {
            crowded({handed_list, own_list, false, {}});
        }
    }

    /// The same for pairs between the sets of a join: the sets are never swept against themselves.
    void scan_join(std::span<const Entry> own, std::span<const Entry> handed, unsigned axis) {
        const EntryList own_first = of_set(own, first_set, positions_[0]);
        const EntryList own_second = of_set(own, second_set, positions_[1]);
        join(own_first, own_second, axis);
        join(of_set(handed, first_set, positions_[2]), own_second, axis);
        join(of_set(handed, second_set, positions_[3]), own_first, axis);
    }

private:
    static EntryList of_set(std::span<const Entry> entries, std::uint32_t set, std::vector<std::uint32_t>& positions) {
        positions.clear();
        for (std::uint32_t i = 0; i < entries.size(); ++i) {
            if (entries[i].mask & set) positions.push_back(i);
        }
        return {entries, positions, false};
    }

    void join(const EntryList& rows, const EntryList& columns, unsigned axis) {
        if (rows.size() == 0 || columns.size() == 0) return;
        if (lay_out(rows, axis, handed_set_) && lay_out(columns, axis, own_set_) && swept_between()) return;
        crowded({rows, columns, false, {}});
    }

    bool lay_out(const EntryList& list, unsigned axis, SweepSet& set) {
        if (list.size() > hot_node) return false;
        order_.lay_out(list, axis, set);
        return true;
    }

    bool swept_between() {
        return swept({{handed_set_, own_set_, SweepKind::cross}, {own_set_, handed_set_, SweepKind::cross_strict}});
    }

    /// Sweeps if that tests few boxes for each.
    bool swept(std::initializer_list<Sweep> sweeps) {
        std::uint64_t tests = 0;
        std::size_t rows = 0;
        for (const Sweep& sweep : sweeps) {
            tests += sampled_windows(sweep);
            rows += sweep.rows.size();
        }
        if (tests > good_window * rows) return false;
        executor_.for_each_writing(1, [&](std::size_t, PairWriter& writer) {
            PairMaker maker(context_, writer);
            for (const Sweep& sweep : sweeps) maker.sweep(sweep, {});
            maker.flush();
        });
        return true;
    }

    /// A join too costly for the quick way. Parts of one shape are joined on their own: boxes as long as the octant
    /// keep any sweep and any split from thinning the others.
    void crowded(const Join& join) {
        if (swept(join)) return;
        const auto rows = part_by_shape(join.rows);
        throw_if_stopped(context_.stop);
        const auto columns = join.self ? decltype(rows){} : part_by_shape(join.columns);
        for (unsigned i = 0; i < rows.size(); ++i) {
            const EntryList row_list{join.rows.entries, rows[i], false};
            if (join.self) crowded_part({row_list, row_list, true, {}}, true);
            for (unsigned k = join.self ? i + 1 : 0; k < rows.size(); ++k) {
                const EntryList column_list{join.columns.entries, join.self ? rows[k] : columns[k], false};
                crowded_part({row_list, column_list, false, {}}, i == k);
            }
        }
    }

    void crowded_part(const Join& join, bool same_shape) {
        if (join.rows.size() == 0 || join.columns.size() == 0 || swept(join)) return;
        // An octree tells apart the two sets of the caller's join, but not others.
        const bool separable = join.self || context_.rule.join();
        if (same_shape && separable && split_afresh(join)) return;
        recursive_sweep(context_, join, executor_);
    }

    bool swept(const Join& join) {
        const SweepChoice choice = choose_sweep(join, order_, context_.stop);
        if (choice.good) tiled_sweep(context_, join, choice.axis, executor_);
        return choice.good;
    }

    /// Scans a linear octree of the join's own entries; false, with nothing done, where it would not thin them.
    bool split_afresh(const Join& join) {
        const EntriesOf entries(join);
        LinearOctree octree;
        octree.build(entries, executor_, context_.stop);
        std::size_t largest = 0;
        for (NodeIndex node = 0; node < octree.nodes().size(); ++node) {
            largest = std::max(largest, octree.entries(node).size());
        }
        if (double(largest) > worth_splitting * double(entries.size())) return false;
        octopair::scan(octree, context_, executor_, {});
        return true;
    }

    const ScanContext& context_;
    Executor& executor_;
    SweepOrder order_;
    SweepSet own_set_;
    SweepSet handed_set_;
    std::array<std::vector<std::uint32_t>, 4> positions_;  // of a node's entries of each set
};

/// Runs of nodes in pre-order that make up one share each; a large node is a share alone.
struct Share {
    NodeIndex begin = 0, end = 0;
    bool large = false;
};

std::vector<Share> shares_of(const OctreeRange& octants, unsigned width) {
    const LinearOctree& octree = octants.octree;
    const std::uint64_t even =
        octree.entry_count(octants.begin, octants.end) / (std::uint64_t(width) * shares_per_thread) + 1;
    const std::uint64_t most = std::min<std::uint64_t>(even, share_entries);
    std::vector<Share> shares;
    std::uint64_t held = 0;
    for (NodeIndex node = octants.begin; node < octants.end; ++node) {
        const std::size_t size = octree.entries(node).size();
        const bool large = size > large_node;
        if (shares.empty() || large || shares.back().large || held + size > most) {
            shares.push_back({node, node, large});
            held = 0;
        }
        shares.back().end = node + 1;
        held += size;
    }
    return shares;
}

}  // namespace

void scan(const OctreeRange& octants, const ScanContext& context, Executor& executor,
          const std::function<void(std::uint64_t)>& progress) {
    const LinearOctree& octree = octants.octree;
    const std::vector<Share> shares = shares_of(octants, executor.width());
    const auto scan_share = [&](const Share& share, Executor& within) {
        HandedDown handed(octree);
        NodeScan nodes(context, within);
        for (NodeIndex node = share.begin; node < share.end; ++node) {
            const Handed& above = handed.at(node);
            const auto own = octree.entries(node);
            if (own.empty()) continue;
            const unsigned axis = octree.frame().long_axis();
            context.rule.join() ? nodes.scan_join(own, above, axis) : nodes.scan(own, above, axis);
        }
        throw_if_stopped(context.stop);
        if (progress) progress(octree.entry_count(share.begin, share.end));
    };
    for (std::size_t i = 0; i < shares.size();) {
        if (shares[i].large) {
            scan_share(shares[i++], executor);
            continue;
        }
        std::size_t end = i;
        while (end < shares.size() && !shares[end].large) ++end;
        executor.for_each_writing(end - i, [&](std::size_t k, PairWriter& writer) {
            SerialExecutor serial(writer);
            scan_share(shares[i + k], serial);
        });
        i = end;
    }
}

}  // namespace octopair
