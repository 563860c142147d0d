#include "io/scene_reader.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "io/boxes/csv.hpp"
#include "io/boxes/npy.hpp"
#include "io/files/failure.hpp"
#include "io/formats/format_choice.hpp"
#include "io/json/json_scene.hpp"
#include "io/meshes/assimp/mesh_reader.hpp"
#include "io/meshes/gltf/gltf_scene.hpp"
#include "io/meshes/plain/plain_mesh.hpp"
#include "io/meshes/stream/model_stream.hpp"
#include "io/meshes/stream/reader_program.hpp"
#include "io/meshes/three_mf/three_mf_scene.hpp"

namespace octopair::io {

namespace {

template <typename To, typename From>
void copy_frame(const Buffer<From>& from, std::size_t begin, std::span<To> to) {
    std::transform(from.data() + begin, from.data() + begin + to.size(), to.data(), [](const From& box) {
        To copy;
        std::copy_n(box.min, 3, copy.min);
        std::copy_n(box.max, 3, copy.max);
        return copy;
    });
}

template <typename To>
Buffer<To> join_boxes(std::span<LoadedScene> scenes, std::uint64_t objects) {
    const std::uint64_t frames = scenes.front().frames;
    Buffer<To> joined{std::size_t(frames * objects)};
    std::uint64_t first = 0;
    for (LoadedScene& scene : scenes) {
        for (std::uint64_t f = 0; f < frames; ++f) {
            const auto place = joined.span().subspan(f * objects + first, scene.objects);
            std::visit([&](const auto& boxes) { copy_frame(boxes, f * scene.objects, place); }, scene.boxes);
        }
        first += scene.objects;
        scene.check_mapped();
        scene.boxes = {};  // frees each input at once: besides the result, at most one copy exists
    }
    return joined;
}

/// Returns what a scene has besides boxes, in words for a message.
const char* content_of(const LoadedScene& scene) {
    if (scene.shapes) return "shapes";
    return scene.triangles ? "triangles" : "only boxes";
}

void check_same_content(std::span<const LoadedScene> scenes, std::span<const std::string> paths) {
    for (std::size_t i = 0; i < scenes.size(); ++i) {
        const std::string_view has = content_of(scenes[i]), first_has = content_of(scenes[0]);
        if (has == first_has) continue;
        refuse(paths[i],
               fmt::format("has {}, but {} has {}; the files of one set must have the same", has, paths[0], first_has));
    }
}

template <typename Part>
void join_part(std::span<LoadedScene> scenes, std::optional<Part> LoadedScene::*part, LoadedScene& joined) {
    if (!(scenes.front().*part)) return;
    for (LoadedScene& scene : scenes) {
        if (joined.*part) {
            (joined.*part)->append(std::move(*(scene.*part)));
        } else {
            joined.*part = std::move(scene.*part);
        }
        (scene.*part).reset();
    }
}

/// Returns the axis that all scenes have in common; unknown if they differ. The unit is that of the first scene that has one.
SceneSpace joint_space(std::span<const LoadedScene> scenes) {
    SceneSpace space = scenes.front().space;
    for (const LoadedScene& scene : scenes) {
        if (scene.space.up != space.up) space.up = UpAxis::unknown;
        if (space.unit.empty()) space.unit = scene.space.unit;
    }
    return space;
}

template <typename Real>
std::optional<std::string> fault_of(const Box<Real>& box) {
    for (int axis = 0; axis < 3; ++axis) {
        const char name = "xyz"[axis];
        if (!std::isfinite(box.min[axis]))
            return fmt::format("min {} is {}, not a finite number", name, number_text(box.min[axis]));
        if (!std::isfinite(box.max[axis]))
            return fmt::format("max {} is {}, not a finite number", name, number_text(box.max[axis]));
        if (box.min[axis] > box.max[axis]) {
            return fmt::format("min {} {} is above max {} {}", name, number_text(box.min[axis]), name,
                               number_text(box.max[axis]));
        }
    }
    return std::nullopt;
}

/// Reads a JSON scene. The caller computes its boxes from the shapes.
LoadedScene read_shapes(const std::string& path, const SceneContent& content, const std::stop_token& stop) {
#ifdef OCTOPAIR_WITH_PIPELINE
    if (content.objects == MeshObjects::triangle) refuse(path, "the objects of a JSON scene are shapes, not triangles");
    return read_json_scene(path, stop);
#else
    (void)content, (void)stop;
    refuse(path, "this build of octopair cannot read JSON scenes: it was built without the pipeline");
#endif
}

LoadedScene read_known(const std::string& path, const SceneContent& content, const std::stop_token& stop) {
    switch (scene_format(path)) {
        case SceneFormat::npy:
            return read_npy_scene(path, stop);
        case SceneFormat::csv:
            return read_csv_scene(path, stop);
        case SceneFormat::json:
            return read_shapes(path, content, stop);
        case SceneFormat::mesh:
#ifdef OCTOPAIR_WITH_MESHES
            if (format_ending(path) == ".opmodel") return read_model_stream_file(path, content, stop);
            if (is_plain_ending(format_ending(path))) return read_plain_scene(path, content, stop);
            if (is_gltf_ending(format_ending(path))) {
                if (auto scene = read_gltf_scene(path, content, stop)) return std::move(*scene);
            }
            if (is_three_mf_ending(format_ending(path))) return read_three_mf_scene(path, content, stop);
            return read_mesh_scene(path, content);
#endif
        case SceneFormat::unknown:
            break;
    }
#ifdef OCTOPAIR_WITH_MESHES
    refuse(path, "unknown file type; the name must end in .npy, .csv, .json or the ending of a mesh file");
#else
    refuse(
        path,
        "unknown file type; the name must end in .npy, .csv or .json (this build of octopair cannot read mesh files)");
#endif
}

}  // namespace

LoadedScene read_scene(const std::string& path, const SceneContent& content, const std::stop_token& stop) {
    if (content.reader.command.empty()) check_readable(path);
#ifdef OCTOPAIR_WITH_MESHES
    if (auto arguments = reader_arguments(path, content)) {
        LoadedScene scene = read_by_program(path, std::move(*arguments), content, stop);
        std::string warning = content.reader.command.empty() ? name_warning(path) : std::string();
        if (!warning.empty()) scene.warnings.push_back(std::move(warning));
        return scene;
    }
#endif
    LoadedScene scene = read_known(path, content, stop);
    if (std::string warning = name_warning(path); !warning.empty()) scene.warnings.push_back(std::move(warning));
    return scene;
}

void check_frame_counts(std::span<const FrameCount> counts, std::span<const std::string> paths) {
    for (std::size_t i = 0; i < counts.size(); ++i) {
        if (counts[i] == counts[0]) continue;
        refuse(paths[i], fmt::format("has {} frames, but {} has {}; the files of one set must have the same number",
                                     counts[i].frames, paths[0], counts[0].frames));
    }
}

LoadedScene join_scenes(std::span<LoadedScene> scenes, std::span<const std::string> paths, bool wide) {
    const auto is_wide = [](const LoadedScene& scene) { return std::holds_alternative<Buffer<Box3d>>(scene.boxes); };
    const bool boxless =
        std::any_of(scenes.begin(), scenes.end(), [](const LoadedScene& scene) { return scene.lacks_boxes(); });
    if (scenes.size() == 1 && (boxless || is_wide(scenes.front()) >= wide)) return std::move(scenes.front());
    check_same_content(scenes, paths);
    LoadedScene joined;
    joined.moving = scenes.front().moving;
    for (const LoadedScene& scene : scenes) {
        joined.largest_rounded = std::max(joined.largest_rounded, scene.largest_rounded);
        joined.chord = std::max(joined.chord, scene.chord);
        joined.warnings.insert(joined.warnings.end(), scene.warnings.begin(), scene.warnings.end());
        joined.elements.add(scene.elements);
        joined.not_read.insert(joined.not_read.end(), scene.not_read.begin(), scene.not_read.end());
    }
    joined.space = joint_space(scenes);
    joined.frames = scenes.front().frames;
    bool named = false;
    std::vector<FrameCount> counts;
    for (const LoadedScene& scene : scenes) {
        counts.push_back({scene.frames, scene.moving});
        joined.objects += scene.objects;
        wide |= is_wide(scene);
        named |= !scene.names.empty();
    }
    check_frame_counts(counts, paths);
    std::size_t before = 0;
    for (const LoadedScene& scene : scenes) {
        append_details(joined.details, scene.details, {before, std::size_t(scene.objects)});
        append_relations(joined.relations, scene.relations, {before, std::size_t(scene.objects)});
        before += std::size_t(scene.objects);
    }
    if (named) {
        for (LoadedScene& scene : scenes) {
            scene.names.resize(std::size_t(scene.objects));
            std::move(scene.names.begin(), scene.names.end(), std::back_inserter(joined.names));
        }
    }
    join_part(scenes, &LoadedScene::shapes, joined);
    join_part(scenes, &LoadedScene::triangles, joined);
    if (boxless) return joined;
    if (wide) {
        joined.boxes = join_boxes<Box3d>(scenes, joined.objects);
    } else {
        joined.boxes = join_boxes<Box3f>(scenes, joined.objects);
    }
    return joined;
}

std::optional<NpyFrames> open_frames(const std::string& path) {
    if (!is_npy_file(path)) return std::nullopt;
    check_readable(path);
    return NpyFrames::open(path);
}

std::optional<InvalidBox> find_invalid_box(const Boxes& boxes) {
    return std::visit(
        [](auto span) -> std::optional<InvalidBox> {
            for (std::size_t i = 0; i < span.size(); ++i) {
                const auto what = fault_of(span[i]);
                if (what) return InvalidBox{0, i, *what};
            }
            return std::nullopt;
        },
        boxes);
}

std::optional<InvalidBox> find_invalid_box(const LoadedScene& scene) {
    for (std::uint64_t frame = 0; frame < scene.frames; ++frame) {
        const auto fault = find_invalid_box(scene.frame(frame).boxes);
        if (fault) return InvalidBox{frame, fault->object, fault->what};
    }
    return std::nullopt;
}

}  // namespace octopair::io
