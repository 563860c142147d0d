// The objects that the build of a 3MF file describes: its items, and the components that they consist of.
//
// - An object is a mesh in the world: an item with a mesh, or each mesh among the components of an item.
// - The order is that of the items, then of the components, in depth first.
// - A label is the name of an object; without one, the part number of the item or of the object.
// - A name is the path of the labels from the item on, joined by "/". With several items, it begins with ROOT. An object without a label
//   has "#" and its position. If siblings have the same label, "#" and the position follow it.
#pragma once

#include <string>
#include <vector>

#include "io/meshes/placed_meshes.hpp"
#include "io/meshes/three_mf/model.hpp"

namespace octopair::io::three_mf {

/// The objects of a build, and what a user should know about them, each one line "FILE: ...".
struct Build {
    PlacedMeshes placed;
    std::vector<std::string> warnings;
    std::vector<std::string> not_read;  ///< LoadedScene::not_read
};

/// Takes the meshes of the model. The labels stay in the model.
/// Throws: Error{bad_input} that names the part and the line, if the build has an object of type other, or one without a shape;
/// Error{resource_limit} for more than 2^24 objects; Error{cancelled}.
Build make_build(Model& model);

}  // namespace octopair::io::three_mf
