// The child sends through a pipe: an Answer, then either an error message or the scene (send_scene()).
#include "cli/input/isolated_read.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <limits>
#include <new>
#include <span>
#include <vector>

#include "base/descriptor.hpp"
#include "io/files/failure.hpp"
#include "io/formats/format_choice.hpp"
#include "io/meshes/assimp/ifc_text.hpp"
#include "octopair/error.hpp"

namespace octopair::cli {

namespace {

struct Answer {
    bool failed;
    ErrorCode code;
    std::uint64_t message_bytes;
};

/// Size of the buffers on both sides of the pipe. A scene has many small values, such as names, so they are sent in batches.
constexpr std::size_t piece_bytes = 65536;

/// The sending side, in the child. Ends the child if the pipe is closed.
class PipeSender {
public:
    explicit PipeSender(int pipe) : pipe_(pipe) { buffered_.reserve(piece_bytes); }

    void scene(const io::LoadedScene& scene) {
        send(Answer{false, {}, 0});
        send_scene(scene, [this](std::span<const std::byte> bytes) { send_bytes(bytes); });
        flush();
    }
    void error(ErrorCode code, const char* message) {
        const std::span text(message, std::strlen(message));
        send(Answer{true, code, text.size()});
        send_bytes(std::as_bytes(text));
        flush();
    }

private:
    template <typename T>
    void send(const T& value) {
        send_bytes(std::as_bytes(std::span(&value, 1)));
    }
    void send_bytes(std::span<const std::byte> bytes) {
        if (buffered_.size() + bytes.size() > piece_bytes) flush();
        if (bytes.size() > piece_bytes) {
            write(bytes);
        } else {
            buffered_.insert(buffered_.end(), bytes.begin(), bytes.end());
        }
    }
    void flush() {
        write(buffered_);
        buffered_.clear();
    }
    void write(std::span<const std::byte> bytes) const {
        while (!bytes.empty()) {
            const ssize_t written = ::write(pipe_, bytes.data(), bytes.size());
            if (written < 0 && errno == EINTR) continue;
            if (written <= 0) std::_Exit(1);
            bytes = bytes.subspan(std::size_t(written));
        }
    }

    int pipe_;
    std::vector<std::byte> buffered_;
};

/// Returns the size of a file. For glTF and JSON scenes, whose meshes may be in other files, returns the size of all files in
/// the directory.
[[maybe_unused]] std::uintmax_t bytes_to_read(const std::filesystem::path& path) {
    std::error_code error;
    if (!io::may_name_files(path.string())) return std::filesystem::file_size(path, error);
    std::uintmax_t bytes = 0;
    const std::filesystem::path directory = path.has_parent_path() ? path.parent_path() : ".";
    for (const auto& entry : std::filesystem::directory_iterator(directory, error)) {
        if (const auto size = entry.file_size(error); !error) bytes += size;
    }
    return bytes;
}

/// Limits the memory of the child. Importers trust the sizes in a file: a file of 309 bytes made one allocate 16 GB.
/// The limit is many times the memory that valid files of that size have needed. Sanitizers reserve more address space than
/// any limit, so builds with sanitizers have none.
void limit_memory([[maybe_unused]] const std::string& path) {
#ifndef OCTOPAIR_SANITIZED
    constexpr rlim_t base = rlim_t(4) << 30, factor = 64;
    const std::uintmax_t size = bytes_to_read(path);
    if (size > std::numeric_limits<rlim_t>::max() / factor / 2) return;  // no such file; the caller gets an error later
    rlimit limit{};
    ::getrlimit(RLIMIT_AS, &limit);
    limit.rlim_cur = std::min<rlim_t>(limit.rlim_cur, base + factor * size);
    ::setrlimit(RLIMIT_AS, &limit);
#endif
}

/// Returns the error message for a file whose importer crashed, with advice for the user.
std::string crash_text([[maybe_unused]] const std::string& path, const std::string& cause) {
    std::string remedy = "export the model as glTF, OBJ, STL or PLY from the program that wrote it";
#ifdef OCTOPAIR_WITH_MESHES
    const std::string known = io::ifc_remedy(path);
    if (!known.empty()) remedy = known;
#endif
    const char* const what = io::is_json_file(path) ? "a mesh file that it names" : "it";
    return fmt::format("Assimp failed to read {} ({}); {}", what, cause, remedy);
}

[[noreturn]] void run_child(pid_t parent, int pipe, const std::string& path, const io::SceneContent& content) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != parent) std::_Exit(0);  // the parent has ended already
    const rlimit no_core{0, 0};
    ::setrlimit(RLIMIT_CORE, &no_core);
    limit_memory(path);
    const int nowhere = ::open("/dev/null", O_RDWR);
    if (nowhere >= 0) {
        ::dup2(nowhere, STDOUT_FILENO);
        ::dup2(nowhere, STDERR_FILENO);
    }
    PipeSender sender(pipe);
    try {
        sender.scene(io::read_scene(path, content));
    } catch (const Error& error) {
        sender.error(error.code(), error.what());
    } catch (const std::bad_alloc&) {
        sender.error(ErrorCode::resource_limit, (path + ": out of memory while reading it").c_str());
    } catch (const std::exception& error) {
        sender.error(ErrorCode::engine_failed, error.what());
    }
    std::_Exit(0);
}

/// A child process that reads a file, and the reading end of its pipe. The destructor kills the child and waits for it.
class Child {
public:
    Child(const std::string& path, const io::SceneContent& content, std::stop_token stop)
        : path_(path), stop_(std::move(stop)) {
        int ends[2];
        if (::pipe2(ends, O_CLOEXEC) != 0) fail_io(path, "cannot make a pipe", errno);
        pipe_ = Descriptor(ends[0]);
        const Descriptor writing(ends[1]);
        const pid_t parent = ::getpid();
        id_ = ::fork();
        if (id_ < 0) throw Error(ErrorCode::resource_limit, fmt::format("{}: cannot start a process to read it", path));
        if (id_ == 0) run_child(parent, writing.number(), path, content);
    }
    Child(const Child&) = delete;
    Child& operator=(const Child&) = delete;
    ~Child() {
        if (id_ <= 0) return;
        ::kill(id_, SIGKILL);
        (void)wait();
    }

    template <typename T>
    T receive() {
        T value;
        receive_bytes(std::as_writable_bytes(std::span(&value, 1)));
        return value;
    }
    void receive_bytes(std::span<std::byte> bytes) {
        while (!bytes.empty()) {
            if (arrived_.empty() && bytes.size() >= piece_.size()) {
                bytes = bytes.subspan(read(bytes));
                continue;
            }
            if (arrived_.empty()) arrived_ = std::span(piece_).first(read(piece_));
            const std::size_t size = std::min(bytes.size(), arrived_.size());
            std::copy_n(arrived_.begin(), size, bytes.begin());
            arrived_ = arrived_.subspan(size);
            bytes = bytes.subspan(size);
        }
    }

private:
    /// Reads at least one byte. Returns the number of bytes.
    std::size_t read(std::span<std::byte> bytes) {
        for (;;) {
            if (stop_.stop_requested()) io::cancel();
            pollfd waiting{pipe_.number(), POLLIN, 0};
            if (::poll(&waiting, 1, 100) <= 0) continue;
            const ssize_t got = ::read(pipe_.number(), bytes.data(), bytes.size());
            if (got < 0 && errno == EINTR) continue;
            if (got <= 0) explain_end();
            return std::size_t(got);
        }
    }

    int wait() {
        int status = 0;
        while (::waitpid(id_, &status, 0) < 0 && errno == EINTR) {
        }
        id_ = 0;
        return status;
    }

    [[noreturn]] void explain_end() {
        const int status = wait();
        const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
        if (signal == SIGKILL) {
            throw Error(ErrorCode::resource_limit, fmt::format("{}: the process that read it was killed", path_));
        }
        io::refuse(path_, crash_text(path_, signal != 0 ? ::strsignal(signal) : "it ended early"));
    }

    std::string path_;
    std::stop_token stop_;
    Descriptor pipe_;
    pid_t id_ = 0;
    std::vector<std::byte> piece_ = std::vector<std::byte>(piece_bytes);
    std::span<const std::byte> arrived_;  // received bytes of piece_ that are not consumed yet
};

}  // namespace

io::LoadedScene read_isolated(const std::string& path, const io::SceneContent& content, const std::stop_token& stop) {
    Child child(path, content, stop);
    const auto answer = child.receive<Answer>();
    if (!answer.failed) return receive_scene([&](std::span<std::byte> bytes) { child.receive_bytes(bytes); });
    std::string message(std::size_t(answer.message_bytes), '\0');
    child.receive_bytes(std::as_writable_bytes(std::span(message)));
    throw Error(answer.code, message);
}

}  // namespace octopair::cli
