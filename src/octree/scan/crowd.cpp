#include "octree/scan/crowd.hpp"

#include <algorithm>
#include <iterator>

#include "base/test_hooks.hpp"
#include "base/tuning.hpp"
#include "octree/scan/scan.hpp"
#include "octree/sweep/recursive_sweep.hpp"

namespace octopair {

namespace {

/// Source of a nested octree: the entries of a join, rows before columns.
class JoinSource final : public ForwardingSource {
public:
    JoinSource(const EntrySource& source, const SweepInput& join) : ForwardingSource(source), join_(join) {}
    std::size_t size() const override { return join_.size(); }
    bool load(std::size_t begin, std::span<Entry> out) const override {
        const std::size_t rows = std::min(out.size(), join_.rows.size() - std::min(begin, join_.rows.size()));
        if (rows > 0) join_.rows.load(begin, out.first(rows));
        if (rows < out.size()) join_.columns.load(begin + rows - join_.rows.size(), out.subspan(rows));
        return true;
    }
    Float32Boxes float32_boxes(std::size_t, std::span<Box3f>) const override { return {}; }
    void pick(std::span<const std::size_t> positions, std::span<Entry> out) const override {
        for (std::size_t i = 0; i < out.size(); ++i) load(positions[i], out.subspan(i, 1));
    }

private:
    const SweepInput& join_;
};

}  // namespace

void CrowdScan::clear() {
    for (Crowd& crowd : crowd_of_part_) {
        crowd.whole.clear();
        crowd.ids.clear();
    }
}

void CrowdScan::scan(const OctantEntries& octant, OctantPart rows, OctantPart columns) {
    const EntryList row_list = list_of(octant, rows);
    scan({row_list, list_of(octant, columns), rows == columns, {}});
}

/// Returns the entries of a part. The list is valid until the next call of clear().
EntryList CrowdScan::list_of(const OctantEntries& octant, OctantPart part) {
    if (part.handed && part.set == OctantPart::any_set) return EntryList(octant.handed);
    Crowd& crowd = crowd_of_part_[part.number()];
    if (crowd.whole.empty() && crowd.ids.empty()) collect(octant, part, crowd);
    return crowd.ids.empty() ? EntryList(crowd.whole) : EntryList(context_.source, crowd.ids);
}

/// Collects the entries of a part with their bounds, or as ids alone if they are more than `max_whole_crowd` of all entries.
void CrowdScan::collect(const OctantEntries& octant, OctantPart part, Crowd& crowd) const {
    if (part.handed) {
        std::ranges::copy_if(octant.handed, std::back_inserter(crowd.whole),
                             [part](const Entry& entry) { return part.has(entry.mask); });
        return;
    }
    const std::size_t own = octant.own_count();
    const bool whole = double(own) <= tuning().scan.max_whole_crowd * double(octree_.entry_count());
    whole ? crowd.whole.reserve(own) : crowd.ids.reserve(own);
    for (const auto run : octant.own) {
        for (const CellEntry& entry : run) {
            const std::uint32_t mask = octant.cells.mask_of(entry);
            if (!part.has(mask)) continue;
            whole ? crowd.whole.push_back({{}, {}, entry.object, mask}) : crowd.ids.push_back({entry.object, mask});
        }
    }
    if (whole) count_path(Path::crowd_whole);
    context_.source.load_bounds(crowd.whole);
}

/// Finds the pairs of a join. Parts of one shape are joined separately: boxes as long as the octant prevent any sweep and any split
/// from thinning the other boxes.
void CrowdScan::scan(const SweepInput& join) {
    if (try_sweep(join)) return count_path(Path::crowd_swept);
    count_path(Path::crowd_parted);
    const auto rows = part_by_shape(join.rows, context_.stop);
    const auto columns = join.self ? decltype(rows){} : part_by_shape(join.columns, context_.stop);
    for (unsigned i = 0; i < rows.size(); ++i) {
        const EntryList row_list = join.rows.at(rows[i]);
        if (join.self) scan_part({row_list, row_list, true, {}}, true);
        const unsigned first = join.self && !planted(Fault::part_joined_twice) ? i + 1 : 0;
        for (unsigned k = first; k < rows.size(); ++k) {
            if (join.self && k == i) continue;
            const EntryList column_list = join.columns.at(join.self ? rows[k] : columns[k]);
            scan_part({row_list, column_list, false, {}}, i == k);
        }
    }
}

void CrowdScan::scan_part(const SweepInput& join, bool same_shape) {
    if (join.rows.size() == 0 || join.columns.size() == 0) return;
    if (try_sweep(join)) return count_path(Path::part_swept);
    // Only the two sets of the caller's join have bits in the masks. A nested octree of other rows and columns would
    // also report pairs within the rows and within the columns.
    const bool separable = join.self || context_.source.join();
    if (same_shape && separable && try_nested_scan(join)) return;
    count_path(Path::part_recursive);
    recursive_sweep(context_, join, executor_);
}

bool CrowdScan::try_sweep(const SweepInput& join) {
    const SweepChoice choice = chooser_.choose(join);
    if (choice.good) tiled_sweep(context_, join, choice.axis, executor_);
    return choice.good;
}

/// Scans a nested octree of the join's entries. Returns false, with no pairs written, if the nesting is too deep or the
/// octree does not thin the entries.
bool CrowdScan::try_nested_scan(const SweepInput& join) {
    if (context_.nesting >= tuning().scan.max_nesting) {
        count_path(Path::not_nested_depth);
        return false;
    }
    const JoinSource entries(context_.source, join);
    const BuildPlace place = executor_.build_place(entries.size());
    LinearOctree nested(place.pages);
    nested.build(entries, place.executor, context_.stop);
    if (!thins(nested, entries.size())) return false;
    ScanContext within = context_;
    ++within.nesting;
    within.growth *= double(nested.entry_count()) / double(entries.size());
    constexpr std::array paths = {Path::nested_once, Path::nested_twice, Path::nested_thrice};
    count_path(within.nesting <= paths.size() ? paths[within.nesting - 1] : Path::nested_deeper);
    if (!join.self) count_path(Path::nested_join);
    octopair::scan(nested, within, executor_, {});
    return true;
}

/// True if the largest octant of a nested octree holds few enough of the join's `entries`, and the octree has not
/// multiplied the entries beyond the bound.
bool CrowdScan::thins(const LinearOctree& nested, std::size_t entries) const {
    std::size_t largest = 0;
    for (OctantIndex octant = 0; octant < nested.octants().size(); ++octant) {
        largest = std::max(largest, std::size_t(nested.entry_count(octant)));
    }
    const bool thinner = double(largest) <= tuning().scan.max_part_in_octant * double(entries);
    const double growth = context_.growth * double(nested.entry_count()) / double(entries);
    const bool bounded = growth <= tuning().scan.max_growth;
    if (!thinner) count_path(Path::not_nested_largest);
    if (thinner && !bounded) count_path(Path::not_nested_growth);
    return thinner && bounded;
}

}  // namespace octopair
