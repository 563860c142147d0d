// Reads a scene file in a child process.
//
// - Some importers of mesh files crash on invalid files. Then only the child crashes, and the caller gets an Error.
// - The caller can stop the child at any time.
// - The output of importers is discarded.
// - The child is a fork of this process. Requires: no other thread of this process runs.
//
// The child sends the loaded scene as bytes (scene_transfer.cpp):
//
//   trivially copyable values   the bytes in memory
//   vector, string, Buffer      length (uint64), then the elements
//   optional                    bool, then the value if there is one
//   variant                     index (uint64), then the value
//   other classes               the members, one after the other
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <stop_token>
#include <string>

#include "io/loaded_scene.hpp"
#include "io/scene_reader.hpp"

namespace octopair::cli {

/// Returns what io::read_scene() returns.
/// Throws: what io::read_scene() throws; Error{bad_input} if the child crashed; Error{resource_limit} if it was killed;
/// Error{cancelled} within 100 ms of a stop request.
io::LoadedScene read_isolated(const std::string& path, const io::SceneContent& content, const std::stop_token& stop);

/// Sends all bytes of the span, or throws.
using PutBytes = std::function<void(std::span<const std::byte>)>;
/// Fills the whole span with received bytes, or throws.
using GetBytes = std::function<void(std::span<std::byte>)>;

void send_scene(const io::LoadedScene& scene, const PutBytes& put);

/// Returns the received scene. Throws: what `get` throws; Error{engine_failed} for bytes that send_scene() did not make.
io::LoadedScene receive_scene(const GetBytes& get);

}  // namespace octopair::cli
