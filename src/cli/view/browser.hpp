// The user's browser: opens the page, or draws a picture of it.
#pragma once

#include <stop_token>
#include <string>

#include "cli/view/view.hpp"
#include "viewer/server/page_server.hpp"

namespace octopair::cli {

/// Prints the address of the page on standard output, and opens it in the user's browser unless --no-browser is given.
void present(const ViewRequest& request, const viewer::PageServer& server);

/// Returns the picture of a page (PNG, 1280 x 720), as a browser without a window draws it. The browser is Chromium or Chrome, or
/// the program that OCTOPAIR_BROWSER names.
/// Throws: Error{io_failed} if there is no such browser, or if it fails; Error{cancelled} soon after a stop request.
std::string take_screenshot(const std::string& page_path, const std::stop_token& stop);

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

}  // namespace octopair::cli
