// Seeded scenes, byte for byte the same on every machine and compiler.
//
// World     the unit cube, unless a kind says otherwise (docs/scenes.md has the table: what each kind stresses, its
// pairs). Sameness  the numbers come from integers by IEEE addition, multiplication, division and square root alone: no
// function
//           of the mathematical library, no contraction. Object i of a static kind depends on (kind, objects, seed, i).
// Memory    a batch; `brownian` with several frames also keeps its positions, 24 bytes an object.
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
    std::uint64_t frames = 1;  ///< at least 1; more only for a kind that moves
};

using SceneSink = std::function<void(std::span<const Box3f>)>;

/// The names of all kinds, in the order of docs/scenes.md.
std::vector<std::string_view> scene_kinds();
/// One line on `kind`, without a full stop. Throws Error{usage} for an unknown kind.
std::string_view scene_description(std::string_view kind);
/// True if `kind` may have several frames. Throws Error{usage} for an unknown kind.
bool scene_moves(std::string_view kind);

/// Hands the boxes to `sink` in batches, frame after frame; no batch spans two frames, and a scene without objects has
/// none. Throws Error{usage} for an unknown kind or a count out of range, before the first batch.
void generate_scene(const SceneSpec& spec, const SceneSink& sink);
/// One frame as a whole. Throws as generate_scene does.
std::vector<Box3f> make_scene(std::string_view kind, std::uint64_t objects, std::uint64_t seed);

}  // namespace octopair::samples
