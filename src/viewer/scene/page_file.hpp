// PageFile: an exported page, one self-contained file with the data of a scene.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "viewer/scene/frame_source.hpp"

namespace octopair::viewer {

/// Largest exported page, in bytes. Frames that do not fit are left out, and the page says so.
inline constexpr std::uint64_t max_page_bytes = std::uint64_t(64) << 20;

/// How a page is written.
struct PageOptions {
    std::uint64_t max_bytes = max_page_bytes;
    bool octants = true;  ///< false: leave out the octree, which a report does not need
};

/// Writes the page with the data of a loaded source. Frames are counted (FrameSource::count_frames) before. Returns the number of
/// frames in the page, which are the first ones of the source. `progress` may be empty.
/// Throws: Error{resource_limit} if the first frame alone exceeds `options.max_bytes`; what `write`, `progress` and the source throw.
std::uint64_t write_page(FrameSource& source, const std::function<void(std::string_view)>& write,
                         const PageOptions& options = {}, const ProgressSink& progress = {});

}  // namespace octopair::viewer
