// Sample scenes from a seed, with the same bytes on every machine and compiler.
//
// World     The unit cube, unless a kind says otherwise. docs/scenes.md has a table of all kinds: their purpose and number of
//           pairs.
// Sameness  The numbers come from integers by IEEE addition, multiplication, division and square root only: no functions of the
//           mathematical library, no contraction. Object i of a static kind depends only on (kind, objects, seed, i).
// Memory    One batch of boxes. A `brownian` scene with several frames also stores positions, 24 bytes per object.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "octopair/objects.hpp"

namespace octopair::samples {

struct SceneSpec {
    std::string kind;           ///< one of scene_kinds()
    std::uint64_t objects = 0;  ///< at most 2^32 - 1
    std::uint64_t seed = 0;
    std::uint64_t frames = 1;  ///< number of time steps, >= 1; above 1 only for a kind that moves
};

/// Receives the boxes of a scene in batches. The span is valid only during the call.
using SceneSink = std::function<void(std::span<const Box3f>)>;

/// Returns the names of all kinds, in the order of docs/scenes.md.
std::vector<std::string_view> scene_kinds();
/// Returns a description of `kind`: one line without a full stop. Throws: Error{usage} for an unknown kind.
std::string_view scene_description(std::string_view kind);

/// Passes the boxes to `sink` in batches, frame after frame. A batch has boxes of one frame and is not empty.
/// Throws: Error{usage} for an unknown kind or a number out of range, before the first batch.
void generate_scene(const SceneSpec& spec, const SceneSink& sink);
/// Returns all boxes of a scene of one frame. Throws: as generate_scene().
std::vector<Box3f> make_scene(std::string_view kind, std::uint64_t objects, std::uint64_t seed);

}  // namespace octopair::samples
