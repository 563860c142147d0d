// A loaded scene as bytes, from one process of this program to another on the same machine.
//
// Numbers go as they lie in memory; what has a length goes as its length (uint64) and its elements, an optional as a bool
// and its value, a variant as its index (uint64) and its value, the rest member by member.
#pragma once

#include <cstddef>
#include <functional>
#include <span>

#include "io/loaded_scene.hpp"

namespace octopair::cli {

/// Takes all the bytes, or throws.
using PutBytes = std::function<void(std::span<const std::byte>)>;
/// Fills all the bytes, or throws.
using GetBytes = std::function<void(std::span<std::byte>)>;

void send_scene(const io::LoadedScene& scene, const PutBytes& put);

/// Throws what `get` throws, and Error{engine_failed} for bytes that send_scene does not make.
io::LoadedScene receive_scene(const GetBytes& get);

}  // namespace octopair::cli
