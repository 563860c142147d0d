#include "cli/view/browser.hpp"

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>
#include <vector>

#include "cli/view/browser_pipe.hpp"
#include "octopair/error.hpp"

namespace octopair::cli {

namespace {

using namespace std::chrono_literals;

[[noreturn]] void fail_io(const std::string& what) { throw Error(ErrorCode::io_failed, what); }

/// Returns the path of the first of some programs that is in PATH.
std::optional<std::string> find_program(const std::vector<std::string>& names) {
    const char* const path = std::getenv("PATH");
    for (const std::string& name : names) {
        if (name.find('/') != std::string::npos && ::access(name.c_str(), X_OK) == 0) return name;
        std::string_view folders = path == nullptr ? "" : path;
        while (!folders.empty()) {
            const std::size_t end = std::min(folders.find(':'), folders.size());
            const std::string candidate = std::string(folders.substr(0, end)) + '/' + name;
            if (::access(candidate.c_str(), X_OK) == 0) return candidate;
            folders.remove_prefix(std::min(end + 1, folders.size()));
        }
    }
    return std::nullopt;
}

std::string find_browser() {
    const char* const chosen = std::getenv("OCTOPAIR_BROWSER");
    if (chosen != nullptr && *chosen != '\0') {
        if (const auto found = find_program({chosen})) return *found;
        fail_io(std::string("OCTOPAIR_BROWSER: there is no program ") + chosen);
    }
    const auto found = find_program({"chromium", "chromium-browser", "google-chrome", "google-chrome-stable"});
    if (!found) {
        fail_io(
            "--screenshot needs Chromium or Chrome: install the package chromium, or set OCTOPAIR_BROWSER to the "
            "program");
    }
    return *found;
}

std::string decoded_base64(std::string_view text) {
    constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string bytes;
    std::uint32_t word = 0;
    unsigned bits = 0;
    for (const char c : text) {
        const std::size_t digit = digits.find(c);
        if (digit == std::string_view::npos) break;
        word = word << 6 | std::uint32_t(digit);
        bits += 6;
        if (bits >= 8) bytes += char(word >> (bits -= 8));
    }
    return bytes;
}

/// Waits until the page says that it has drawn all its data.
void wait_for_picture(BrowserPipe& browser, const std::string& session) {
    const auto end = std::chrono::steady_clock::now() + 60s;
    const nlohmann::json ready = {{"expression", "document.documentElement.dataset.complete === 'true'"}};
    while (!browser.call("Runtime.evaluate", ready, session)["result"].value("value", false)) {
        if (std::chrono::steady_clock::now() > end) fail_io("the browser did not draw the page");
        std::this_thread::sleep_for(100ms);
    }
}

}  // namespace

TemporaryFolder::TemporaryFolder() {
    std::error_code error;
    const std::filesystem::path folder = std::filesystem::temp_directory_path(error);
    if (error) fail_io("the folder for temporary files (TMPDIR): " + error.message());
    path_ = (folder / "octopair-view-XXXXXX").string();
    if (::mkdtemp(path_.data()) == nullptr) fail_io("cannot make a folder for temporary files: " + path_);
}

TemporaryFolder::~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
}

void open_browser(const std::string& address) {
    if (std::getenv("DISPLAY") == nullptr && std::getenv("WAYLAND_DISPLAY") == nullptr) return;
    const auto program = find_program({"xdg-open"});
    if (!program) return;
    const pid_t child = ::fork();
    if (child == 0) {
        // The system is the parent of this second child, so this program need not wait for it.
        sigset_t none;
        sigemptyset(&none);
        ::sigprocmask(SIG_SETMASK, &none, nullptr);
        if (::setsid() < 0 || ::fork() != 0) ::_exit(0);
        ::execl(program->c_str(), program->c_str(), address.c_str(), nullptr);
        ::_exit(1);
    }
    if (child > 0) ::waitpid(child, nullptr, 0);
}

std::string take_screenshot(const std::string& page_path, const std::stop_token& stop) {
    const TemporaryFolder folder;
    constexpr int width = 1280, height = 720;
    std::vector<std::string> words = {
        find_browser(),
        "--headless=new",
        "--no-first-run",
        "--disable-extensions",
        "--disable-background-networking",
        "--user-data-dir=" + folder.path(),
        "--hide-scrollbars",
        "--enable-unsafe-swiftshader"};                        // draws by processor where there is no graphics card
    if (::geteuid() == 0) words.emplace_back("--no-sandbox");  // Chromium refuses to run as root with its sandbox
    BrowserPipe browser(std::move(words), stop);
    const auto target = browser.call("Target.createTarget", {{"url", "about:blank"}});
    const auto attached =
        browser.call("Target.attachToTarget", {{"targetId", target.value("targetId", "")}, {"flatten", true}});
    const std::string session = attached.value("sessionId", "");
    browser.call("Emulation.setDeviceMetricsOverride",
                 {{"width", width}, {"height", height}, {"deviceScaleFactor", 1}, {"mobile", false}}, session);
    browser.call("Page.navigate", {{"url", "file://" + page_path}}, session);
    wait_for_picture(browser, session);
    const auto picture = browser.call("Page.captureScreenshot", {{"format", "png"}}, session);
    return decoded_base64(picture.value("data", ""));
}

}  // namespace octopair::cli
