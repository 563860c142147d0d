#include "io/loaded_shapes.hpp"

#include <algorithm>
#include <iterator>

namespace octopair::io {

namespace {

template <typename T>
void move_behind(std::vector<T>& to, std::vector<T>&& from) {
    if (to.empty()) {
        to = std::move(from);
    } else {
        std::move(from.begin(), from.end(), std::back_inserter(to));
    }
    from.clear();
}

/// With numbers that go on where those of `to` end.
void number_on(std::vector<std::uint32_t>& to, std::span<const std::uint32_t> from, std::uint64_t first) {
    std::transform(from.begin(), from.end(), std::back_inserter(to),
                   [first](std::uint32_t number) { return std::uint32_t(first + number); });
}

/// How many objects two sets have.
struct Counts {
    std::size_t first, second;
};

/// Where one of the two has an array, the other gets its default.
template <typename T>
void append_optional(std::vector<T>& to, std::vector<T>&& from, const Counts& counts, const T& absent) {
    if (to.empty() && from.empty()) return;
    to.resize(counts.first, absent);
    from.resize(counts.second, absent);
    move_behind(to, std::move(from));
}

}  // namespace

void LoadedShapes::append(LoadedShapes&& others) {
    const Counts counts{poses.size(), others.poses.size()};
    if (!end_poses.empty() || !others.end_poses.empty()) {
        if (end_poses.empty()) end_poses = poses;
        if (others.end_poses.empty()) others.end_poses = others.poses;
        move_behind(end_poses, std::move(others.end_poses));
    }
    append_optional(padding, std::move(others.padding), counts, 0.0);
    append_optional(groups, std::move(others.groups), counts, default_groups);
    append_optional(masks, std::move(others.masks), counts, default_mask);
    const auto last_parent = std::max_element(parents.begin(), parents.end());
    number_on(parents, others.parents, last_parent == parents.end() ? 0 : std::uint64_t(*last_parent) + 1);
    number_on(geometry, others.geometry, shapes.size());
    move_behind(shapes, std::move(others.shapes));
    move_behind(poses, std::move(others.poses));
}

void LoadedTriangles::append(LoadedTriangles&& others) {
    number_on(owners, others.owners, owner_names.size());
    move_behind(owner_names, std::move(others.owner_names));
    move_behind(triangles, std::move(others.triangles));
}

}  // namespace octopair::io
