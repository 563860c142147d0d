// Runs the user's browser.
#pragma once

#include <stop_token>
#include <string>

namespace octopair::cli {

/// Opens an address in the user's browser, if there is a display. Does not wait. Failures are ignored: the address is printed, too.
void open_browser(const std::string& address);

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
