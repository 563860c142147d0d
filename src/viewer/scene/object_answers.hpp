// Answers about single objects of a frame.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "octopair/octants.hpp"
#include "viewer/scene/frame_answers.hpp"

namespace octopair::viewer {

/// Returns what is known about an object; nothing if there is no such object. `octants` may be null.
std::optional<Answer> object_answer(const ShownFrame& frame, std::uint32_t object, const Octants* octants);
/// Returns the objects whose name or index has `text`, the best first.
Answer search_answer(const ShownFrame& frame, std::string_view text);

}  // namespace octopair::viewer
