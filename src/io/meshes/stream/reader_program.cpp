#include "io/meshes/stream/reader_program.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <vector>

#include <fmt/format.h>

#include "base/child_process.hpp"
#include "base/descriptor.hpp"
#include "io/files/failure.hpp"
#include "io/files/input_file.hpp"
#include "io/formats/unit_change.hpp"
#include "io/meshes/stream/model_stream.hpp"

namespace octopair::io {

namespace {

using Clock = std::chrono::steady_clock;
namespace fs = std::filesystem;

/// Returns the pages of memory that a process has, and all processes that it started.
std::uint64_t resident_pages(pid_t id) {
    std::uint64_t all = 0, resident = 0;
    std::ifstream memory(fmt::format("/proc/{}/statm", id));
    if (!(memory >> all >> resident)) return 0;
    std::ifstream children(fmt::format("/proc/{0}/task/{0}/children", id));
    for (pid_t child = 0; children >> child;) resident += resident_pages(child);
    return resident;
}

/// A process that runs a reader, and the reading end of its standard output. The destructor kills the process and waits for it.
class ReaderProcess {
public:
    ReaderProcess(const std::string& path, std::vector<std::string>& arguments, const ReadBudget& budget,
                  const ReaderChoice& choice)
        : path_(path),
          program_(fs::path(arguments.front()).filename().string()),
          budget_(budget),
          memory_(choice.memory.value_or(budget.limit())),
          patience_(choice.patience) {
        int ends[2];
        if (::pipe2(ends, O_CLOEXEC) != 0) fail_io(path, "cannot make a pipe", errno);
        pipe_ = Descriptor(ends[0]);
        const Descriptor writing(ends[1]);
        errors_ = Descriptor(::memfd_create("octopair-reader-errors", MFD_CLOEXEC));
        std::vector<char*> words;
        words.reserve(arguments.size() + 1);
        for (std::string& argument : arguments) words.push_back(argument.data());
        words.push_back(nullptr);
        id_ = start_child({.path = arguments.front(),
                           .arguments = words,
                           .descriptors = {},
                           .output = writing.number(),
                           .errors = errors_.number()});
        if (id_ < 0) fail_io(path, "cannot start " + program_, errno);
    }
    ReaderProcess(const ReaderProcess&) = delete;
    ReaderProcess& operator=(const ReaderProcess&) = delete;
    ~ReaderProcess() {
        if (id_ > 0) end();
    }

    /// Reads at least one byte; returns 0 at the end of the output.
    std::size_t read(std::span<std::byte> bytes) {
        const Clock::time_point start = Clock::now();
        for (;;) {
            budget_.checkpoint();
            if (Clock::now() - checked_ > std::chrono::milliseconds(100)) check_memory();
            pollfd waiting{pipe_.number(), POLLIN, 0};
            if (::poll(&waiting, 1, 100) > 0) {
                const ssize_t got = ::read(pipe_.number(), bytes.data(), bytes.size());
                if (got >= 0) return std::size_t(got);
                if (errno != EINTR) fail_io(path_, "cannot read what " + program_ + " writes", errno);
            }
            check_patience(start);
        }
    }

    /// Waits for the end of the process. Returns why it failed; empty if it ended with status 0.
    std::string failure() {
        const Clock::time_point start = Clock::now();
        int status = 0;
        for (;;) {
            siginfo_t ended{};
            const int result = ::waitid(P_PID, id_t(id_), &ended, WEXITED | WNOHANG | WNOWAIT);
            if (result == 0 && ended.si_pid != 0) break;
            budget_.checkpoint();
            check_patience(start);
            (void)::poll(nullptr, 0, 10);
        }
        ::kill(-id_, SIGKILL);  // what it may have left behind
        while (::waitpid(id_, &status, 0) < 0 && errno == EINTR) {
        }
        id_ = 0;
        if (WIFSIGNALED(status))
            return fmt::format("{} ended with the signal {}", program_, ::strsignal(WTERMSIG(status)));
        if (WEXITSTATUS(status) == 0) return {};
        std::string words = fmt::format("{} failed with the status {}", program_, WEXITSTATUS(status));
        if (const std::string last = last_error(); !last.empty()) words += fmt::format(" ({})", last);
        return words;
    }

private:
    /// Throws: Error{resource_limit} if the process has more memory than a reader of octopair may have.
    void check_memory() {
        checked_ = Clock::now();
        constexpr off_t most_errors = 16 << 20;
        if (::lseek(errors_.number(), 0, SEEK_END) > most_errors) {
            throw Error(ErrorCode::resource_limit, fmt::format("{}: {} writes endless messages", path_, program_));
        }
        if (resident_pages(id_) <= memory_ / std::uint64_t(::sysconf(_SC_PAGESIZE))) return;
        throw Error(ErrorCode::resource_limit,
                    fmt::format("{}: {} needs more than {} bytes of memory, the limit for a file of its size", path_,
                                program_, memory_));
    }

    /// Returns the last line that the process wrote to its standard error.
    std::string last_error() const {
        std::array<char, 4096> end{};
        const off_t size = ::lseek(errors_.number(), 0, SEEK_END);
        const ssize_t got =
            ::pread(errors_.number(), end.data(), end.size(), std::max<off_t>(0, size - off_t(end.size())));
        std::string text(end.data(), std::size_t(std::max<ssize_t>(got, 0)));
        text.erase(text.find_last_not_of("\n\r ") + 1);
        text.erase(0, text.rfind('\n') + 1);
        std::replace_if(
            text.begin(), text.end(), [](char c) { return c >= 0 && c < ' '; }, ' ');
        return text.substr(0, 400);
    }

    void check_patience(Clock::time_point start) const {
        if (Clock::now() - start <= patience_) return;
        throw Error(ErrorCode::resource_limit,
                    fmt::format("{}: {} has written nothing for {} seconds", path_, program_, patience_.count()));
    }

    void end() const {
        ::kill(-id_, SIGKILL);  // its whole group
        while (::waitpid(id_, nullptr, 0) < 0 && errno == EINTR) {
        }
    }

    std::string path_, program_;
    const ReadBudget& budget_;
    std::uint64_t memory_;  // the most bytes that the process and those that it started may have
    std::chrono::seconds patience_;
    Descriptor pipe_, errors_;
    Clock::time_point checked_ = Clock::now();
    pid_t id_ = 0;
};

bool is_program(const fs::path& path) {
    std::error_code error;
    return fs::is_regular_file(path, error) && ::access(path.c_str(), X_OK) == 0;
}

}  // namespace

std::string_view reader_program_of(std::string_view ending) {
    if (ending == ".ifc" || ending == ".ifczip") return "octopair-ifc";
    for (const std::string_view step : {".step", ".stp", ".p21", ".iges", ".igs"}) {
        if (ending == step) return "octopair-step";
    }
    return {};
}

std::optional<std::string> find_reader_program(std::string_view name) {
    std::vector<fs::path> folders;
    std::error_code error;
    if (const fs::path own = fs::read_symlink("/proc/self/exe", error); !error) {
        folders.push_back(own.parent_path());
        folders.push_back(own.parent_path().parent_path() / "lib" / "octopair");
    }
    std::string_view rest = std::getenv("PATH") != nullptr ? std::getenv("PATH") : "";
    while (!rest.empty()) {
        const std::size_t end = std::min(rest.find(':'), rest.size());
        if (end > 0) folders.emplace_back(rest.substr(0, end));
        rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    for (const fs::path& folder : folders) {
        if (is_program(folder / name)) return (folder / name).string();
    }
    return std::nullopt;
}

std::optional<std::vector<std::string>> reader_arguments(const std::string& path, const SceneContent& content) {
    const ReaderChoice& choice = content.reader;
    // A path that begins with "-" is no option.
    const std::string file = path.starts_with('-') ? "./" + path : path;
    if (!choice.command.empty()) return {{"/bin/sh", "-c", choice.command + " \"$1\"", "sh", file}};
    const std::string_view name = reader_program_of(format_ending(path));
    const auto program = name.empty() ? std::nullopt : find_reader_program(name);
    if (!program) return std::nullopt;
    std::vector<std::string> arguments = {*program};
    if (name == "octopair-ifc") {
        for (const std::string& type : choice.include_types) {
            arguments.emplace_back("--include-type");
            arguments.push_back(type);
        }
    } else if (choice.chord > 0) {
        arguments.emplace_back("--chord");
        arguments.push_back(number_text(UnitChange(content.unit, "mm")(choice.chord)));
    }
    arguments.push_back(file);
    return arguments;
}

LoadedScene read_by_program(const std::string& path, std::vector<std::string> arguments, const SceneContent& content,
                            const std::stop_token& stop) {
    const InputFile file(path);  // throws an error with the reason of the system if the file cannot be opened
    ReadBudget budget(path, stop);
    budget.add_file(file.size());
    std::error_code ignored;
    if (!fs::is_regular_file(path, ignored)) {  // a stream: the program reads the copy in memory
        arguments.back() = fmt::format("/proc/{}/fd/{}", ::getpid(), file.descriptor());
    }
    ReaderProcess process(path, arguments, budget, content.reader);
    const ByteSource source = [&](std::span<std::byte> bytes) { return process.read(bytes); };
    ElementInHand in_hand;
    std::optional<LoadedScene> scene;
    std::string fault;
    try {
        scene = read_model_stream(source, content, budget, in_hand);
    } catch (const Error& error) {
        if (error.code() != ErrorCode::bad_input) throw;
        fault = error.what();
    }
    // A program that failed has usually cut its stream. Then its own failure says more.
    if (!scene && !fault.ends_with("the record with the counts is missing")) throw Error(ErrorCode::bad_input, fault);
    if (std::string failure = process.failure(); !failure.empty()) {
        if (!in_hand.empty()) failure += fmt::format(", while it read {}", in_hand);
        refuse(path, failure);
    }
    if (!scene) throw Error(ErrorCode::bad_input, fault);
    file.check_unchanged();
    return std::move(*scene);
}

}  // namespace octopair::io
