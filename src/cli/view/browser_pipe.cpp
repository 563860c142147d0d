#include "cli/view/browser_pipe.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <utility>

#include "base/child_process.hpp"
#include "base/stop.hpp"
#include "octopair/error.hpp"

namespace octopair::cli {

namespace {

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

}  // namespace

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

}  // namespace octopair::cli
