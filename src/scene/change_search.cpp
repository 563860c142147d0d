#include "scene/change_search.hpp"

#include <algorithm>
#include <bit>
#include <functional>

#include "base/stop.hpp"
#include "base/tuning.hpp"
#include "boxes/entry_source.hpp"
#include "scene/scene_box_source.hpp"

namespace octopair {

namespace {

constexpr std::size_t listed_ahead = 8;   // changes prefetched before they are listed
constexpr std::size_t judged_ahead = 16;  // hits whose objects are prefetched before they are tested

bool are_pair(const ObjectState& a, const ObjectState& b, double margin) {
    return a.exists && b.exists && within_reach(a.box, b.box, margin + (a.padding + b.padding)) &&
           compatible(a.traits, b.traits);
}

std::uint32_t unit_of(std::uint64_t key) { return std::uint32_t(key >> 32); }

/// Returns the first position of the unit that `position` lies in. Shares begin there, so that no unit is in two shares.
std::size_t share_begin(std::span<const std::uint64_t> order, std::size_t position) {
    if (position >= order.size()) return order.size();
    while (position > 0 && unit_of(order[position]) == unit_of(order[position - 1])) --position;
    return position;
}

}  // namespace

Entry EntryRounding::entry(const Box3d& box, double padding) const {
    if (!exact) return rounding.entry(box, padding);
    Entry entry{};
    for (int axis = 0; axis < 3; ++axis) {
        entry.min[axis] = float(box.min[axis]);
        entry.max[axis] = float(box.max[axis]);
    }
    return entry;
}

void ChangeSearch::run(const View& scene, MutableOctree& octree, PairChanges& changes, const Limits& limits) {
    for (Worker& worker : workers_) {
        worker.began.clear();
        worker.ended.clear();
    }
    read_changes(scene, octree);
    list_visits(octree, limits);
    for (std::uint32_t number = 0; number < changes_.size(); ++number) {
        if (is_large_[number] == 0) continue;
        throw_if_beyond(limits, workers_[0]);
        apply_large_change(scene, octree, number);
    }
    apply_listed_changes(scene, octree, limits);
    collect(&Worker::began, changes.began);
    collect(&Worker::ended, changes.ended);
}

void ChangeSearch::throw_if_beyond(const Limits& limits, const Worker& worker) const {
    throw_if_stopped(limits.stop);
    const bool many = worker.began.size() + worker.ended.size() > limits.pairs / workers_.size();
    if (many || std::chrono::steady_clock::now() > limits.deadline) throw LimitReached{};
}

void ChangeSearch::read_changes(const View& scene, const MutableOctree& octree) {
    const auto formers = scene.log.previous_states();
    changes_.clear();
    entries_.clear();
    for (std::size_t i = 0; i < formers.size(); ++i) {
        if (i + judged_ahead < formers.size()) scene.table.prefetch(formers[i + judged_ahead].index);
        const PreviousState& former = formers[i];
        const ObjectState now = scene.table.state(former.index);
        changes_.push_back({former.index, former.state.exists, now.exists, {}, {}});
        // The box is valid but not used if the object did not exist at the last step, or no longer exists.
        entries_.push_back(scene.rounding.entry(former.state.box, now.padding));
        entries_.push_back(scene.rounding.entry(now.box, now.padding));
    }
    cells_.resize(entries_.size());
    octree.space().cells(entries_, cells_);
    for (std::size_t i = 0; i < changes_.size(); ++i) {
        changes_[i].before = cells_[2 * i];
        changes_[i].after = cells_[2 * i + 1];
    }
}

/// Lists the visits of all changes: one list for each thread, with an equal number of changes, in the order of the log.
void ChangeSearch::list_visits(MutableOctree& octree, const Limits& limits) {
    listed_.resize(team_.threads());
    is_large_.assign(changes_.size(), 0);
    const std::size_t part = (changes_.size() + listed_.size() - 1) / listed_.size();
    const auto list_part = [&](std::size_t i, unsigned) {
        listed_[i].clear();
        const std::size_t end = std::min((i + 1) * part, changes_.size());
        for (std::size_t k = i * part; k < end; ++k) {
            throw_if_stopped(limits.stop);
            if (listed_[i].visits.size() > limits.visits / listed_.size()) throw LimitReached{};
            if (k + listed_ahead < end) octree.prefetch(changes_[k + listed_ahead]);
            if (!octree.list(changes_[k], std::uint32_t(k), listed_[i])) is_large_[k] = 1;
        }
    };
    for (bool again = true; again;) {
        team_.for_each(listed_.size(), std::ref(list_part));  // by reference, so that std::function allocates nothing
        again = false;
        for (const MutableOctree::Visits& visits : listed_) {
            again |= !visits.first_used.empty();
            octree.use(visits.first_used);
        }
    }
}

void ChangeSearch::apply_large_change(const View& scene, MutableOctree& octree, std::uint32_t number) {
    const OctreeChange& change = changes_[number];
    Worker& worker = workers_[0];
    const auto search = [&](const CellBox& box, std::uint8_t around) {
        found_.clear();
        octree.search(box, found_);
        worker.hits.clear();
        for (const std::uint32_t object : found_) worker.hits.push_back({number, object, around});
        judge(scene, worker);
    };
    if (change.existed) {
        search(change.before, around_before);
        octree.erase(change.object, change.before);
    }
    if (change.exists) {
        search(change.after, around_after);
        octree.insert(change.object, change.after);
    }
}

void ChangeSearch::apply_listed_changes(const View& scene, MutableOctree& octree, const Limits& limits) {
    auto& visits = listed_[0].visits;
    for (std::size_t i = 1; i < listed_.size(); ++i) {
        visits.insert(visits.end(), listed_[i].visits.begin(), listed_[i].visits.end());
    }
    std::uint64_t puts = 0;
    const auto keys = sort_.take(visits.size());
    for (std::size_t i = 0; i < visits.size(); ++i) {
        puts += visits[i].put ? 1 : 0;
        keys[i] = std::uint64_t(visits[i].unit) << 32 | i;
    }
    octree.reserve(puts);
    // A single thread makes the visits in the order of the changes. Several threads need them sorted by unit, to divide the units.
    const auto order = team_.threads() == 1 ? keys : sort_.sort(32, 32 + unsigned(std::bit_width(octree.units())));
    const std::size_t share_size = tuning().scene.share_visits, run_size = tuning().scene.run_visits;
    const auto make_share = [&](std::size_t i, unsigned worker) {
        const std::size_t end = share_begin(order, (i + 1) * share_size);
        auto& hits = workers_[worker].hits;
        for (std::size_t begin = share_begin(order, i * share_size); begin < end;) {
            throw_if_beyond(limits, workers_[worker]);
            hits.clear();
            begin += octree.run(visits, order.subspan(begin, std::min(run_size, end - begin)), hits);
            judge(scene, workers_[worker]);
        }
    };
    team_.for_each((order.size() + share_size - 1) / share_size, std::ref(make_share));
}

void ChangeSearch::judge(const View& scene, Worker& worker) const {
    const auto& hits = worker.hits;
    Judged judged;
    for (std::size_t i = 0; i < hits.size(); ++i) {
        if (i + judged_ahead < hits.size()) {
            scene.table.prefetch(hits[i + judged_ahead].object);
            scene.table.prefetch(changes_[hits[i + judged_ahead].change].object);
        }
        if (judged.change != hits[i].change) {
            const PreviousState& former = scene.log.previous_states()[hits[i].change];
            judged = {hits[i].change, former.index, former.state, scene.table.state(former.index)};
        }
        judge(scene, hits[i], judged, worker);
    }
}

void ChangeSearch::judge(const View& scene, const Hit& hit, const Judged& judged, Worker& worker) const {
    const std::uint32_t other = hit.object;
    if (other == judged.object) return;
    const ObjectState other_after = scene.table.state(other);
    bool began = (hit.around & around_after) != 0, ended = (hit.around & around_before) != 0;
    bool was;
    if (const std::uint32_t number = scene.table.mark(other); number == ObjectTable::none) {
        was = are_pair(judged.before, other_after, scene.margin);
    } else {
        const bool earlier = is_large_[number] != is_large_[hit.change] ? is_large_[number] != 0 : number < hit.change;
        began = began && earlier;
        ended = ended && !earlier;
        was = are_pair(judged.before, scene.log.previous_states()[number].state, scene.margin);
    }
    const bool is = are_pair(judged.after, other_after, scene.margin);
    const std::uint64_t key = key_of({std::min(judged.object, other), std::max(judged.object, other)});
    if (ended && was && !is) worker.ended.push_back(key);
    if (began && is && !was) worker.began.push_back(key);
}

void ChangeSearch::collect(std::vector<std::uint64_t> Worker::*keys, std::vector<Pair>& pairs) {
    std::size_t size = 0;
    for (const Worker& worker : workers_) size += (worker.*keys).size();
    const auto all = sort_.take(size);
    auto at = all.begin();
    for (const Worker& worker : workers_) at = std::copy((worker.*keys).begin(), (worker.*keys).end(), at);
    pairs.clear();
    for (const std::uint64_t key : sort_.sort(0, 64)) pairs.push_back(pair_of(key));
}

}  // namespace octopair
