// Shows the jobs and the scenes of a server (`octopair serve`).
#include "cli/view/view.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>
#include <utility>
#include <vector>

#include "cli/server/server_choice.hpp"
#include "cli/view/server_contact.hpp"
#include "octopair/error.hpp"
#include "octopair/job_client.hpp"
#include "octopair/scene_watcher.hpp"
#include "octopair/version.hpp"
#include "viewer/live/live_source.hpp"
#include "viewer/scene/source.hpp"
#include "viewer/server/page_server.hpp"

namespace octopair::cli {

namespace {

using namespace std::chrono_literals;
using Json = nlohmann::ordered_json;

Json job_json(const JobStatus& job) {
    constexpr const char* states[] = {"queued", "running", "done", "failed", "cancelled"};
    return {{"id", job.id},
            {"owner", job.owner},
            {"state", states[std::size_t(job.state)]},
            {"progress", job.progress},
            {"queued_before", job.queued_before},
            {"objects", job.objects},
            {"pairs", job.summary.pairs},
            {"count_only", job.count_only},
            {"error", job.error ? job.error->what() : ""}};
}

Json scene_json(const SceneStatus& scene) {
    return {{"id", scene.id},       {"owner", scene.owner}, {"objects", scene.objects},
            {"pairs", scene.pairs}, {"steps", scene.steps}, {"step_seconds", scene.step_seconds}};
}

viewer::LiveState state_of(SceneSnapshot&& snapshot) {
    viewer::LiveState state;
    state.boxes = std::move(snapshot.boxes);
    state.exists.assign(snapshot.exists.begin(), snapshot.exists.end());
    state.pairs = std::move(snapshot.listed);
    state.pair_count = snapshot.pairs;
    state.step = snapshot.step;
    state.step_seconds = snapshot.step_seconds;
    return state;
}

/// Returns the client options of the command, with at most 2 s of patience. So pages soon get a message when the server does not answer.
/// The program repeats its calls anyway.
ClientOptions watching_options(const ServerChoice& choice) {
    ClientOptions options = client_options(choice);
    options.patience = std::min<std::chrono::milliseconds>(options.patience, 2s);
    return options;
}

/// A scene of the server. A thread watches the scene while pages show it.
class WatchedScene {
public:
    WatchedScene(std::string id, viewer::SceneContents contents) : id_(std::move(id)), source_(std::move(contents)) {}

    viewer::LiveSource& source() { return source_; }

    /// Watches the scene on a thread, unless a thread does. `watcher` and `server` are borrowed.
    void watch(SceneWatcher& watcher, viewer::PageServer& server) {
        {
            const std::lock_guard lock(mutex_);
            if (std::exchange(watched_, true)) return;
        }
        thread_ = std::jthread([this, &watcher, &server](const std::stop_token& stop) { run(watcher, server, stop); });
    }

private:
    std::string path() const { return "scene/" + id_; }

    void run(SceneWatcher& watcher, viewer::PageServer& server, const std::stop_token& stop) {
        ServerContact contact(path());
        std::uint64_t step = 0;
        try {
            while (!ends(stop)) {
                auto snapshot = contact.ask(server, stop, [&](const std::stop_token& end) {
                    return watcher.next(id_, step, 2s, viewer::max_listed_pairs, end);
                });
                if (!snapshot) continue;
                step = snapshot->step;
                source_.feed().put(state_of(std::move(*snapshot)));
                server.notify();
            }
        } catch (const std::exception& error) {
            // bad_input after the first snapshot: the server no longer has the scene, so the scene has ended.
            const auto* const known = dynamic_cast<const Error*>(&error);
            const bool ended = step > 0 && known != nullptr && known->code() == ErrorCode::bad_input;
            if (!stop.stop_requested())
                server.broadcast(path(), ended ? viewer::closed_message() : viewer::failed_message(error.what()));
            const std::lock_guard lock(mutex_);
            watched_ = false;
        }
    }

    /// Returns whether no page shows the scene. A page that connects later starts another thread.
    bool ends(const std::stop_token& stop) {
        const std::lock_guard lock(mutex_);
        if (!stop.stop_requested() && source_.pages() > 0) return false;
        watched_ = false;
        return true;
    }

    std::string id_;
    viewer::LiveSource source_;
    std::mutex mutex_;
    bool watched_ = false;  // guarded by mutex_; true while a thread watches the scene and will not end
    std::jthread thread_;
};

/// Offers the jobs and the scenes of a server.
class ServerSource final : public viewer::Source {
public:
    explicit ServerSource(const ServerChoice& choice)
        : address_(choice.address),
          jobs_(address_, watching_options(choice)),
          scenes_(address_, watching_options(choice)) {
        message_ = list({});  // throws if the server cannot be reached, so the command fails at once
    }

    /// Sends the state of the server to the pages twice a second, until a stop request.
    void run(viewer::PageServer& server, const std::stop_token& stop) {
        server_ = &server;
        unsigned rounds = 0;
        while (!stop.stop_requested()) {
            pause(stop, 500ms);
            if (pages_ > 0 && !stop.stop_requested()) update(server, stop);
            if (++rounds % 20 == 0) free_scenes();
        }
        server_ = nullptr;
        decltype(watched_) scenes;
        {
            const std::lock_guard lock(mutex_);
            ended_ = true;
            scenes.swap(watched_);
        }
        scenes.clear();  // destroys the scenes outside the lock, because this waits for their threads
    }

    std::optional<viewer::Answer> get(const viewer::Address& address) override {
        if (address.path() == "view.json") return view_answer();
        const std::vector<std::string_view> parts = address.parts();
        if (parts.size() < 3 || parts[0] != "scene") return std::nullopt;
        const ScenePointer scene = find(std::string(parts[1]));
        return scene == nullptr ? std::nullopt : scene->source().get(address.below(parts[0]).below(parts[1]));
    }

    std::vector<std::string> greeting(const std::string& path) override {
        if (!path.empty()) {
            return {find(id_in(path)) == nullptr ? viewer::failed_message("There is no such scene.")
                                                 : viewer::ready_message()};
        }
        const std::lock_guard lock(mutex_);
        return {viewer::ready_message(), message_};
    }

    viewer::Message live_frame(const std::string& path, std::int64_t last) override {
        const ScenePointer scene = find(id_in(path));
        return scene == nullptr ? nullptr : scene->source().live_frame("", last);
    }

    void connected(const std::string& path, bool here) override {
        here ? ++pages_ : --pages_;
        if (path.empty()) return;
        const ScenePointer scene = find(id_in(path));
        if (scene == nullptr || !counts(path, here)) return;
        scene->source().connected("", here);
        viewer::PageServer* const server = server_;
        if (here && server != nullptr) scene->watch(scenes_, *server);
    }

private:
    using ScenePointer = std::shared_ptr<WatchedScene>;

    /// Counts a page that connects (`here`) or disconnects. Returns false for a disconnecting page whose path has no counted pages.
    bool counts(const std::string& path, bool here) {
        const std::lock_guard lock(mutex_);
        unsigned& counted = counted_[path];
        if (here) {
            ++counted;
            return true;
        }
        if (counted == 0) return false;
        if (--counted == 0) counted_.erase(path);
        return true;
    }

    static std::string id_in(const std::string& path) {
        constexpr std::string_view prefix = "scene/";
        return path.starts_with(prefix) ? path.substr(prefix.size()) : std::string();
    }

    /// Returns the message with all jobs and scenes.
    std::string list(const std::stop_token& stop) {
        Json jobs = Json::array(), scenes = Json::array();
        for (const JobStatus& job : jobs_.list(stop)) jobs.push_back(job_json(job));
        std::vector<SceneStatus> running;
        if (has_scenes_) {
            try {
                running = scenes_.list(stop);
            } catch (const Error& error) {
                if (error.code() != ErrorCode::usage) throw;
                has_scenes_ = false;  // an older server
            }
        }
        for (const SceneStatus& scene : running) scenes.push_back(scene_json(scene));
        const Json message = {{"event", "jobs"}, {"jobs", std::move(jobs)}, {"scenes", std::move(scenes)}};
        const std::lock_guard lock(mutex_);
        known_ = std::move(running);
        return message.dump(-1, ' ', false, Json::error_handler_t::replace);
    }

    void update(viewer::PageServer& server, const std::stop_token& stop) {
        try {
            std::string message = contact_.ask(server, stop, [&](const std::stop_token& end) { return list(end); });
            if (message.empty()) return;
            {
                const std::lock_guard lock(mutex_);
                message_ = message;
            }
            server.broadcast("", std::move(message));
        } catch (const std::exception& error) {
            if (!stop.stop_requested()) server.broadcast("", viewer::failed_message(error.what()));
        }
    }

    /// Returns the scene with this id, or null if the text is not a valid id. If the server has no such scene, watch() reports the error.
    ScenePointer find(const std::string& id) {
        constexpr std::size_t id_length = 36;
        if (id.size() != id_length || id.find_first_not_of("0123456789abcdef-") != std::string::npos) return nullptr;
        const std::lock_guard lock(mutex_);
        if (ended_) return nullptr;
        ScenePointer& scene = watched_[id];
        if (scene != nullptr) return scene;
        viewer::SceneContents contents;
        contents.title = "scene " + id.substr(0, 8) + " of " + address_;
        for (const SceneStatus& status : known_) {
            if (status.id == id) contents.margin = status.margin;
        }
        scene = std::make_shared<WatchedScene>(id, std::move(contents));
        return scene;
    }

    /// Frees the scenes that no page shows.
    void free_scenes() {
        std::vector<ScenePointer> freed;
        std::unique_lock lock(mutex_);
        for (auto scene = watched_.begin(); scene != watched_.end();) {
            if (scene->second->source().pages() > 0) {
                ++scene;
                continue;
            }
            freed.push_back(std::move(scene->second));
            scene = watched_.erase(scene);
        }
        lock.unlock();
        freed.clear();  // destroys the scenes outside the lock, because this waits for their threads
    }

    viewer::Answer view_answer() const {
        return {viewer::AnswerKind::json,
                Json{{"version", OCTOPAIR_VERSION}, {"title", address_}, {"kind", "server"}, {"notices", Json::array()}}
                    .dump(-1, ' ', false, Json::error_handler_t::replace)};
    }

    std::string address_;
    JobClient jobs_;
    SceneWatcher scenes_;
    bool has_scenes_ = true;
    ServerContact contact_{""};
    std::atomic<unsigned> pages_ = 0;
    std::atomic<viewer::PageServer*> server_ = nullptr;
    std::mutex mutex_;
    std::string message_;             // the latest state, guarded by mutex_ like the members below
    std::vector<SceneStatus> known_;  // the latest list
    std::map<std::string, ScenePointer> watched_;
    std::map<std::string, unsigned> counted_;  // number of connected pages by path
    bool ended_ = false;
};

}  // namespace

void view_server(const ViewRequest& request, const std::stop_token& stop) {
    ServerSource source(request.detect.engine.server);
    viewer::PageServer server(source, server_options(request));
    present(request, server);
    source.run(server, stop);
}

}  // namespace octopair::cli
