// The user's browser: opens the page, or draws a picture of it.
#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "base/child_process.hpp"
#include "base/descriptor.hpp"
#include "base/stop.hpp"
#include "cli/view/view.hpp"
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

/// A browser without a window, controlled by the DevTools protocol over a pair of pipes. A message is JSON that ends with a zero byte. The
/// browser reads commands from descriptor 3, and writes answers to descriptor 4.
class BrowserPipe {
public:
    /// Starts a browser with these words of a command line, in a process group of its own.
    /// Throws: Error{io_failed}.
    BrowserPipe(std::vector<std::string> words, std::stop_token stop);
    BrowserPipe(const BrowserPipe&) = delete;
    BrowserPipe& operator=(const BrowserPipe&) = delete;
    /// Kills the browser and its processes.
    ~BrowserPipe();

    /// Sends a command, and returns the result of its answer. Commands go to `session`, or to the browser if it is empty.
    /// Throws: Error{io_failed} if the browser ends, refuses, or does not answer within 60 s; Error{cancelled} soon after a stop
    /// request.
    nlohmann::json call(const std::string& method, const nlohmann::json& parameters, const std::string& session = {});

private:
    void send(const std::string& message);
    std::string receive(std::chrono::steady_clock::time_point end);

    std::stop_token stop_;
    Descriptor to_, from_;
    pid_t browser_ = -1;
    unsigned calls_ = 0;
    std::string received_;  // bytes after the last whole message
};

constexpr auto answer_timeout = std::chrono::seconds(60);

[[noreturn]] void fail_browser(const std::string& what) { throw Error(ErrorCode::io_failed, "the browser " + what); }

/// Returns the ends of a pipe, reading end first.
std::pair<Descriptor, Descriptor> make_pipe() {
    std::array<int, 2> ends;
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) fail_browser("cannot be started: no pipe");
    return {Descriptor(ends[0]), Descriptor(ends[1])};
}

/// Starts a program with `commands` as descriptor 3 and `answers` as descriptor 4. Returns -1 if that fails.
pid_t start_browser(const std::vector<std::string>& words, const Descriptor& commands, const Descriptor& answers) {
    std::vector<char*> arguments;
    arguments.reserve(words.size() + 1);
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    const std::array<int, 2> descriptors = {commands.number(), answers.number()};
    return start_child({words.front(), arguments, descriptors});
}

BrowserPipe::BrowserPipe(std::vector<std::string> words, std::stop_token stop) : stop_(std::move(stop)) {
    words.emplace_back("--remote-debugging-pipe");
    auto [commands, to] = make_pipe();
    auto [from, answers] = make_pipe();
    browser_ = start_browser(words, commands, answers);
    if (browser_ < 0) fail_browser(words.front() + " cannot be started");
    to_ = std::move(to);
    from_ = std::move(from);
}

BrowserPipe::~BrowserPipe() {
    ::kill(-browser_, SIGKILL);
    ::waitpid(browser_, nullptr, 0);
}

void BrowserPipe::send(const std::string& message) {
    std::size_t sent = 0;
    const std::size_t size = message.size() + 1;  // with the zero byte
    while (sent < size) {
        const ssize_t count = ::write(to_.number(), message.c_str() + sent, size - sent);
        if (count < 0) fail_browser("ended");
        sent += std::size_t(count);
    }
}

std::string BrowserPipe::receive(std::chrono::steady_clock::time_point end) {
    for (;;) {
        if (const std::size_t zero = received_.find('\0'); zero != std::string::npos) {
            std::string message = received_.substr(0, zero);
            received_.erase(0, zero + 1);
            return message;
        }
        throw_if_stopped(stop_);
        if (std::chrono::steady_clock::now() > end) fail_browser("does not answer");
        pollfd readable{from_.number(), POLLIN, 0};
        if (::poll(&readable, 1, 50) <= 0) continue;
        std::array<char, 65536> bytes;
        const ssize_t count = ::read(from_.number(), bytes.data(), bytes.size());
        if (count <= 0) fail_browser("ended");
        received_.append(bytes.data(), std::size_t(count));
    }
}

nlohmann::json BrowserPipe::call(const std::string& method, const nlohmann::json& parameters,
                                 const std::string& session) {
    nlohmann::json command = {{"id", ++calls_}, {"method", method}, {"params", parameters}};
    if (!session.empty()) command["sessionId"] = session;
    send(command.dump());
    const auto end = std::chrono::steady_clock::now() + answer_timeout;
    for (;;) {
        const auto answer = nlohmann::json::parse(receive(end), nullptr, false);
        if (!answer.is_object() || answer.value("id", 0u) != calls_) continue;  // an event
        if (answer.contains("error")) fail_browser("refused " + method);
        return answer.value("result", nlohmann::json::object());
    }
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

/// Opens an address in the user's browser, if there is a display. Does not wait. Failures are ignored: the address is printed, too.
void open_browser(const std::string& address) {
    if (std::getenv("DISPLAY") == nullptr && std::getenv("WAYLAND_DISPLAY") == nullptr) return;
    const auto program = find_program({"xdg-open"});
    if (!program) return;
    const pid_t child = ::fork();
    if (child == 0) {
        // Fork a second time and end the first child. The second child then belongs to the init process, and this program need not wait
        // for the browser.
        sigset_t none;
        sigemptyset(&none);
        ::sigprocmask(SIG_SETMASK, &none, nullptr);
        if (::setsid() < 0 || ::fork() != 0) ::_exit(0);
        ::execl(program->c_str(), program->c_str(), address.c_str(), nullptr);
        ::_exit(1);
    }
    if (child > 0) ::waitpid(child, nullptr, 0);
}

}  // namespace

void present(const ViewRequest& request, const viewer::PageServer& server) {
    fmt::print("{}\n", server.address());
    std::fflush(stdout);
    if (!request.detect.quiet) fmt::print(stderr, "Open this address in a browser. Ctrl-C ends the viewer.\n");
    // The command line of a browser is visible to all users of the machine, so it must not have a token.
    if (!request.no_browser && request.listen.empty()) open_browser(server.address());
}

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

std::string take_screenshot(const std::string& page_path, const ProgressSink& progress, const std::stop_token& stop) {
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
    progress(0);
    BrowserPipe browser(std::move(words), stop);
    const auto target = browser.call("Target.createTarget", {{"url", "about:blank"}});
    const auto attached =
        browser.call("Target.attachToTarget", {{"targetId", target.value("targetId", "")}, {"flatten", true}});
    const std::string session = attached.value("sessionId", "");
    progress(0.25);  // the browser runs
    browser.call("Emulation.setDeviceMetricsOverride",
                 {{"width", width}, {"height", height}, {"deviceScaleFactor", 1}, {"mobile", false}}, session);
    browser.call("Page.navigate", {{"url", "file://" + page_path}}, session);
    progress(0.5);  // the page is loaded
    wait_for_picture(browser, session);
    progress(0.75);
    const auto picture = browser.call("Page.captureScreenshot", {{"format", "png"}}, session);
    progress(1);
    return decoded_base64(picture.value("data", ""));
}

}  // namespace octopair::cli
