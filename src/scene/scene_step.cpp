// The steps of a scene: around what changed where that is cheaper, and otherwise all.
#include <algorithm>
#include <chrono>
#include <new>
#include <utility>

#include "base/test_hooks.hpp"
#include "base/tuning.hpp"
#include "engine/threads/ascending.hpp"
#include "octopair/error.hpp"
#include "octree/scan.hpp"
#include "scene/scene_state.hpp"

namespace octopair {

namespace {

// In parts of a full detection, as far as costs are known:
constexpr double worth_it = 0.9;  // may the search for changes cost
constexpr double pays = 0.5;      // would the last step's changes have cost, so that an octree for the next ones pays
constexpr double most_patience = 4;  // may the search take, where it turns out dearer than that

constexpr double least_patience = 0.02;  // seconds beside, in which others may have had the processor
constexpr double guessed_cost = 10;      // of an object that changed, in those of one in a full detection

/// Returns the choice that measured seconds suggest, unless tuning forces another one.
bool is_wanted_incremental(bool measured) {
    const StepChoice choice = tuning().scene.step;
    return choice == StepChoice::measured ? measured : choice == StepChoice::incremental;
}

double seconds_since(std::chrono::steady_clock::time_point begin) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

}  // namespace

Scene::State::State(const SceneOptions& options)
    : margin_(options.margin),
      objects_(options),
      team_(options.threads),
      search_(team_),
      queries_(team_),
      history_(options.room_for_pairs) {
    if (options.recording.empty()) return;
    recorder_ = std::make_unique<Recorder>(options);
    objects_.record_to(recorder_.get());
}

const StepResult& Scene::State::step(const std::stop_token& stop) {
    if (recorder_) recorder_->begin_step();
    const auto begin = std::chrono::steady_clock::now();
    const double changed = double(objects_.log().formers().size());
    const double expected = changed * seconds_a_change_;
    const std::uint64_t before = history_.size();
    const bool unlike = rounding_.exact && objects_.table().any_padding();  // boxes in the octree have not been widened
    const bool cheap = is_wanted_incremental(expected <= worth_it * full_seconds_);
    bool full = !octree_is_current_ || unlike || objects_.log().overflowed() || !cheap || history_.is_doubtful();
    try {
        history_.prepare(octree_is_current_);
        const bool found = !full && find_changes(stop);
        if (!found) find_all(stop);
        count_path(found ? Path::step_incremental : Path::step_full);
        full = !found;
    } catch (const std::bad_alloc&) {
        throw Error(ErrorCode::resource_limit, "out of memory");
    } catch (const Error& error) {
        if (error.code() == ErrorCode::engine_failed) drop_octrees();
        throw;
    }
    std::swap(changes_, found_);
    objects_.finish_step();
    result_ = {changes_.began, changes_.ended, before - changes_.ended.size(), full, seconds_since(begin)};
    if (recorder_) recorder_->end_step(result_);
    return result_;
}

/// After a search that was wrong: the next one begins with the objects alone.
void Scene::State::drop_octrees() {
    octree_is_current_ = fresh_ = built_ = false;
    refills_ = tuning().scene.refills;
}

void Scene::State::find_all(const std::stop_token& stop) {
    const auto begin = std::chrono::steady_clock::now();
    if (!asked_) octree_.release();
    asked_ = false;
    octree_is_current_ = fresh_ = false;
    const SceneSource source(objects_.table(), margin_);
    build(source, stop);
    detail::PairStorage& fresh = detail::storage_of(history_.fresh());
    fresh.reset();
    AscendingExecutor ascending(team_, fresh, {{0, objects_.table().indices()}, objects_.table().indices()});
    scan(linear_, {source, stop}, ascending, {});
    ascending.append_sorted(stop);
    full_seconds_ = seconds_since(begin);
    const double guess = guessed_cost * full_seconds_ / double(std::max<std::uint64_t>(1, objects_.table().size()));
    // What was learned fades, so that it is tried again.
    seconds_a_change_ = seconds_a_change_ > guess ? 0.95 * seconds_a_change_ : guess;
    const bool build_octree = is_wanted_incremental(double(objects_.moved()) * seconds_a_change_ <= pays * full_seconds_);
    if (build_octree) {
        count_path(Path::octree_rebuilt);
        octree_.build(linear_, stop);
        linear_ = {};
        refills_ = tuning().scene.refills;
        built_ = false;
    }
    history_.take_over(found_);  // the last step: one that fails before has changed nothing
    octree_is_current_ = build_octree;
}

void Scene::State::build(const SceneSource& source, const std::stop_token& stop) {
    TeamExecutor executor(team_);
    const EntryRounding rounding{source.boxes().exact(), source.boxes().rounding()};
    // Where boxes are moved to an origin, it is another one each time.
    const bool refill = refills_ < tuning().scene.refills && rounding.exact && rounding_.exact;
    const unsigned refills = refill ? refills_ + 1 : 0;
    refills_ = tuning().scene.refills;
    built_ = false;
    refill ? linear_.refill(source, executor, stop) : linear_.build(source, executor, stop);
    refills_ = refills;
    rounding_ = rounding;
    built_ = true;
}

SceneQueries::Scene Scene::State::view(std::uint32_t groups) {
    const bool follows = octree_is_current_ && !objects_.log().overflowed() && !history_.is_doubtful();
    if (!follows && !fresh_) {
        count_path(Path::octree_for_queries);
        octree_is_current_ = false;
        if (!built_) build(SceneSource(objects_.table(), margin_), {});
        octree_.build(linear_, {});
        fresh_ = asked_ = true;
    }
    return {objects_.table(), octree_, rounding_.rounding, follows ? &objects_.log() : nullptr, groups};
}

/// False if that is too dear after all.
bool Scene::State::find_changes(const std::stop_token& stop) {
    const auto begin = std::chrono::steady_clock::now();
    const std::size_t changed = objects_.log().formers().size();
    const auto patience = std::chrono::duration<double>(most_patience * full_seconds_ + least_patience);
    const ChangeSearch::Limits limits{begin + std::chrono::duration_cast<std::chrono::steady_clock::duration>(patience),
                                      objects_.table().size() / 2 + tuning().scene.visits,
                                      history_.size() + tuning().scene.changed_pairs, stop};
    octree_is_current_ = false;  // until all of this is done
    try {
        search_.run({objects_.table(), objects_.log(), rounding_, margin_}, octree_, found_, limits);
    } catch (const ChangeSearch::TooDear&) {
        count_path(Path::step_too_dear);
        seconds_a_change_ = std::max(seconds_a_change_, full_seconds_ / double(changed));
        return false;
    }
    history_.apply(found_);
    octree_is_current_ = true;
    constexpr std::size_t enough = 64;  // to tell what one costs
    if (changed >= enough) seconds_a_change_ += (seconds_since(begin) / double(changed) - seconds_a_change_) / 4;
    return true;
}

const PairList& Scene::State::persisting() {
    subtract(history_.list(), changes_.began, persisting_);
    return persisting_;
}

}  // namespace octopair
