// Reads model streams: what programs that read other formats write (docs/formats.md#model-streams).
#pragma once

#include <string>

#include "io/loaded_scene.hpp"
#include "io/meshes/read_budget.hpp"
#include "io/meshes/stream/byte_source.hpp"
#include "io/scene_reader.hpp"

namespace octopair::io {

/// The element that the writer of a stream works on, for messages; empty if it has not said.
using ElementInHand = std::string;

/// Reads a stream to its end. Keeps `in_hand` up to date.
/// Throws: Error{bad_input} for a stream that is damaged, ends early or says that the file cannot be read; Error{resource_limit, cancelled};
/// what the source throws.
LoadedScene read_model_stream(const ByteSource& source, const SceneContent& content, ReadBudget& budget,
                              ElementInHand& in_hand);

/// Reads a file with a model stream. Throws: as read_model_stream(); Error{io_failed}.
LoadedScene read_model_stream_file(const std::string& path, const SceneContent& content, const std::stop_token& stop);

}  // namespace octopair::io
