// An input set as a scene of the viewer.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "cli/detect/detection.hpp"
#include "cli/input/input_set.hpp"
#include "viewer/scene/scene_contents.hpp"

namespace octopair::cli {

/// Returns the axis as pages get it: "y", "z" or empty.
std::string axis_word(io::UpAxis up);

/// Returns names, groups, shapes, axes and warnings of a set. The members `title` and `details` stay empty.
viewer::SceneContents shown_scene(const DetectRequest& request, const InputSet& set);

/// Returns the details of an object that the files give, such as {"type", "IfcBeam"}.
std::vector<std::pair<std::string, std::string>> shown_details(const InputSet& set, std::uint32_t object);

}  // namespace octopair::cli
