// Steps of a scene. A step is incremental (searches around changed objects) if that is expected to be cheaper than a full
// detection; otherwise it is full (searches all objects).
// Start here to change when a step of a Scene searches around changes.
#include <algorithm>
#include <chrono>
#include <cstring>
#include <functional>
#include <new>
#include <utility>

#include "base/call_scope.hpp"
#include "base/stop.hpp"
#include "base/test_hooks.hpp"
#include "base/tuning.hpp"
#include "engine/threads/team_output.hpp"
#include "octopair/error.hpp"
#include "octree/scan/scan.hpp"
#include "scene/scene_state.hpp"

namespace octopair {

namespace {

// Costs in multiples of the time of the last full detection.
constexpr double max_search_cost = 0.9;   // maximum expected cost of an incremental step
constexpr double max_rebuild_cost = 0.5;  // an octree is built if the changes are then expected to cost at most this
constexpr double abort_cost = 4;          // an incremental step that takes longer, plus abort_seconds, is aborted
constexpr double abort_seconds = 0.02;    // allowance for other programs that use the processor meanwhile

// With slack, a full step enlarges all searched boxes, so few objects leave them in the next steps. So an incremental step is chosen only
// if it is much cheaper. The fastest objects leave their boxes first, and many others follow later. So an octree is built only if few
// objects left in several steps, one after another.
constexpr double max_cost_with_slack = 0.1;
constexpr unsigned min_steps_with_few = 4;

/// First estimate of the cost of a changed object, in multiples of the cost of an object in a full step.
constexpr double initial_change_cost = 10;

/// Returns `measured`, the choice by measured times, unless tuning forces incremental or full steps.
bool chooses_incremental(bool measured) {
    const StepChoice choice = tuning().scene.step;
    return choice == StepChoice::measured ? measured : choice == StepChoice::incremental;
}

/// Returns how long an incremental step may take. Returns a very long time if tuning forces incremental steps, so that no test is aborted.
std::chrono::steady_clock::duration time_limit(double full_seconds) {
    if (tuning().scene.step != StepChoice::measured) return std::chrono::hours(1);
    const auto seconds = std::chrono::duration<double>(abort_cost * full_seconds + abort_seconds);
    return std::chrono::duration_cast<std::chrono::steady_clock::duration>(seconds);
}

double seconds_since(std::chrono::steady_clock::time_point begin) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

}  // namespace

/// Returns a function that calls SceneOptions::room_for_pairs, on any thread, as a callback of `scene`.
std::function<void(std::uint64_t)> Scene::State::room_of(const SceneOptions& options) {
    if (!options.room_for_pairs) return {};
    return [this, room = options.room_for_pairs](std::uint64_t bytes) {
        const CallScope callback(this);
        room(bytes);
    };
}

Scene::State::State(const SceneOptions& options)
    : margin_(options.margin),
      objects_(options),
      team_(options.threads),
      search_(team_),
      queries_(team_),
      history_(room_of(options)) {
    if (options.slack > 0) exact_.emplace(team_, room_of(options));
    if (options.recording.empty()) return;
    recorder_ = std::make_unique<Recorder>(options);
    objects_.record_to(recorder_.get());
}

const StepResult& Scene::State::step(const std::stop_token& stop) {
    if (recorder_) recorder_->begin_step();
    const auto begin = std::chrono::steady_clock::now();
    const std::uint64_t before = shown().size();
    bool full = false;
    try {
        update_searched();
        const bool idle = find_nothing(stop);
        if (!idle) full = search(stop);
        if (exact_ && (!idle || objects_.changed())) exact_->update(history_.list(), objects_.table(), margin_, found_);
    } catch (const std::bad_alloc&) {
        throw Error(ErrorCode::resource_limit, "out of memory");
    } catch (const Error& error) {
        if (error.code() == ErrorCode::engine_failed) {
            // A search had wrong results, perhaps because of its octree. The next step builds all octrees from the objects.
            states_.forget(SearchedStates::octree), states_.forget(SearchedStates::linear);
            refills_ = tuning().scene.max_refills;
        }
        throw;
    }
    states_.end_step();
    std::swap(changes_, found_);
    if (objects_.finish_step()) states_.change();
    result_ = {changes_.began, changes_.ended, before - changes_.ended.size(), full, seconds_since(begin)};
    if (recorder_) recorder_->end_step(result_);
    return result_;
}

void Scene::State::update_searched() {
    objects_.update_searched();
    if (states_.has_stepped() && !objects_.must_search()) states_.set_unchanged();
}

/// Brings the pairs of the searched boxes up to date. Returns whether it searched all objects.
bool Scene::State::search(const std::stop_token& stop) {
    const bool few = expects_few_changes();
    const bool few_left = double(objects_.log().previous_states().size()) * initial_change_cost <
                          max_cost_with_slack * double(objects_.table().size());
    steps_with_few_ = few_left && !objects_.log().overflowed() ? steps_with_few_ + 1 : 0;
    history_.prepare(few);
    const bool full = !(few && find_changes(stop));
    if (full) {
        objects_.enlarge_all();
        states_.change();
        find_all(stop);
    }
    count_path(full ? Path::step_full : Path::step_incremental);
    return full;
}

/// Runs a step in which no searched box has changed. Returns false, and does nothing, if a searched box has changed, or if the pairs
/// do not describe the last step.
bool Scene::State::find_nothing(const std::stop_token& stop) {
    const bool idle =
        states_.is_last_step(SearchedStates::pairs) && !objects_.must_search() && !history_.is_inconsistent();
    if (!idle || !chooses_incremental(true)) return false;
    throw_if_stopped(stop);
    found_.clear();
    count_path(Path::step_idle);
    return true;
}

/// Returns whether an incremental step is possible, and expected to be cheaper than a full one.
bool Scene::State::expects_few_changes() const {
    // A step that found the pairs and then failed leaves pairs of a later state than that of the last step. Only a full step may follow it.
    const bool has_octree = states_.is_last_step(SearchedStates::octree);
    if (!states_.is_last_step(SearchedStates::pairs) || !(has_octree || states_.is_last_step(SearchedStates::linear)))
        return false;
    const double expected = double(objects_.log().previous_states().size()) * seconds_a_change_;
    double most = has_octree ? max_search_cost : max_rebuild_cost;
    if (exact_) most = std::min(most, max_cost_with_slack);
    const bool often = !exact_ || has_octree || steps_with_few_ >= min_steps_with_few;
    const bool cheap = chooses_incremental(expected <= most * full_seconds_ && often);
    // Entries without rounding require objects without paddings. If objects have paddings now, the octree needs other entries.
    const bool unlike = rounding_.exact && objects_.table().any_padding();
    return cheap && !unlike && !objects_.log().overflowed() && !history_.is_inconsistent();
}

void Scene::State::find_all(const std::stop_token& stop) {
    const auto begin = std::chrono::steady_clock::now();
    states_.forget(SearchedStates::octree);
    if (!queried_) octree_.release();
    queried_ = false;
    const SceneBoxSource source(objects_.table(), margin_);
    build(source, stop);
    detail::PairStorage& fresh = detail::storage_of(history_.fresh());
    fresh.reset();
    const std::uint64_t indices = objects_.table().indices();
    const auto find = [&](Executor& executor) { scan(linear_, {source, stop, scan_memory_}, executor, {}); };
    list_ascending_pairs(team_, fresh, {{0, indices}, indices}, find, {stop});
    full_seconds_ = seconds_since(begin);
    const double guess =
        initial_change_cost * full_seconds_ / double(std::max<std::uint64_t>(1, objects_.table().size()));
    // The measured estimate decays, so that an incremental step is tried again later.
    seconds_a_change_ = seconds_a_change_ > guess ? 0.95 * seconds_a_change_ : guess;
    history_.take_over(found_);  // last, so that an earlier failure has not changed the pairs
    states_.hold_now(SearchedStates::pairs);
}

void Scene::State::build(const SceneBoxSource& source, const std::stop_token& stop) {
    TeamExecutor executor(team_);
    const EntryRounding rounding{source.boxes().exact(), source.boxes().rounding()};
    // Rounded boxes are relative to an origin that is chosen anew for each build, so old octants do not fit new entries.
    const bool refill = refills_ < tuning().scene.max_refills && rounding.exact && rounding_.exact;
    const unsigned refills = refill ? refills_ + 1 : 0;
    refills_ = tuning().scene.max_refills;
    states_.forget(SearchedStates::linear);
    states_.forget(SearchedStates::octree);  // its entries have the rounding of the previous build
    refill ? linear_.refill(source, executor, stop) : linear_.build(source, executor, stop);
    refills_ = refills;
    rounding_ = rounding;
    states_.hold_now(SearchedStates::linear);
}

SceneQueries::View Scene::State::view(std::uint32_t groups, const std::stop_token& stop) {
    update_searched();
    const bool follows =
        states_.is_last_step(SearchedStates::octree) && !objects_.log().overflowed() && !history_.is_inconsistent();
    if (!follows && !states_.is_now(SearchedStates::octree)) {
        count_path(Path::octree_for_queries);
        states_.forget(SearchedStates::octree);
        if (!states_.is_now(SearchedStates::linear)) build(SceneBoxSource(objects_.table(), margin_), stop);
        // Uses the rounding of the build: the origin of rounding depends on all objects, also on objects that were removed since the build.
        const SceneBoxSource source(objects_.table(), {rounding_.exact, rounding_.rounding});
        TeamExecutor executor(team_);
        octree_.build(
            linear_, [&](std::span<Entry> entries) { source.load_bounds(entries); }, executor, stop);
        states_.hold_now(SearchedStates::octree);
        queried_ = true;
    }
    return {objects_.table(), octree_, rounding_.rounding, follows ? &objects_.log() : nullptr, groups, stop};
}

/// Builds the octree of incremental steps from the linear octree of the last step.
/// Requires: linear_ holds the objects as they were at the last step.
void Scene::State::build_octree_of_last_step(const std::stop_token& stop) {
    count_path(Path::octree_rebuilt);
    states_.forget(SearchedStates::octree);
    const SceneBoxSource source(objects_.table(), {rounding_.exact, rounding_.rounding});
    const auto load_bounds = [&](std::span<Entry> entries) {
        source.load_bounds(entries);
        for (Entry& entry : entries) {
            const ObjectState* const former = objects_.log().previous_state(objects_.table(), entry.object);
            if (former == nullptr) continue;
            const Entry then = rounding_.entry(former->box, former->padding);
            std::memcpy(&entry, &then, sizeof(Box3f));
        }
    };
    TeamExecutor executor(team_);
    octree_.build(linear_, load_bounds, executor, stop);
    states_.hold_last_step(SearchedStates::octree);
    linear_ = {};
    states_.forget(SearchedStates::linear);
    refills_ = tuning().scene.max_refills;
}

/// Runs an incremental step. Returns false if it was aborted because it took too long.
bool Scene::State::find_changes(const std::stop_token& stop) {
    if (!states_.is_last_step(SearchedStates::octree)) build_octree_of_last_step(stop);
    const auto begin = std::chrono::steady_clock::now();
    const std::size_t changed = objects_.log().previous_states().size();
    const ChangeSearch::Limits limits{begin + time_limit(full_seconds_),
                                      objects_.table().size() / 2 + tuning().scene.visits,
                                      history_.size() + tuning().scene.changed_pairs, stop};
    states_.forget(SearchedStates::octree);  // the octree is valid again only when all of the following has succeeded
    try {
        search_.run({objects_.table(), objects_.log(), rounding_, margin_}, octree_, found_, limits);
    } catch (const ChangeSearch::LimitReached&) {
        count_path(Path::step_too_dear);
        seconds_a_change_ = std::max(seconds_a_change_, full_seconds_ / double(changed));
        return false;
    }
    history_.apply(found_);
    states_.hold_now(SearchedStates::pairs);
    states_.hold_now(SearchedStates::octree);
    constexpr std::size_t enough = 64;  // minimum number of changes for a measurement of the cost of one
    if (changed >= enough) seconds_a_change_ += (seconds_since(begin) / double(changed) - seconds_a_change_) / 4;
    return true;
}

const PairList& Scene::State::persisting() {
    subtract(shown().list(), changes_.began, persisting_);
    return persisting_;
}

}  // namespace octopair
