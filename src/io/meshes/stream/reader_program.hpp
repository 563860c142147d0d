// Runs a program that reads a file and writes a model stream (docs/formats.md#model-streams).
// Start here to change a reader that needs a large library.
//
// - The program is a process of its own. If it crashes, hangs or fills the memory, the caller gets an Error, and the process is gone.
// - Programs: octopair-ifc reads IFC, octopair-step reads STEP and IGES. They are optional.
#pragma once

#include <optional>
#include <stop_token>
#include <string>
#include <string_view>

#include "io/loaded_scene.hpp"
#include "io/scene_reader.hpp"

namespace octopair::io {

/// Name of the program that reads files with an ending, for example "octopair-ifc"; empty if none does.
std::string_view reader_program_of(std::string_view ending);

/// Returns the path of a program: beside the program that runs, in ../lib/octopair from there, or in PATH. Returns nothing if it is not there.
std::optional<std::string> find_reader_program(std::string_view name);

/// Returns the arguments that read `path`; nothing if neither a command nor an installed program reads it.
std::optional<std::vector<std::string>> reader_arguments(const std::string& path, const SceneContent& content);

/// Runs the program with its arguments, the last of which is the file, and reads what it writes. Thread safety: any thread may call it.
/// Throws: what read_model_stream() throws; Error{bad_input} if the program fails or crashes, with the element in hand if it is known;
/// Error{resource_limit} if it needs too much memory, or writes nothing for too long; Error{cancelled} within 100 ms of a stop request.
LoadedScene read_by_program(const std::string& path, std::vector<std::string> arguments, const SceneContent& content,
                            const std::stop_token& stop);

}  // namespace octopair::io
