// Reads a scene file in a child process.
//
// - Some importers of mesh files crash on invalid files. Then only the child crashes, and the caller gets an Error.
// - The caller can stop the child at any time.
// - The output of importers is discarded.
// - The child is a fork of this process. Requires: no other thread of this process runs.
#pragma once

#include <stop_token>
#include <string>

#include "io/loaded_scene.hpp"
#include "io/scene_reader.hpp"

namespace octopair::cli {

/// Returns what io::read_scene() returns.
/// Throws: what io::read_scene() throws; Error{bad_input} if the child crashed; Error{resource_limit} if it was killed;
/// Error{cancelled} within 100 ms of a stop request.
io::LoadedScene read_isolated(const std::string& path, const io::SceneContent& content, const std::stop_token& stop);

}  // namespace octopair::cli
