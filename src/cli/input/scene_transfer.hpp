// Sends a loaded scene as bytes from one process of this program to another on the same machine.
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

#include "io/loaded_scene.hpp"

namespace octopair::cli {

/// Sends all bytes of the span, or throws.
using PutBytes = std::function<void(std::span<const std::byte>)>;
/// Fills the whole span with received bytes, or throws.
using GetBytes = std::function<void(std::span<std::byte>)>;

void send_scene(const io::LoadedScene& scene, const PutBytes& put);

/// Returns the received scene. Throws: what `get` throws; Error{engine_failed} for bytes that send_scene() did not make.
io::LoadedScene receive_scene(const GetBytes& get);

}  // namespace octopair::cli
