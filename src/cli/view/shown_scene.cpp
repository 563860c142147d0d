// An input set as a scene of the viewer.
#include <algorithm>
#include <cmath>

#include "cli/detect/filter_chain.hpp"
#include "cli/input/search_inputs.hpp"
#include "cli/view/view.hpp"
#ifdef OCTOPAIR_WITH_PIPELINE
#include "cli/input/shaped_set.hpp"
#include "viewer/scene/scene_contents.hpp"
#endif

namespace octopair::cli {

namespace {

std::vector<std::string> shown_names(const InputSet& set) {
    if (!set.scene.triangles) return set.scene.names;
    std::vector<std::string> names;
    for (const std::uint32_t owner : set.scene.triangles->owners) {
        names.push_back(set.scene.triangles->owner_names[owner]);
    }
    return names;
}

#ifdef OCTOPAIR_WITH_PIPELINE
void add_shapes(viewer::SceneContents& contents, const InputSet& set) {
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

}  // namespace

std::vector<std::pair<std::string, std::string>> shown_details(const InputSet& set, std::uint32_t object) {
    std::vector<std::pair<std::string, std::string>> details;
    const bool triangle = set.scene.triangles.has_value();
    const io::ObjectDetails& table = triangle ? set.scene.triangles->owner_details : set.scene.details;
    const std::uint32_t row = triangle ? set.scene.triangles->owners[object] : object;
    for (const io::Detail detail : io::all_details) {
        const std::string_view text = table.of(row, detail);
        if (!text.empty()) details.emplace_back(io::word_of(detail), text);
    }
    return details;
}

std::string axis_word(io::UpAxis up) {
    if (up == io::UpAxis::unknown) return {};
    return up == io::UpAxis::y ? "y" : "z";
}

viewer::SceneContents shown_scene(const DetectRequest& request, const InputSet& set) {
    viewer::SceneContents contents;
    contents.objects = set.scene.objects;
    contents.moving = set.scene.moving;
    const io::SceneSpace& chosen = request.pipeline.space;
    contents.up = axis_word(chosen.up != io::UpAxis::unknown ? chosen.up : set.scene.space.up);
    contents.unit = chosen.unit.empty() ? set.scene.space.unit : chosen.unit;
    contents.margin = request.margin;
    contents.names = shown_names(set);
    contents.notices = input_warnings(request, {set, nullptr});
#ifdef OCTOPAIR_WITH_PIPELINE
    add_shapes(contents, set);
#endif
    return contents;
}

}  // namespace octopair::cli
