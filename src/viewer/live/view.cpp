// View: copies the state of a running scene for pages. Copies take at most 1% of the time, so that they do not delay the scene.
#include "octopair/view.hpp"

#include <sys/resource.h>

#include <chrono>
#include <cmath>
#include <condition_variable>
#include <thread>

#include "octopair/error.hpp"
#include "viewer/live/live_source.hpp"
#include "viewer/server/page_server.hpp"

namespace octopair {

namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using viewer::LiveState;

void check(const ViewOptions& options) {
    const auto refuse = [](const std::string& what) { throw Error(ErrorCode::usage, "ViewOptions: " + what); };
    if (options.up != "y" && options.up != "z") refuse("up is neither \"y\" nor \"z\"");
    if (!(options.frames_per_second >= 0.001 && options.frames_per_second <= 1000))
        refuse("frames_per_second is not in [0.001, 1000]");
    if (!(options.margin >= 0 && std::isfinite(options.margin))) refuse("margin is not a finite number >= 0");
    const bool loopback = options.host == "127.0.0.1" || options.host == "::1";
    if (options.token.empty() ? !loopback : options.token.size() < 16) {
        refuse(
            "token: it must have at least 16 letters and digits, and is required for hosts other than 127.0.0.1 and "
            "::1");
    }
    for (const char c : options.token) {
        if (!std::isalnum(static_cast<unsigned char>(c))) refuse("token has characters other than letters and digits");
    }
}

viewer::SceneContents contents_of(const ViewOptions& options) {
    viewer::SceneContents contents;
    contents.title = options.title;
    contents.names = options.names;
    contents.up = options.up;
    contents.unit = options.unit;
    contents.margin = options.margin;
    return contents;
}

}  // namespace

class View::State {
public:
    State(Scene& scene, const ViewOptions& options)
        : scene_(scene),
          least_pause_(std::chrono::duration_cast<Clock::duration>(
              std::chrono::duration<double>(1 / options.frames_per_second))),
          source_(contents_of(options)),
          server_(source_, {.host = options.host, .port = options.port, .token = options.token, .low_priority = true}),
          worker_([this](const std::stop_token& stop) { pass_states_on(stop); }) {}

    ~State() {
        worker_.request_stop();
        ready_.notify_all();
    }

    std::string address() const { return server_.address(); }
    unsigned pages() const { return source_.pages(); }

    void show(const StepResult& step, bool at_once) {
        ++steps_;
        keep_events(step);
        if (at_once) {
            std::unique_lock lock(mutex_);
            passed_on_.wait(lock, [this] { return !busy_; });
            lock.unlock();
            return copy(step, Clock::now());
        }
        if (source_.pages() == 0 && Clock::now() < unwatched_) return;
        if (const auto now = Clock::now(); now >= next_ && !busy_) copy(step, now);
    }

private:
    static constexpr std::size_t max_events = 1'000'000;
    static constexpr std::uint64_t max_pairs = 20'000'000;
    static constexpr int largest_share = 100;  // copying takes at most 1 / largest_share of the time

    /// Keeps the events of a step for the next copy. Beyond `max_events`, drops the events, and the next copy takes all pairs.
    void keep_events(const StepResult& step) {
        const std::size_t more = step.began.size() + step.ended.size();
        all_pairs_needed_ |= incomplete_.exchange(false);
        if (all_pairs_needed_ || source_.pages() == 0 || events_.size() + more > max_events) {
            all_pairs_needed_ = true;
            events_.clear();
            return;
        }
        for (const Pair pair : step.ended) events_.push_back({pair, false});
        for (const Pair pair : step.began) events_.push_back({pair, true});
    }

    void copy(const StepResult& step, Clock::time_point now) {
        LiveState state;
        std::visit([&](auto boxes) { state.boxes = std::vector(boxes.begin(), boxes.end()); }, scene_.boxes());
        if (scene_.size() < scene_.indices()) {
            state.exists.resize(std::size_t(scene_.indices()));
            for (std::uint32_t i = 0; i < state.exists.size(); ++i) state.exists[i] = scene_.exists(i) ? 1 : 0;
        }
        state.pair_count = step.pairs();
        state.step = steps_;
        state.step_seconds = step.seconds;
        copy_pairs(state);
        {
            const std::lock_guard lock(mutex_);
            waiting_ = std::move(state);
            busy_ = true;
        }
        ready_.notify_one();
        const auto end = Clock::now();
        next_ = std::max(now + least_pause_, end + (end - now) * largest_share);
        unwatched_ = end + 1s;
    }

    void copy_pairs(LiveState& state) {
        const bool too_many = state.pair_count > max_pairs;
        if (too_many) {
            if (!too_many_) state.pairs.emplace();
        } else if (all_pairs_needed_ || too_many_) {
            state.pairs = scene_.pairs().to_vector();
        } else {
            state.events = std::move(events_);
        }
        events_.clear();
        too_many_ = too_many;
        all_pairs_needed_ = false;
    }

    void pass_states_on(const std::stop_token& stop) {
        ::setpriority(PRIO_PROCESS, 0, 19);  // lowest priority for this thread: the scene's threads run first
        std::unique_lock lock(mutex_);
        while (ready_.wait(lock, stop, [this] { return bool(busy_); })) {
            LiveState state = std::move(waiting_);
            lock.unlock();
            try {
                source_.feed().put(std::move(state));
                server_.notify();
            } catch (const std::bad_alloc&) {
                incomplete_ = true;  // pages keep their frame; the next copy has all pairs
            }
            lock.lock();
            busy_ = false;
            passed_on_.notify_all();
        }
    }

    Scene& scene_;
    const Clock::duration least_pause_;
    std::uint64_t steps_ = 0;
    std::vector<LiveState::PairEvent> events_;  // since the last copy
    bool all_pairs_needed_ = true;              // events_ lacks events, so the next copy takes all pairs
    bool too_many_ = false;                     // the last copy has no pairs, because there were more than max_pairs
    Clock::time_point next_ = {}, unwatched_ = {};

    std::mutex mutex_;
    std::condition_variable_any ready_, passed_on_;
    LiveState waiting_;                     // guarded by mutex_
    std::atomic<bool> incomplete_ = false;  // a copied state was lost for lack of memory
    std::atomic<bool> busy_ = false;        // true from the copy until the state is passed on
    viewer::LiveSource source_;
    viewer::PageServer server_;
    std::jthread worker_;
};

View::View(Scene& scene, const ViewOptions& options) {
    check(options);
    state_ = std::make_unique<State>(scene, options);
}
View::~View() = default;

std::string View::address() const { return state_->address(); }
void View::show(const StepResult& step, bool at_once) { state_->show(step, at_once); }
unsigned View::pages() const { return state_->pages(); }

}  // namespace octopair
