#include "cli/view/shown_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <utility>

#include "cli/detect/pipeline_options.hpp"
#include "cli/input/search_inputs.hpp"
#include "viewer/scene/shown_objects.hpp"
#ifdef OCTOPAIR_WITH_PIPELINE
#include "cli/input/shaped_set.hpp"
#endif

namespace octopair::cli {

namespace {

using viewer::SceneContents;

std::vector<std::string> shown_names(const InputSet& set) {
    if (!set.scene.triangles) return set.scene.names;
    std::vector<std::string> names;
    for (const std::uint32_t owner : set.scene.triangles->owners) {
        names.push_back(set.scene.triangles->owner_names[owner]);
    }
    return names;
}

viewer::ObjectTexts shown_details(const InputSet& set) {
    const auto& triangles = set.scene.triangles;
    const io::ObjectDetails& table = triangles ? triangles->owner_details : set.scene.details;
    viewer::ObjectTexts texts;
    if (table.empty()) return texts;
    texts.words = table.words;
    for (const io::Detail detail : io::all_details) {
        if (!table.has(detail)) continue;
        viewer::ObjectTexts::Column column{std::string(io::word_of(detail)), {}};
        column.words.reserve(std::size_t(set.scene.objects));
        for (std::size_t i = 0; i < set.scene.objects; ++i) {
            const std::size_t row = triangles ? triangles->owners[i] : i;
            column.words.push_back(row < table.rows.size() ? table.rows[row][std::size_t(detail)] : 0);
        }
        texts.columns.push_back(std::move(column));
    }
    return texts;
}

#ifdef OCTOPAIR_WITH_PIPELINE
void add_shapes(SceneContents& contents, const InputSet& set) {
    if (set.shaped == nullptr) return;
    const ShapedObjects objects = set.shaped->objects();
    const Box3d bounds = set.bounds();
    // The page draws a plane as a square around the plane's origin. The square must be large enough to reach the objects.
    const auto reach = [&](std::size_t axis) {
        return 2 * std::max(std::abs(bounds.min[axis]), std::abs(bounds.max[axis]));
    };
    const double extent = std::hypot(reach(0), reach(1), reach(2));
    for (const Geometry& geometry : objects.geometries) {
        contents.shapes.push_back(viewer::shown_shape(geometry.shape(), std::isfinite(extent) ? extent : 1));
    }
    contents.geometry.assign(objects.geometry.begin(), objects.geometry.end());
    contents.poses.assign(objects.poses.begin(), objects.poses.end());
    if (set.shaped->has_groups()) {
        const GroupMasks masks = set.shaped->group_masks();
        contents.groups.assign(masks.groups.begin(), masks.groups.end());
    }
}
#endif

/// Returns what is known about one set.
SceneContents contents_of(const InputSet& set) {
    SceneContents contents;
    contents.objects = set.scene.objects;
    contents.moving = set.scene.moving;
    contents.up = axis_word(set.scene.space.up);
    contents.unit = set.scene.space.unit;
    contents.names = shown_names(set);
    contents.details = shown_details(set);
#ifdef OCTOPAIR_WITH_PIPELINE
    add_shapes(contents, set);
#endif
    return contents;
}

/// Numbers of objects of a scene before and after objects are appended.
struct Growth {
    std::size_t before, after;
};

/// Appends a table of texts.
void append(viewer::ObjectTexts& texts, viewer::ObjectTexts&& others, const Growth& growth) {
    const std::size_t words = texts.words.size();
    std::move(others.words.begin(), others.words.end(), std::back_inserter(texts.words));
    for (auto& column : texts.columns) column.words.resize(growth.after);
    for (const auto& other : others.columns) {
        const auto is_same = [&](const auto& column) { return column.name == other.name; };
        auto found = std::find_if(texts.columns.begin(), texts.columns.end(), is_same);
        if (found == texts.columns.end()) {
            texts.columns.push_back({other.name, std::vector<std::uint32_t>(growth.after)});
            found = std::prev(texts.columns.end());
        }
        for (std::size_t i = 0; i < other.words.size(); ++i) {
            found->words[growth.before + i] = other.words[i] == 0 ? 0 : std::uint32_t(words) + other.words[i];
        }
    }
}

/// Appends the objects of a second set.
void append(SceneContents& contents, SceneContents&& other) {
    const Growth growth{std::size_t(contents.objects), std::size_t(contents.objects + other.objects)};
    const auto join = [&](auto& to, auto& from, const auto& unknown) {
        if (to.empty() && from.empty()) return;
        to.resize(growth.before, unknown);
        from.resize(growth.after - growth.before, unknown);
        to.insert(to.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
    };
    for (std::uint32_t& shape : other.geometry) {
        if (shape != SceneContents::no_shape) shape += std::uint32_t(contents.shapes.size());
    }
    join(contents.names, other.names, std::string());
    join(contents.groups, other.groups, 1u);
    join(contents.geometry, other.geometry, SceneContents::no_shape);
    join(contents.poses, other.poses, Pose());
    append(contents.details, std::move(other.details), growth);
    std::move(other.shapes.begin(), other.shapes.end(), std::back_inserter(contents.shapes));
    contents.objects = growth.after;
    contents.moving |= other.moving;
    if (contents.up != other.up) contents.up.clear();
    if (contents.unit.empty())
        contents.unit = other.unit;  // all inputs with a unit have been converted to that of the first
}

/// Returns the name of each path: its last part, or the whole path if two files have the same last part.
std::vector<std::string> short_names(const std::vector<std::string>& paths) {
    std::vector<std::string> names;
    names.reserve(paths.size());
    for (const std::string& path : paths) names.push_back(path.substr(path.rfind('/') + 1));
    const std::set<std::string> different(names.begin(), names.end());
    return different.size() == names.size() ? names : paths;
}

void add_files(SceneContents& contents, const SetPair& sets) {
    std::vector<std::string> paths;
    std::vector<std::uint64_t> firsts;
    std::uint64_t first = 0;
    for (const InputSet* set : {&sets.first, sets.second}) {
        if (set == nullptr) continue;
        for (const Part& part : set->parts) {
            paths.push_back(part.path);
            firsts.push_back(first);
            first += part.objects;
        }
    }
    const std::vector<std::string> names = short_names(paths);
    for (std::size_t i = 0; i < names.size(); ++i) {
        contents.title += (i == 0 ? "" : i == sets.first.parts.size() ? " against " : ", ") + names[i];
        if (names.size() > 1) contents.files.push_back({names[i], firsts[i]});
    }
}

void add_facts(SceneContents& contents, const DetectRequest& request, const SetPair& sets) {
    if (stage_of(request) == Stage::features) {
        contents.facts.push_back({"tolerance", 0, fmt::format("{:.3g}", tolerance_of(request, sets))});
    }
    if (request.pipeline.chord) {
        contents.facts.push_back({"chord error", 0, fmt::format("{}", *request.pipeline.chord)});
    }
    if (request.pipeline.min_depth) {
        contents.facts.push_back({"least depth", 0, fmt::format("{}", *request.pipeline.min_depth)});
    }
    if (const auto& classes = request.pipeline.classes) contents.facts.push_back({"classes", 0, class_list(*classes)});
    if (request.limit) contents.facts.push_back({"limit", 0, fmt::format("the first {}", *request.limit)});
    for (const auto& [name, path] : {std::pair("excluded by", &request.pipeline.exclude),
                                     std::pair("compared with", &request.pipeline.baseline)}) {
        if (!path->empty()) contents.facts.push_back({name, 0, *path});
    }
}

}  // namespace

std::string axis_word(io::UpAxis up) {
    if (up == io::UpAxis::unknown) return {};
    return up == io::UpAxis::y ? "y" : "z";
}

viewer::SceneContents shown_scene(const DetectRequest& request, const SetPair& sets) {
    SceneContents contents = contents_of(sets.first);
    if (sets.second != nullptr) {
        contents.second_set = contents.objects;
        append(contents, contents_of(*sets.second));
    }
    const io::SceneSpace& chosen = request.pipeline.space;
    if (chosen.up != io::UpAxis::unknown) contents.up = axis_word(chosen.up);
    if (!chosen.unit.empty()) contents.unit = chosen.unit;
    contents.margin = request.margin;
    contents.notices = input_warnings(request, sets);
    add_files(contents, sets);
    add_facts(contents, request, sets);
    return contents;
}

void show_boxes(viewer::FrameData& data, const SetPair& sets, std::uint64_t frame) {
    const Objects first = sets.first.frame(frame);
    if (sets.second == nullptr) {
        data.boxes = first.boxes;
        data.padding = first.padding;
        return;
    }
    const auto all = std::make_shared<std::vector<Box3d>>();
    for (const InputSet* set : {&sets.first, sets.second}) {
        const Boxes boxes = set->frame(frame).boxes;
        for (std::size_t i = 0; i < set->scene.objects; ++i) all->push_back(viewer::box_of(boxes, i));
    }
    data.boxes = std::span<const Box3d>(*all);
    data.keep = all;
}

}  // namespace octopair::cli
