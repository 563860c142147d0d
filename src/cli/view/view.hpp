// The parts of `octopair view`: options, the inputs that it can show, and the view of a server.
// Start here to add a new input of view.
#pragma once

#include <memory>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "cli/command/command.hpp"
#include "cli/command/progress_line.hpp"
#include "cli/detect/detection.hpp"
#include "cli/view/shown_scene.hpp"
#include "viewer/scene/scene_contents.hpp"
#include "viewer/server/page_server.hpp"

namespace octopair::cli {

/// Command line of `octopair view`. `detect` has the inputs of a scene and the options of the search.
struct ViewRequest {
    DetectRequest detect;
    std::string result;  ///< a result file, or empty
    std::string export_page, screenshot, listen;
    bool no_browser = false;
    unsigned port = 0;
    std::vector<std::string> search_options;  ///< names of the options of the search, without dashes
};

// view_options.cpp

void add_view_options(Command& command, ViewRequest& request);

/// Classifies each input: scene file, result file, or address of a server. Sets defaults.
/// Throws: Error{usage} for options that do not fit together; Error{io_failed} for an input that cannot be read.
void check_view_options(ViewRequest& request);

/// Returns where the page is served. With --listen, makes a random token.
/// Throws: Error{usage} for an invalid address.
viewer::PageServerOptions server_options(const ViewRequest& request);

/// An input in memory, ready to be shown.
struct LoadedView {
    viewer::SceneContents contents;
    std::unique_ptr<viewer::FrameFinder> finder;
};

// scene_input.cpp

/// Reads scene files. The page shows the pairs of the result, if given, or else the pairs that a search finds.
/// Requires: no other thread of this process runs (isolated_read.hpp).
/// Throws: what read_input_set() throws; Error{bad_input} for a result that does not fit the scene.
LoadedView load_scene(const ViewRequest& request, ProgressLine& progress, const std::stop_token& stop);

// result_input.cpp

/// Reads a result without its scene: objects are where their contacts are. Throws: what read_result() throws.
LoadedView load_result(const ViewRequest& request, const std::stop_token& stop);

// recording_input.cpp

/// Returns whether a file is the recording of a scene.
bool is_recording(const std::string& path);
/// Replays a recording. Keeps the steps in memory up to a limit. Beyond the limit, steps are left out, and a notice says so.
/// Throws: what replay() throws.
LoadedView load_recording(const ViewRequest& request, ProgressLine& progress, const std::stop_token& stop);

// browser.cpp

/// Prints the address of the page on standard output, and opens it in the user's browser unless --no-browser is given.
void present(const ViewRequest& request, const viewer::PageServer& server);

/// Returns the picture of a page (PNG, 1280 x 720), as a browser without a window draws it. The browser is Chromium or Chrome, or
/// the program that OCTOPAIR_BROWSER names. `progress` gets the part of the steps that are done.
/// Throws: Error{io_failed} if there is no such browser, or if it fails; Error{cancelled} soon after a stop request.
std::string take_screenshot(const std::string& page_path, const ProgressSink& progress, const std::stop_token& stop);

/// A folder in the system's folder for temporary files, which is removed in the end.
class TemporaryFolder {
public:
    /// Throws: Error{io_failed}.
    TemporaryFolder();
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    ~TemporaryFolder();

    const std::string& path() const { return path_; }

private:
    std::string path_;
};

// server_view.cpp

/// Serves a page with the jobs and the scenes of a server (`octopair serve`) until a stop request.
/// Throws: Error{engine_failed} if the server cannot be reached.
void view_server(const ViewRequest& request, const std::stop_token& stop);

}  // namespace octopair::cli
