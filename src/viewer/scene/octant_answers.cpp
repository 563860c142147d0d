// Answers about the octants of a frame.
#include <algorithm>
#include <optional>

#include "viewer/scene/frame_answers.hpp"

namespace octopair::viewer {

Octants octants_of(const ShownFrame& frame, unsigned threads) {
    const OctantOptions options{frame.contents.margin, threads};
    const FrameData& data = frame.data;
    if (data.exists.empty()) return list_octants({data.boxes, data.padding}, options);
    // Build the octree of the existing objects only: objects that do not exist in this frame have no boxes.
    std::vector<Box3d> boxes;
    for (std::size_t i = 0; i < data.exists.size(); ++i) {
        if (data.has(i)) boxes.push_back(box_of(data, i));
    }
    return list_octants({std::span<const Box3d>(boxes)}, options);
}

std::vector<std::uint8_t> levels_of(const FrameData& data, const Octants& octants) {
    std::vector<std::uint8_t> levels = octants.levels();
    if (data.exists.empty()) return levels;
    std::vector<std::uint8_t> of_all(data.exists.size(), 0);
    std::size_t next = 0;
    for (std::size_t i = 0; i < of_all.size(); ++i) {
        if (data.has(i)) of_all[i] = levels[next++];
    }
    return of_all;
}

OctalCode home_code(const FrameData& data, std::uint32_t object, const Octants& octants) {
    const auto before = data.exists.begin() + std::ptrdiff_t(data.exists.empty() ? 0 : object);
    const std::size_t position = data.exists.empty() ? object : std::size_t(std::count(data.exists.begin(), before, 1));
    return octants.all()[octants.home_octants()[position]].code;
}

namespace {

/// Returns the part of an octant inside `space`, or nothing if the octant is outside `space`.
std::optional<Box3d> used_part(const OctantSummary& octant, const Box3d& space) {
    if (!overlap(octant.bounds, space)) return std::nullopt;
    Box3d part = octant.bounds;
    for (int i = 0; i < 3; ++i) {
        part.min[i] = std::max(part.min[i], space.min[i]);
        part.max[i] = std::min(part.max[i], space.max[i]);
    }
    return part;
}

}  // namespace

Answer octant_summary(const Octants& octants) {
    struct Level {
        std::uint64_t octants = 0, leaves = 0, listed = 0;
    };
    std::vector<Level> levels;
    std::uint64_t entries = 0;
    const Box3d space = octants.space();
    for (const OctantSummary& octant : octants.all()) {
        if (!used_part(octant, space)) continue;
        levels.resize(std::max<std::size_t>(levels.size(), octant.code.level() + 1));
        Level& level = levels[octant.code.level()];
        ++level.octants;
        level.leaves += octant.leaf ? 1 : 0;
        level.listed = std::min<std::uint64_t>(level.octants, max_listed_octants);
        entries += octant.entries;
    }
    Json list = Json::array();
    for (const Level& level : levels) {
        list.push_back({{"octants", level.octants}, {"leaves", level.leaves}, {"listed", level.listed}});
    }
    return json_answer({{"entries", entries}, {"levels", list}});
}

Answer octant_level(const Octants& octants, unsigned level, const Point3d& origin) {
    struct Row {
        RelativeBox bounds;
        std::uint32_t entries, homes, flags, key_high, key_low;
    };
    static_assert(sizeof(Row) == 44);
    const auto at_most_32_bits = [](std::uint64_t count) {
        return std::uint32_t(std::min<std::uint64_t>(count, 0xFFFFFFFF));
    };
    const Box3d space = octants.space();
    std::vector<Row> rows;
    for (const OctantSummary& octant : octants.all()) {
        if (octant.code.level() != level || rows.size() == max_listed_octants) continue;
        const auto part = used_part(octant, space);
        if (!part) continue;
        const std::uint64_t key = octant.code.key();
        rows.push_back({relative(*part, origin), at_most_32_bits(octant.entries), at_most_32_bits(octant.homes),
                        octant.leaf ? 1u : 0u, std::uint32_t(key >> 32), std::uint32_t(key)});
    }
    return binary_answer(std::span<const Row>(rows));
}

}  // namespace octopair::viewer
