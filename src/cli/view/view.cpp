// octopair view: shows a scene, a result, a recording or a server in a browser.
#include <fmt/format.h>

#include <condition_variable>
#include <cstdio>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>

#include "base/stop.hpp"
#include "cli/command/command.hpp"
#include "cli/command/interrupt.hpp"
#include "cli/command/option_values.hpp"
#include "cli/command/program_main.hpp"
#include "cli/subcommands.hpp"
#include "cli/view/view.hpp"
#include "io/files/atomic_file.hpp"
#include "io/formats/format_choice.hpp"
#include "io/results/result_file.hpp"
#include "viewer/scene/page_file.hpp"
#include "viewer/scene/source.hpp"
#include "viewer/server/page_server.hpp"

namespace octopair::cli {

namespace {

using namespace std::chrono_literals;

constexpr std::string_view finding_pairs = "finding pairs";

LoadedView load(const ViewRequest& request, ProgressLine& progress, const std::stop_token& stop) {
    progress.show("reading", 0);
    if (request.detect.inputs.empty()) return load_result(request, stop);
    if (request.detect.inputs.size() == 1 && request.result.empty() && is_recording(request.detect.inputs.front())) {
        return load_recording(request, progress, stop);
    }
    return load_scene(request, progress, stop);
}

/// Waits until a stop is requested.
void wait_until_stopped(const std::stop_token& stop) {
    std::mutex mutex;
    std::condition_variable_any never;
    std::unique_lock lock(mutex);
    never.wait(lock, stop, [] { return false; });
}

/// Loads a source on a thread of its own, so that a page can show the progress of a long search.
class Loading {
public:
    /// Starts to load. Shows the progress on `line` until report_to() is called.
    Loading(viewer::FrameSource& source, ProgressLine& line)
        : source_(source), line_(line), thread_([this] { run(); }) {}

    /// Waits, but at most for `most`. Returns whether the source is loaded. Throws: what FrameSource::load() throws.
    bool wait(std::chrono::milliseconds most, const std::stop_token& stop) {
        std::unique_lock lock(mutex_);
        ended_.wait_for(lock, stop, most, [this] { return done_; });
        if (done_ && error_ != nullptr) std::rethrow_exception(error_);
        return done_;
    }
    /// Sends the progress to the pages of a server from now on.
    void report_to(viewer::PageServer& server) {
        const std::lock_guard lock(report_mutex_);
        line_.clear();
        server_ = &server;
    }

private:
    void run() {
        try {
            source_.load([&](double done) { report(done); });
        } catch (...) {
            error_ = std::current_exception();
        }
        const std::lock_guard lock(mutex_);
        done_ = true;
        ended_.notify_all();
    }

    void report(double done) {
        source_.set_progress(done);
        const std::lock_guard lock(report_mutex_);
        if (server_ == nullptr) return line_.show(finding_pairs, done);
        const auto now = std::chrono::steady_clock::now();
        if (now - reported_ < 100ms) return;
        reported_ = now;
        server_->broadcast("", viewer::progress_message(finding_pairs, done));
    }

    viewer::FrameSource& source_;
    std::mutex report_mutex_;
    ProgressLine& line_;
    viewer::PageServer* server_ = nullptr;
    std::chrono::steady_clock::time_point reported_;
    std::mutex mutex_;
    std::condition_variable_any ended_;
    bool done_ = false;
    std::exception_ptr error_;
    std::jthread thread_;
};

/// Waits until the source is loaded, and tells the pages.
void finish_loading(Loading& loading, viewer::PageServer& server, const std::stop_token& stop) {
    try {
        while (!loading.wait(1h, stop)) throw_if_stopped(stop);
        server.broadcast("", viewer::ready_message());
    } catch (const Error& error) {
        server.broadcast("", viewer::failed_message(error.what()));
        throw;  // the server sends the message before it ends
    }
}

/// Counts the pairs of all frames for the timeline of the page.
std::jthread start_counting(viewer::FrameSource& source, viewer::PageServer& server) {
    return std::jthread([&](const std::stop_token& stop) {
        try {
            source.count_frames([&](std::uint64_t done) { server.broadcast("", viewer::timeline_message(done)); },
                                stop);
        } catch (const std::exception& error) {
            if (stop.stop_requested()) return;
            // Pages can still show the frames before the failure. So print the error, ignore its exit status, and go on.
            static_cast<void>(fail(ErrorCode::bad_input, error.what()));
            server.broadcast("", viewer::timeline_message(source.counted()));
        }
    });
}

/// Serves a scene until a stop request.
void serve_scene(const ViewRequest& request, LoadedView& view, ProgressLine& progress, const std::stop_token& stop) {
    viewer::FrameSource source(std::move(view.contents), *view.finder);
    std::optional<viewer::PageServer> server;
    server.emplace(source, server_options(request));
    Loading loading(source, progress);
    const bool loaded = loading.wait(300ms, stop);  // an early error ends the command before a page opens
    throw_if_stopped(stop);
    loading.report_to(*server);
    present(request, *server);
    if (!loaded) finish_loading(loading, *server, stop);
    std::jthread counting;
    if (source.moving()) counting = start_counting(source, *server);
    wait_until_stopped(stop);
}

/// Finds the pairs of all frames.
void find_all(viewer::FrameSource& source, ProgressLine& progress, const std::stop_token& stop) {
    source.load([&](double done) { progress.show(finding_pairs, done); });
    if (source.moving()) {
        const auto show = [&](std::uint64_t done) {
            progress.show("counting pairs", double(done) / double(source.frames()));
        };
        source.count_frames(show, stop);
    }
    throw_if_stopped(stop);
}

std::string size_text(std::size_t bytes) {
    if (bytes < 1000) return fmt::format("{} bytes", bytes);
    return bytes < 1'000'000 ? fmt::format("{:.1f} kB", double(bytes) / 1e3)
                             : fmt::format("{:.1f} MB", double(bytes) / 1e6);
}

std::string counted(std::uint64_t count, std::string_view what) {
    return fmt::format("{} {}{}", grouped(count), what, count == 1 ? "" : "s");
}

/// Returns the number of objects, pairs and frames. `pair`: the word for a pair. `written`: number of frames in the file.
std::string content_text(const viewer::FrameSource& source, std::string_view pair, std::uint64_t written) {
    const auto [pairs, more] = source.pair_total();
    std::string text = counted(source.objects(), "object");
    if (source.moving()) text += fmt::format(" in each of {}", counted(source.frames(), "frame"));
    text += ", " + counted(pairs, pair) + (more ? " (more exist)" : "");
    if (written < source.frames()) text += fmt::format("; only the first {} fit", counted(written, "frame"));
    return text;
}

/// Returns the picture of a page with this text.
std::string draw(const std::string& page, ProgressLine& progress, const std::stop_token& stop) {
    const TemporaryFolder folder;
    io::AtomicFile file(folder.path() + "/page.html");
    file.write(page);
    file.commit();
    return take_screenshot(
        file.path(), [&](double done) { progress.show("drawing", done); }, stop);
}

/// Writes the page of --export and the picture of --screenshot.
void write_files(const ViewRequest& request, LoadedView& view, ProgressLine& progress, const std::stop_token& stop) {
    std::optional<io::AtomicFile> page, picture;
    if (!request.export_page.empty()) page.emplace(request.export_page);
    if (!request.screenshot.empty()) picture.emplace(request.screenshot);
    const bool exact = view.contents.contacts || stage_of(request.detect) != Stage::pairs;
    viewer::FrameSource source(std::move(view.contents), *view.finder);
    find_all(source, progress, stop);
    std::string text;
    const std::uint64_t written = viewer::write_page(
        source, [&](std::string_view part) { text += part; }, {},
        [&](double done) {
            throw_if_stopped(stop);
            progress.show("writing", done);
        });
    const auto finish = [&](std::optional<io::AtomicFile>& file, const std::string& bytes, std::uint64_t frames) {
        if (!file) return;
        file->write(bytes);
        file->commit();
        progress.clear();
        if (request.detect.quiet) return;
        fmt::print(stderr, "wrote {} ({}): {}\n", file->path(), size_text(bytes.size()),
                   content_text(source, exact ? "collision" : "pair", frames));
    };
    std::string drawn;
    if (picture) drawn = draw(text, progress, stop);
    finish(page, text, written);
    finish(picture, drawn, source.frames());
}

int run_view(const ViewRequest& request) {
    const Interrupt interrupt;
    ProgressLine progress(!request.detect.quiet);
#ifdef OCTOPAIR_WITH_SERVICE
    if (request.detect.engine.is_server()) {
        view_server(request, interrupt.token());
        return 0;
    }
#endif
    LoadedView view = load(request, progress, interrupt.token());
    if (!request.export_page.empty() || !request.screenshot.empty()) {
        write_files(request, view, progress, interrupt.token());
    } else {
        serve_scene(request, view, progress, interrupt.token());
    }
    return 0;
}

}  // namespace

void add_view(Command& program, Action& action) {
    Command command = program.add_subcommand("view", "show a scene, a result, a recording or a server in a browser");
    const auto request = std::make_shared<ViewRequest>();
    add_view_options(command, *request);
    command.set_examples({"octopair view parts.glb", "octopair view boxes.npy pairs.npy",
                          "octopair view walls.ifc --against pipes.ifc", "octopair view parts.glb --export page.html"});
    command.callback([request, command, &action] {
        request->detect.given = command.given_options();
        check_view_options(*request);
        action = [request] { return run_view(*request); };
    });
}

}  // namespace octopair::cli
