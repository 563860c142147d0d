#include "cli/view/browser.hpp"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <thread>
#include <vector>

#include "base/stop.hpp"
#include "octopair/error.hpp"

extern char** environ;

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

/// Starts a program in a process group of its own, without input and output. Signals are as in a new shell.
pid_t start(const std::vector<std::string>& words) {
    std::vector<char*> arguments;
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    for (const int descriptor : {0, 1, 2}) posix_spawn_file_actions_addopen(&files, descriptor, "/dev/null", O_RDWR, 0);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    sigset_t none;
    sigemptyset(&none);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setpgroup(&attributes, 0);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETPGROUP);
    pid_t child = -1;
    const int error = ::posix_spawn(&child, words.front().c_str(), &files, &attributes, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&files);
    posix_spawnattr_destroy(&attributes);
    return error == 0 ? child : -1;
}

/// Waits for a process. Kills its group after `most`, and after a stop request. Returns whether it ended by itself, with status 0.
bool wait_for(pid_t child, std::chrono::seconds most, const std::stop_token& stop) {
    const auto end = std::chrono::steady_clock::now() + most;
    for (;;) {
        int status = 0;
        if (::waitpid(child, &status, WNOHANG) == child) return WIFEXITED(status) && WEXITSTATUS(status) == 0;
        if (stop.stop_requested() || std::chrono::steady_clock::now() > end) {
            ::kill(-child, SIGKILL);
            ::waitpid(child, &status, 0);
            throw_if_stopped(stop);
            return false;
        }
        std::this_thread::sleep_for(20ms);
    }
}

}  // namespace

TemporaryFolder::TemporaryFolder() {
    std::error_code error;
    path_ = (std::filesystem::temp_directory_path(error) / "octopair-view-XXXXXX").string();
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
    const pid_t child = start({*program, address});
    if (child > 0) std::thread([child] { ::waitpid(child, nullptr, 0); }).detach();
}

std::string take_screenshot(const std::string& page_path, const std::stop_token& stop) {
    const TemporaryFolder folder;
    const std::string picture = folder.path() + "/picture.png";
    std::vector<std::string> words = {find_browser(),
                                      "--headless=new",
                                      "--no-first-run",
                                      "--disable-extensions",
                                      "--disable-background-networking",
                                      "--user-data-dir=" + folder.path() + "/profile",
                                      "--hide-scrollbars",
                                      "--window-size=1280,720",
                                      "--enable-unsafe-swiftshader",
                                      "--virtual-time-budget=20000",
                                      "--screenshot=" + picture,
                                      "file://" + page_path};
    if (::geteuid() == 0)
        words.insert(words.begin() + 1, "--no-sandbox");  // Chromium refuses to run as root with its sandbox
    const pid_t child = start(words);
    const bool ended = child > 0 && wait_for(child, 120s, stop);
    std::ifstream file(picture, std::ios::binary);
    std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    if (!ended || bytes.empty()) fail_io("the browser " + words.front() + " did not draw the page");
    return bytes;
}

}  // namespace octopair::cli
