#include "io/loaded_scene.hpp"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "io/formats/unit_change.hpp"

namespace octopair::io {

namespace {

template <typename T>
void append_moved(std::vector<T>& to, std::vector<T>&& from) {
    if (to.empty()) {
        to = std::move(from);
    } else {
        std::move(from.begin(), from.end(), std::back_inserter(to));
    }
    from.clear();
}

/// Appends `from` with `first` added to each number.
void append_renumbered(std::vector<std::uint32_t>& to, std::span<const std::uint32_t> from, std::uint64_t first) {
    std::transform(from.begin(), from.end(), std::back_inserter(to),
                   [first](std::uint32_t number) { return std::uint32_t(first + number); });
}

/// Numbers of objects of two sets.
struct Counts {
    std::size_t first, second;
};

/// Appends an optional array. If only one set has the array, the other set is filled with the default.
template <typename T>
void append_optional(std::vector<T>& to, std::vector<T>&& from, const Counts& counts, const T& absent) {
    if (to.empty() && from.empty()) return;
    to.resize(counts.first, absent);
    from.resize(counts.second, absent);
    append_moved(to, std::move(from));
}

}  // namespace

std::string ElementCounts::lost_text() const {
    if (lost.empty()) return {};
    std::string types;
    for (const LostElements& some : lost) {
        types += fmt::format("{}{} {}, the first is {}", types.empty() ? "" : "; ", some.count, some.type, some.first);
    }
    return fmt::format("{} of {} elements with geometry were not read: {}", with_geometry - read, with_geometry, types);
}

void ElementCounts::add(const ElementCounts& others) {
    with_geometry += others.with_geometry;
    read += others.read;
    lost.insert(lost.end(), others.lost.begin(), others.lost.end());
    for (const TypeCount& other : others.left_out) {
        const auto same = std::find_if(left_out.begin(), left_out.end(),
                                       [&](const TypeCount& known) { return known.type == other.type; });
        same != left_out.end() ? same->count += other.count : left_out.emplace_back(other).count;
    }
}

void LoadedScene::set_unit(const std::string& of_file, const std::string& wanted) {
    const bool same = UnitChange(of_file, wanted).is_none();
    space.unit = same ? of_file : wanted;
    converted_from = same ? std::string() : of_file;
}

void LoadedShapes::append(LoadedShapes&& others) {
    const Counts counts{poses.size(), others.poses.size()};
    if (!end_poses.empty() || !others.end_poses.empty()) {
        if (end_poses.empty()) end_poses = poses;
        if (others.end_poses.empty()) others.end_poses = others.poses;
        append_moved(end_poses, std::move(others.end_poses));
    }
    append_optional(padding, std::move(others.padding), counts, 0.0);
    append_optional(groups, std::move(others.groups), counts, default_groups);
    append_optional(masks, std::move(others.masks), counts, default_mask);
    const auto last_parent = std::max_element(parents.begin(), parents.end());
    append_renumbered(parents, others.parents, last_parent == parents.end() ? 0 : std::uint64_t(*last_parent) + 1);
    append_renumbered(geometry, others.geometry, shapes.size());
    append_moved(shapes, std::move(others.shapes));
    append_moved(poses, std::move(others.poses));
}

void LoadedTriangles::append(LoadedTriangles&& others) {
    append_renumbered(owners, others.owners, owner_names.size());
    append_details(owner_details, others.owner_details, {owner_names.size(), others.owner_names.size()});
    append_moved(owner_names, std::move(others.owner_names));
    append_moved(triangles, std::move(others.triangles));
}

}  // namespace octopair::io
