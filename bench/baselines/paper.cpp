// The paper's algorithm as published (section 3.3):
// - Slaves compute octal codes and sort them.
// - Each machine merges the lists of its slaves. Then the master merges the lists of all machines.
// - A scan with CommonPath finds candidate pairs.
// - A last step removes duplicates and tests the pairs.
//
// Two errors of the pseudo code are corrected: the inner loop of step 7 starts after object1 and stops at the end of
// the list.
#include <algorithm>
#include <chrono>
#include <exception>
#include <iterator>
#include <limits>
#include <thread>
#include <utility>

#include "baselines/baselines.hpp"
#include "baselines/overlap.hpp"
#include "baselines/paper_sort.hpp"
#include "octopair/octal_code.hpp"

namespace octopair::baselines {

namespace {

using Cube = Box3d;
using EntryList = std::vector<PaperEntry>;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// Returns a cube around the centre of the box that contains the box.
Cube bounding_cube(const Box3f& box) {
    double half = 0;
    for (int axis = 0; axis < 3; ++axis) half = std::max(half, (double(box.max[axis]) - double(box.min[axis])) / 2);
    Cube cube;
    for (int axis = 0; axis < 3; ++axis) {
        const double centre = (double(box.min[axis]) + double(box.max[axis])) / 2;
        cube.min[axis] = std::min(centre - half, double(box.min[axis]));
        cube.max[axis] = std::max(centre + half, double(box.max[axis]));
    }
    return cube;
}

/// Returns the root octant of the octree: a cube that contains all objects.
Cube root_octant(std::span<const Box3f> boxes) {
    constexpr float infinity = std::numeric_limits<float>::infinity();
    Box3f bounds{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
    for (const Box3f& box : boxes) {
        for (int axis = 0; axis < 3; ++axis) {
            bounds.min[axis] = std::min(bounds.min[axis], box.min[axis]);
            bounds.max[axis] = std::max(bounds.max[axis], box.max[axis]);
        }
    }
    return bounding_cube(bounds);
}

/// Returns child `digit` of `octant`. Neighbours share their border bit for bit, so no point lies between two octants.
Cube child_octant(const Cube& octant, unsigned digit) {
    Cube child = octant;
    for (unsigned axis = 0; axis < 3; ++axis) {
        const double middle = (octant.min[axis] + octant.max[axis]) / 2;
        (digit >> axis & 1u ? child.min : child.max)[axis] = middle;
    }
    return child;
}

bool holds(const Cube& outer, const Cube& inner) {
    for (int axis = 0; axis < 3; ++axis) {
        if (inner.min[axis] < outer.min[axis] || inner.max[axis] > outer.max[axis]) return false;
    }
    return true;
}

/// SearchOctree of one object: finds the octants of the fixed level that the object meets. An octant that the object
/// fills is stored as a whole, because an entry of a non-leaf octant occupies all descendants (section 2.3.2).
class OctreeSearch {
public:
    OctreeSearch(unsigned level, EntryList& entries) : level_(level), entries_(entries) {}

    void find(const Cube& object, std::uint32_t index, const Cube& root) {
        object_ = object;
        index_ = index;
        descend(OctalCode(), root);
    }

private:
    void descend(OctalCode code, const Cube& octant) {
        if (!overlap(object_, octant)) return;
        if (code.level() == level_ || holds(object_, octant)) {
            entries_.emplace_back(code, index_);
            return;
        }
        for (unsigned digit = 0; digit < 8; ++digit) descend(code.child(digit), child_octant(octant, digit));
    }

    unsigned level_;
    EntryList& entries_;
    Cube object_{};
    std::uint32_t index_ = 0;
};

struct SlaveResult {
    EntryList entries;
    double octal_codes = 0, sort = 0;
};

struct SlaveTask {
    std::span<const Box3f> boxes;
    std::uint32_t first_index;  // index of boxes[0] among all objects
    Cube root;
    unsigned level;
    PaperSort sort;
};

/// Runs steps 2 and 3 of the paper: octal codes and sort.
void run_slave(const SlaveTask& task, SlaveResult& result) {
    auto start = Clock::now();
    OctreeSearch search(task.level, result.entries);
    for (std::uint32_t i = 0; i < task.boxes.size(); ++i) {
        search.find(bounding_cube(task.boxes[i]), task.first_index + i, task.root);
    }
    result.octal_codes = seconds_since(start);
    start = Clock::now();
    sort_entries(result.entries, task.sort, task.level);
    result.sort = seconds_since(start);
}

EntryList merge_sorted_lists(std::vector<EntryList> lists) {
    while (lists.size() > 1) {
        std::vector<EntryList> merged;
        for (std::size_t i = 0; i + 1 < lists.size(); i += 2) {
            EntryList& out = merged.emplace_back();
            out.reserve(lists[i].size() + lists[i + 1].size());
            std::merge(lists[i].begin(), lists[i].end(), lists[i + 1].begin(), lists[i + 1].end(),
                       std::back_inserter(out));
        }
        if (lists.size() % 2 == 1) merged.push_back(std::move(lists.back()));
        lists = std::move(merged);
    }
    return lists.empty() ? EntryList() : std::move(lists.front());
}

/// Runs `work(i)` for i below `count`, each on its own thread. Throws: the exception of a call, for example when the
/// octants exceed the memory.
template <typename Work>
void run_side_by_side(std::size_t count, const Work& work) {
    std::vector<std::exception_ptr> failures(count);
    const auto guarded_work = [&](std::size_t i) {
        try {
            work(i);
        } catch (...) {
            failures[i] = std::current_exception();
        }
    };
    {
        std::vector<std::jthread> threads;
        threads.reserve(count);
        for (std::size_t i = 1; i < count; ++i) threads.emplace_back(guarded_work, i);
        if (count > 0) guarded_work(0);
    }
    for (const std::exception_ptr& failure : failures) {
        if (failure) std::rethrow_exception(failure);
    }
}

/// Runs steps 1 to 3 on all slaves, with equal shares of the objects.
std::vector<EntryList> run_slaves(std::span<const Box3f> boxes, const PaperSettings& settings, PaperSeconds& seconds) {
    const std::size_t slaves = std::size_t(settings.machines) * settings.slaves_per_machine;
    const Cube root = root_octant(boxes);
    std::vector<SlaveResult> results(slaves);
    run_side_by_side(slaves, [&](std::size_t slave) {
        const std::size_t first = boxes.size() * slave / slaves, last = boxes.size() * (slave + 1) / slaves;
        run_slave({boxes.subspan(first, last - first), std::uint32_t(first), root, settings.level, settings.sort},
                  results[slave]);
    });
    std::vector<EntryList> lists;
    for (SlaveResult& result : results) {
        seconds.octal_codes = std::max(seconds.octal_codes, result.octal_codes);
        seconds.sort = std::max(seconds.sort, result.sort);
        lists.push_back(std::move(result.entries));
    }
    return lists;
}

/// Merges the lists of each machine's slaves on that machine, all machines in parallel.
std::vector<EntryList> merge_on_machines(std::vector<EntryList> lists, unsigned machines) {
    const std::size_t per_machine = lists.size() / machines;
    std::vector<EntryList> merged(machines);
    run_side_by_side(machines, [&](std::size_t machine) {
        const auto first = lists.begin() + std::ptrdiff_t(machine * per_machine);
        const auto last = first + std::ptrdiff_t(per_machine);
        merged[machine] = merge_sorted_lists({std::make_move_iterator(first), std::make_move_iterator(last)});
    });
    return merged;
}

/// Runs step 7: returns the candidate pairs. In the sorted list, the entries inside an octant follow the octant's own
/// entries.
std::vector<Pair> scan(const EntryList& entries) {
    std::vector<Pair> candidates;
    for (std::size_t i = 0; i < entries.size(); ++i) {
        for (std::size_t j = i + 1; j < entries.size() && common_path(entries[i].first, entries[j].first); ++j) {
            if (entries[i].second == entries[j].second) continue;
            candidates.push_back(ordered(entries[i].second, entries[j].second));
        }
    }
    return candidates;
}

/// Returns the level at which the octree has about as many octants as there are objects.
unsigned usual_level(std::size_t objects) {
    unsigned level = 1;
    while (level < 8 && (std::size_t(1) << (3 * level)) < objects) ++level;
    return level;
}

}  // namespace

PaperResult paper_pairs(std::span<const Box3f> boxes, const PaperSettings& settings) {
    PaperResult result;
    PaperSettings used = settings;
    if (used.level == 0) used.level = usual_level(boxes.size());
    std::vector<EntryList> lists = run_slaves(boxes, used, result.seconds);

    auto start = Clock::now();
    lists = merge_on_machines(std::move(lists), used.machines);
    result.seconds.merge_machine = seconds_since(start);
    start = Clock::now();
    const EntryList entries = merge_sorted_lists(std::move(lists));
    result.seconds.merge_master = seconds_since(start);

    start = Clock::now();
    std::vector<Pair> pairs = scan(entries);
    result.entries = entries.size();
    result.candidates = pairs.size();
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    std::erase_if(pairs, [&](Pair pair) { return !overlap(boxes[pair.a], boxes[pair.b]); });
    result.pairs = std::move(pairs);
    result.seconds.scan = seconds_since(start);
    return result;
}

}  // namespace octopair::baselines
