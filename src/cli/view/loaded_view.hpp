// LoadedView: an input of `octopair view` in memory, ready to be shown.
#pragma once

#include <memory>
#include <stop_token>
#include <string>

#include "cli/command/progress_line.hpp"
#include "cli/detect/detection.hpp"
#include "viewer/scene/scene_contents.hpp"

namespace octopair::cli {

struct LoadedView {
    viewer::SceneContents contents;
    std::unique_ptr<viewer::FrameFinder> finder;
};

/// Command line of `octopair view`. `detect` has the inputs of a scene and the options of the search.
struct ViewRequest {
    DetectRequest detect;
    std::string result;  ///< a result file, or empty
    std::string export_page, screenshot, listen;
    bool no_browser = false;
    unsigned port = 0;
};

/// Reads scene files. With a result, its pairs are shown, else those that a search finds.
/// Requires: no other thread of this process runs (isolated_read.hpp).
/// Throws: what read_input_set() throws; Error{bad_input} for a result that does not fit the scene.
LoadedView load_scene(const ViewRequest& request, ProgressLine& progress, const std::stop_token& stop);

/// Reads a result without its scene: objects are where their contacts are. Throws: what read_result() throws.
LoadedView load_result(const ViewRequest& request, const std::stop_token& stop);

/// Returns whether a file is the recording of a scene.
bool is_recording(const std::string& path);
/// Replays a recording. Keeps the steps in memory, and stops at a limit, which a notice tells.
/// Throws: what replay() throws.
LoadedView load_recording(const ViewRequest& request, ProgressLine& progress, const std::stop_token& stop);

}  // namespace octopair::cli
