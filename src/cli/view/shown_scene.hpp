// The input sets of a search as a scene of the viewer: for `octopair view`, and for the report of `octopair detect`.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "cli/detect/detection.hpp"
#include "cli/input/input_set.hpp"
#include "viewer/scene/scene_contents.hpp"

namespace octopair::cli {

/// Returns the word for the axis up in messages to pages: "y", "z", or empty if unknown.
std::string axis_word(io::UpAxis up);

/// Returns the scene of one set, or of the two sets of a join: title, names, details, shapes, axes, warnings, and facts about the search. In a
/// join, the objects of the second set have the numbers after those of the first. Axes and the unit are those of --up and --unit, else those
/// of the files, if all files have the same.
viewer::SceneContents shown_scene(const DetectRequest& request, const SetPair& sets);

/// Sets the boxes of a frame of the scene. In a join, copies them.
void show_boxes(viewer::FrameData& data, const SetPair& sets, std::uint64_t frame);

/// Returns the number by which the objects of the second set of a join are greater in the scene; 0 for one set.
inline std::uint32_t second_offset(const SetPair& sets) {
    return std::uint32_t(sets.second == nullptr ? 0 : sets.first.scene.objects);
}

}  // namespace octopair::cli
