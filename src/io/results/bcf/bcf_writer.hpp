// Writes collisions as a BCF 2.1 file (buildingSMART BIM Collaboration Format), a ZIP archive:
//
//   bcf.version              the version
//   GUID/markup.bcf          a topic: title, description, status and comments
//   GUID/viewpoint.bcfv      its viewpoint: both elements, and a camera that looks at the contact
//
// Equal results give equal bytes: the file has no clock, and GUIDs are hashes of keys. Rows are kept in memory until finish().
#pragma once

#include <memory>
#include <string>

#include "io/results/bcf/bcf_topics.hpp"
#include "io/results/collision_writer.hpp"

namespace octopair::io {

/// Names and boxes of the scene are borrowed. Requires: the objects are not triangles. Throws: Error{io_failed}.
std::unique_ptr<CollisionWriter> make_bcf_writer(const std::string& path, const BcfScene& scene);

}  // namespace octopair::io
