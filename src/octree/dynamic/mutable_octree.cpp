#include "octree/dynamic/mutable_octree.hpp"

#include <hwy/cache_control.h>

#include <algorithm>
#include <utility>

#include "base/stop.hpp"
#include "base/test_hooks.hpp"
#include "base/tuning.hpp"
#include "octree/build/octants_of.hpp"
#include "octree/linear_octree.hpp"

namespace octopair {

namespace {

// How many visits before its turn what a visit reads is fetched.
constexpr std::size_t ahead_head = 24, ahead_first = 14, ahead_next = 6;

/// Whether two boxes, or what lies between them, are no larger than the two together on each axis.
bool near(const CellBox& a, const CellBox& b) {
    bool is_near = true;
    for (unsigned axis = 0; axis < 3; ++axis) is_near &= a.lo[axis] <= b.hi[axis] + 1 && b.lo[axis] <= a.hi[axis] + 1;
    return is_near;
}

CellBox joined(const CellBox& a, const CellBox& b) {
    CellBox both;
    for (unsigned axis = 0; axis < 3; ++axis) {
        both.lo[axis] = std::min(a.lo[axis], b.lo[axis]);
        both.hi[axis] = std::max(a.hi[axis], b.hi[axis]);
    }
    return both;
}

}  // namespace

/// The units within a node that keep entries of a box.
template <typename Visit>
void MutableOctree::for_each_unit_of(NodeIndex node, const CellBox& box, Visit&& visit) const {
    const Plot& plot = plots_[node];
    const GridRange range = plot.range_of(box);
    if (!plot.keeps_in(range)) {
        count_path(plot.inner ? Path::unit_of_inner : Path::unit_of_leaf);
        return visit(plot.own_unit(), node);
    }
    count_path(Path::unit_in_cell);
    plot.for_each_cell(range, [&](const Unit& unit, const auto&) { visit(unit, node); });
}

/// Calls visit(unit, its node).
template <typename Visit>
void MutableOctree::for_each_home_unit(const CellBox& box, Visit&& visit) const {
    const Directory::Leaf home = directory_.leaf(box.lo);
    if (within(box, home.level())) return for_each_unit_of(home.node(), box, visit);
    for_each_octant_of(box, directory_, home, [&](NodeIndex node, unsigned) { for_each_unit_of(node, box, visit); });
}

template <typename Visit>
void MutableOctree::for_each_node_below(NodeIndex node, const CellBox& box, Visit&& visit) const {
    visit(node);
    if (!plots_[node].inner) return;
    for (unsigned digit = 0; digit < 8; ++digit) {
        const NodeIndex child = directory_.child(directory_.nodes()[node], digit);
        if (plots_[child].touches(box)) for_each_node_below(child, box, visit);
    }
}

/// All leaves that a box touches, and all inner nodes that may hold entries that touch it or keep it.
template <typename Visit>
void MutableOctree::for_each_touched_node(const CellBox& box, Visit&& visit) const {
    const auto nodes = directory_.nodes();
    const Directory::Leaf home = directory_.leaf(box.lo);
    if (within(box, home.level())) {
        visit(home.node());
        if (!inner_used_) return;
        for (NodeIndex node = home.node(); node != 0;) {
            node = nodes[node].parent;
            visit(node);
        }
        return;
    }
    std::array<NodeIndex, 8> tops;
    std::size_t count = 0;
    for_each_octant_of(box, directory_, home, [&](NodeIndex node, unsigned) { tops[count++] = node; });
    for (std::size_t i = 0; i < count; ++i) {
        for_each_node_below(tops[i], box, visit);
        if (!inner_used_) continue;
        // Those above, up to where one of the others has come.
        for (NodeIndex node = tops[i]; node != 0;) {
            node = nodes[node].parent;
            const auto above = [&](NodeIndex top) { return node < top && top < nodes[node].next; };
            if (std::any_of(tops.begin(), tops.begin() + std::ptrdiff_t(i), above)) break;
            visit(node);
        }
    }
}

void MutableOctree::build(const LinearOctree& octree, const std::stop_token& stop) {
    clear();
    frame_ = octree.frame();
    directory_ = octree.directory();
    const auto nodes = directory_.nodes();
    plots_.reserve(nodes.size());
    // What is reserved is not there before it is used, but what grows is there twice for a while: so a part shows how
    // much all will take, with what later changes may.
    const std::uint64_t part = octree.entry_count() / 32;
    units_.reserve(part);
    std::uint64_t done = 0;
    std::vector<CellBox> boxes;
    for (NodeIndex node = 0; node < nodes.size(); ++node) {
        if (stop.stop_requested()) clear();
        throw_if_stopped(stop);
        const auto entries = octree.entries(node);
        boxes.resize(entries.size());
        frame_.cells(entries, boxes);
        const Plot& plot = plots_.emplace_back(Plot::cut(nodes[node], units_.units(), boxes));
        units_.add_units(plot.units());
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            for_each_unit_of(node, boxes[i], [&](const Unit& unit, NodeIndex) {
                units_.reserve(1);
                units_.put(unit.index, unit.small(boxes[i]), entries[i].object);
            });
        }
        if (!units_.empty(plot.begin)) use({&node, 1});
        if (done < part && done + entries.size() >= part) units_.reserve(units_.blocks() * 64);
        done += entries.size();
    }
}

void MutableOctree::clear() {
    directory_ = {};
    plots_.clear();
    units_.clear();
    inner_used_ = false;
}

void MutableOctree::release() {
    clear();
    plots_ = {};
    units_.release();
}

void MutableOctree::insert(std::uint32_t object, const CellBox& box) {
    for_each_home_unit(box, [&](const Unit& unit, NodeIndex node) {
        if (unit.index == plots_[node].begin) use({&node, 1});
        units_.reserve(1);
        units_.put(unit.index, unit.small(box), object);
    });
}

void MutableOctree::erase(std::uint32_t object, const CellBox& box) {
    for_each_home_unit(box, [&](const Unit& unit, NodeIndex) { units_.take(unit.index, object); });
}

void MutableOctree::prefetch(const OctreeChange& change) const {
    if (!plots_.empty()) hwy::Prefetch(&plots_[directory_.leaf(change.after.lo).node()]);
}

void MutableOctree::use(std::span<const NodeIndex> nodes) {
    for (const NodeIndex node : nodes) {
        plots_[node].used = true;
        inner_used_ |= plots_[node].inner;
    }
}

void MutableOctree::search(const CellBox& box, std::vector<std::uint32_t>& found) const {
    if (plots_.empty()) return;
    const auto search_one = [&](const Unit& unit) {
        units_.search(unit.index, unit.small(box), [&](std::uint32_t object) { found.push_back(object); });
    };
    for_each_touched_node(box, [&](NodeIndex node) {
        const Plot& plot = plots_[node];
        if (plot.used) search_one(plot.own_unit());
        if (plot.inner) return;
        plot.for_each_cell(plot.range_of(box), [&](const Unit& unit, const auto&) { search_one(unit); });
    });
}

void MutableOctree::search(Probe& probe) const {
    if (!plots_.empty()) probe_node(0, probe);
}

void MutableOctree::probe_node(NodeIndex node, Probe& probe) const {
    const Plot& plot = plots_[node];
    if (plot.used) probe_unit(plot.own_unit(), probe);
    if (!plot.inner) return probe_cells(plot, plot.all(), probe);
    std::array<std::pair<double, NodeIndex>, 8> children;
    for (unsigned digit = 0; digit < 8; ++digit) {
        const NodeIndex child = directory_.child(directory_.nodes()[node], digit);
        children[digit] = {probe.at_least(frame_.bounds(plots_[child].cells())), child};
    }
    std::sort(children.begin(), children.end());
    for (const auto& [at_least, child] : children) {
        if (at_least <= probe.limit()) probe_node(child, probe);
    }
}

/// Halves the range until it is a cell.
void MutableOctree::probe_cells(const Plot& leaf, const GridRange& range, Probe& probe) const {
    unsigned axis = 0;
    for (unsigned other = 1; other < 3; ++other) {
        if (range.last[other] - range.first[other] > range.last[axis] - range.first[axis]) axis = other;
    }
    if (range.first[axis] == range.last[axis]) {
        leaf.for_each_cell(range, [&](const Unit& unit, const auto&) { probe_unit(unit, probe); });
        return;
    }
    GridRange low = range, high = range;
    low.last[axis] = range.first[axis] + (range.last[axis] - range.first[axis]) / 2;
    high.first[axis] = low.last[axis] + 1;
    double at_low = probe.at_least(frame_.bounds(leaf.cells(low)));
    double at_high = probe.at_least(frame_.bounds(leaf.cells(high)));
    if (at_high < at_low) {
        std::swap(at_low, at_high);
        std::swap(low, high);
    }
    if (at_low <= probe.limit()) probe_cells(leaf, low, probe);
    if (at_high <= probe.limit()) probe_cells(leaf, high, probe);
}

void MutableOctree::probe_unit(const Unit& unit, Probe& probe) const {
    units_.for_each(unit.index, [&](const SmallBox& box, std::uint32_t object) {
        if (probe.at_least(frame_.bounds(unit.cells(box))) <= probe.limit()) probe.take(object);
    });
}

/// A search around a box, with the entries that are taken and put there.
struct MutableOctree::Work {
    std::uint32_t number;
    std::uint32_t object;
    std::uint8_t around;
    CellBox wanted;
    const CellBox* take = nullptr;
    const CellBox* put = nullptr;

    static unsigned natural(const CellBox* box) { return box == nullptr ? 0 : natural_level(*box); }
    unsigned natural_take = natural(take), natural_put = natural(put);
};

void MutableOctree::list_node(NodeIndex node, const Work& work, Visits& out) const {
    const Plot& plot = plots_[node];
    // Where the entries are: in some cells, in the node itself, or in neither.
    struct Keepers {
        GridRange cells = GridRange::empty();
        bool own = false;
    };
    const auto keepers = [&](const CellBox* box, unsigned natural) {
        Keepers found;
        if (box == nullptr || !plot.keeps(*box, natural)) return found;
        const GridRange range = plot.range_of(*box);
        found.own = !plot.keeps_in(range);
        if (!found.own) found.cells = range;
        return found;
    };
    const Keepers taken = keepers(work.take, work.natural_take), put = keepers(work.put, work.natural_put);
    const auto add = [&](const Unit& unit, bool take_here, bool put_here) {
        UnitVisit& visit = out.visits.emplace_back();
        visit = {unit.index, work.number, work.object, work.around, take_here, put_here, unit.small(work.wanted), {}};
        if (put_here) visit.entry = unit.small(*work.put);
    };
    if (plot.used || taken.own || put.own) add(plot.own_unit(), taken.own, put.own);
    if (put.own && !plot.used) out.first_used.push_back(node);
    if (plot.inner) return;
    const GridRange range = plot.range_of(work.wanted);
    if (range.count() > tuning().dynamic.listed_visits) {
        out.visits.resize(out.visits.size() + tuning().dynamic.listed_visits + 1);  // which is too many
        return;
    }
    plot.for_each_cell(range, [&](const Unit& unit, const GridRange::Place& at) {
        add(unit, taken.cells.holds(at), put.cells.holds(at));
    });
}

bool MutableOctree::list(const Work& work, Visits& out) const {
    const std::size_t visits = out.visits.size(), first_used = out.first_used.size();
    const auto too_many = [&] { return out.visits.size() > visits + tuning().dynamic.listed_visits; };
    for_each_touched_node(work.wanted, [&](NodeIndex node) {
        if (!too_many()) list_node(node, work, out);
    });
    if (!too_many()) return true;
    out.visits.resize(visits);
    out.first_used.resize(first_used);
    return false;
}

bool MutableOctree::list(const OctreeChange& change, std::uint32_t number, Visits& out) const {
    const std::size_t visits = out.visits.size(), first_used = out.first_used.size();
    constexpr std::uint8_t both = around_before | around_after;
    const CellBox *const before = &change.before, *const after = &change.after;
    bool listed = true;
    if (change.existed && change.exists && near(*before, *after)) {
        count_path(Path::change_joined);
        listed = list({number, change.object, both, joined(*before, *after), before, after}, out);
    } else {
        if (change.existed) listed = list({number, change.object, around_before, *before, before, nullptr}, out);
        if (change.exists && listed) {
            listed = list({number, change.object, around_after, *after, nullptr, after}, out);
        }
    }
    count_path(listed ? Path::change_listed : Path::change_alone);
    if (listed) return true;
    out.visits.resize(visits);
    out.first_used.resize(first_used);
    // It is put where it belongs before the others are, whose searches must see it.
    if (!change.exists) return false;
    for_each_home_unit(*after, [&](const Unit& unit, NodeIndex node) {
        if (unit.index == plots_[node].begin && !plots_[node].used) out.first_used.push_back(node);
    });
    return false;
}

std::size_t MutableOctree::run(std::span<const UnitVisit> visits, std::span<const std::uint64_t> order,
                               std::vector<Hit>& hits) {
    const auto visit_at = [&](std::size_t i) -> const UnitVisit& { return visits[std::uint32_t(order[i])]; };
    const auto unit_at = [&](std::size_t i) { return std::uint32_t(order[i] >> 32); };
    std::size_t i = 0;
    for (; i < order.size() && hits.size() < tuning().dynamic.hits; ++i) {
        if (i + ahead_head < order.size()) {
            units_.prefetch_head(unit_at(i + ahead_head));
            hwy::Prefetch(&visit_at(i + ahead_head));
        }
        if (i + ahead_first < order.size()) units_.prefetch_first(unit_at(i + ahead_first));
        if (i + ahead_next < order.size()) units_.prefetch_next(unit_at(i + ahead_next));
        const UnitVisit& visit = visit_at(i);
        if (visit.around != 0) {
            units_.search(visit.unit, visit.wanted, [&](std::uint32_t object) {
                if (object != visit.object) hits.push_back({visit.change, object, visit.around});
            });
        }
        if (visit.take) units_.take(visit.unit, visit.object);
        if (visit.put) units_.put(visit.unit, visit.entry, visit.object);
    }
    if (i < order.size()) count_path(Path::run_stopped);
    return i;
}

}  // namespace octopair
