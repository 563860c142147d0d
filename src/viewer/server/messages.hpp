// Messages to pages over the WebSocket (viewer/protocol.md), as JSON.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace octopair::viewer {

/// `done`: from 0 to 1.
std::string progress_message(std::string_view what, double done);
std::string ready_message();
std::string failed_message(std::string_view why);
/// The watched server does not answer, and is asked again.
std::string waiting_message(std::string_view why);
/// `done`: number of frames that timeline.json has.
std::string timeline_message(std::uint64_t done);
std::string closed_message();

}  // namespace octopair::viewer
