// View: shows a running scene in a browser, step by step.
//
// Page      A server in this process serves the page at address(). The page shows boxes, pairs, events, octants and times of steps.
// Pace      The scene never waits for a page. show() copies the boxes at most ViewOptions::frames_per_second times a second. Copying
//           takes at most a hundredth of the time. So the last steps before a pause may be missing on pages, unless show() is told
//           to copy at once. Pages that read slowly, or not at all, get fewer frames.
//           The threads of the server have a low priority. Without a page, a call of show() takes well under a microsecond,
//           except once a second.
// Large     If the scene has more than 200,000 objects, the page draws those with the lowest indices. The page says so.
// Access    The server listens on this machine only, and answers only its own page, opened by this user or root. With another
//           `host` it requires a token.
// Ownership Borrows the scene, which must outlive the view and must not be moved.
// Errors    octopair::Error{usage} for invalid options; {io_failed} if the server cannot listen.
// Threads   Calls of show() and of the scene: one thread at a time. address() and pages(): any thread.
// CMake     Link octopair::viewer.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "octopair/scene.hpp"

namespace [[gnu::visibility("default")]] octopair {

struct ViewOptions {
    std::string title = "scene";          ///< title of the page
    std::vector<std::string> names = {};  ///< empty, or names of the objects by index
    std::string up = "z";                 ///< axis that points up: "y" or "z"
    std::string unit = {};                ///< unit of length, for example "m"; empty: none
    double margin = 0;                    ///< margin of the scene, needed to list its octants
    std::string host = "127.0.0.1";       ///< numeric address to listen on
    std::uint16_t port = 0;               ///< 0: any free port
    std::string token = {};         ///< required for a `host` that other machines reach; at least 16 letters and digits
    double frames_per_second = 30;  ///< maximum number of frames that are copied per second; 0.001 to 1000
};

class View {
public:
    /// Starts to serve.
    explicit View(Scene& scene, const ViewOptions& options = {});
    View(const View&) = delete;
    View& operator=(const View&) = delete;
    /// Ends the server. Pages keep their last frame.
    ~View();

    /// Returns the address for a browser, for example "http://127.0.0.1:40123/".
    std::string address() const;
    /// Shows the scene after a step. `step`: the result of this step. Call it after each step, because it counts the events.
    /// `at_once`: copies the scene now, whatever the pace is, and waits for an earlier copy. For the last step before a pause.
    /// Throws: std::bad_alloc.
    void show(const StepResult& step, bool at_once = false);
    /// Returns the number of pages that are connected.
    unsigned pages() const;

private:
    class [[gnu::visibility("hidden")]] State;
    std::unique_ptr<State> state_;
};

}  // namespace octopair
