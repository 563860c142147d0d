// Reading a scene file in a child process.
//
// The importers behind mesh files were written for friendly files: some crash on others. What crashes here is the child,
// and the caller gets an Error. It can also be stopped at any time, and what an importer prints goes nowhere.
//
// Not for a process whose other threads are at work: the child is a fork of this one.
#pragma once

#include <stop_token>
#include <string>

#include "io/loaded_scene.hpp"
#include "io/scene_reader.hpp"

namespace octopair::cli {

/// What io::read_scene gives or throws; also Error{bad_input} if the child crashed, Error{resource_limit} if it was
/// killed, Error{cancelled} within 100 ms of a stop request.
io::LoadedScene read_isolated(const std::string& path, const io::SceneContent& content, const std::stop_token& stop);

}  // namespace octopair::cli
