#include "baselines/paper_steps.hpp"

#include <algorithm>
#include <iterator>
#include <limits>
#include <utility>

#include "baselines/overlap.hpp"
#include "octree/sweep/start_order.hpp"

namespace octopair::baselines {

namespace {

using Cube = Box3d;

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
    OctreeSearch(unsigned level, PaperList& entries) : level_(level), entries_(entries) {}

    void find(const Cube& object, std::uint32_t index, const Cube& root) {
        object_ = object;
        index_ = index;
        descend(OctalCode(), root);
    }

private:
    void descend(OctalCode code, const Cube& octant) {
        if (!overlap(object_, octant)) return;
        if (code.level() == level_ || holds(object_, octant)) {
            entries_.push_back({code, index_});
            return;
        }
        for (unsigned digit = 0; digit < 8; ++digit) descend(code.child(digit), child_octant(octant, digit));
    }

    unsigned level_;
    PaperList& entries_;
    Cube object_{};
    std::uint32_t index_ = 0;
};

/// Returns the level at which the octree has about as many octants as there are objects.
unsigned usual_level(std::size_t objects) {
    unsigned level = 1;
    while (level < 8 && (std::size_t(1) << (3 * level)) < objects) ++level;
    return level;
}

/// Runs step 7: returns the candidate pairs. In the sorted list, the entries inside an octant follow the octant's own
/// entries.
std::vector<Pair> candidates_of(const PaperList& entries) {
    std::vector<Pair> candidates;
    for (std::size_t i = 0; i < entries.size(); ++i) {
        for (std::size_t j = i + 1; j < entries.size() && common_path(entries[i].code, entries[j].code); ++j) {
            if (entries[i].object == entries[j].object) continue;
            candidates.push_back(ordered(entries[i].object, entries[j].object));
        }
    }
    return candidates;
}

}  // namespace

PaperOctree paper_octree(std::span<const Box3f> boxes, unsigned level) {
    return {root_octant(boxes), level == 0 ? usual_level(boxes.size()) : level};
}

PaperList paper_codes(const PaperSlice& slice, const PaperOctree& octree) {
    PaperList entries;
    OctreeSearch search(octree.level, entries);
    for (std::uint32_t i = 0; i < slice.boxes.size(); ++i) {
        search.find(bounding_cube(slice.boxes[i]), slice.first_index + i, octree.root);
    }
    return entries;
}

PaperList merge_paper_lists(std::vector<PaperList> lists) {
    while (lists.size() > 1) {
        std::vector<PaperList> merged;
        for (std::size_t i = 0; i + 1 < lists.size(); i += 2) {
            PaperList& out = merged.emplace_back();
            out.reserve(lists[i].size() + lists[i + 1].size());
            std::merge(lists[i].begin(), lists[i].end(), lists[i + 1].begin(), lists[i + 1].end(),
                       std::back_inserter(out));
        }
        if (lists.size() % 2 == 1) merged.push_back(std::move(lists.back()));
        lists = std::move(merged);
    }
    return lists.empty() ? PaperList() : std::move(lists.front());
}

std::vector<Pair> scan_paper_list(const PaperList& list, std::span<const Box3f> boxes, std::uint64_t& candidates) {
    std::vector<Pair> pairs = candidates_of(list);
    candidates = pairs.size();
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    std::erase_if(pairs, [&](Pair pair) { return !overlap(boxes[pair.a], boxes[pair.b]); });
    return pairs;
}

namespace {

constexpr unsigned bits_of_level = 4;
constexpr unsigned max_level = (32 - bits_of_level) / 3;

/// Sorts by path, then by level. These are the high 32 bits of a key, and the position of the entry is the low 32 bits.
/// The radix sort is stable, so entries with equal codes stay in the order of objects.
void radix_sort_entries(PaperList& entries, unsigned level) {
    Buffer<SortKey> keys(entries.size());
    for (std::size_t i = 0; i < entries.size(); ++i) {
        const OctalCode code = entries[i].code;
        const std::uint64_t path = code.key() >> (3 * (OctalCode::max_level - level));
        keys[i] = (path << bits_of_level | code.level()) << 32 | i;
    }
    NoPairs none;
    SerialExecutor alone(none);
    radix_sort(keys, alone, {});
    PaperList sorted(entries.size());
    for (std::size_t i = 0; i < sorted.size(); ++i) sorted[i] = entries[position_of(keys[i])];
    entries = std::move(sorted);
}

}  // namespace

void sort_entries(PaperList& entries, PaperSort sort, unsigned level) {
    if (sort == PaperSort::radix && level <= max_level && entries.size() <= std::uint32_t(-1)) {
        radix_sort_entries(entries, level);
    } else {
        std::sort(entries.begin(), entries.end());
    }
}

}  // namespace octopair::baselines
