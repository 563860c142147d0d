#include "service/server/scenes/scene_publisher.hpp"

#include <algorithm>
#include <ctime>
#include <utility>

#include "service/protocol/job_spec.hpp"
#include "service/protocol/octopair.pb.h"
#include "service/protocol/status.hpp"
#include "service/server/calls/result_reader.hpp"

namespace octopair::service {

namespace {

/// Returns the processor time of this thread. Unlike the time of a clock, it does not grow while other threads run on the core: on a
/// busy machine, copies of 6 ms took up to 54 ms, and a watcher would then wait for 5 s.
std::chrono::nanoseconds processor_time() {
    std::timespec time{};
    ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
}

}  // namespace

Error no_scene(const std::string& id) { return {ErrorCode::bad_input, "there is no scene " + id.substr(0, 36)}; }

ScenePublisher::ScenePublisher(Description scene, ResultReader& reader)
    : id_(new_id()), scene_(std::move(scene)), reader_(reader) {}

void ScenePublisher::note_step(const StepNumbers& numbers) {
    objects_.store(numbers.objects, std::memory_order_relaxed);
    pairs_.store(numbers.pairs, std::memory_order_relaxed);
    seconds_.store(numbers.seconds, std::memory_order_relaxed);
    steps_.store(numbers.step, std::memory_order_relaxed);
}

void ScenePublisher::publish(const Take& take) noexcept {
    const auto begin = processor_time();
    next_time_ = Clock::now() + min_interval;
    try {
        std::erase_if(snapshots_, [](const auto& snapshot) { return snapshot.expired(); });
        if (snapshots_.size() >= max_snapshots) return;
        std::shared_ptr<const StepSnapshot> snapshot;
        grpc::Status failure;
        try {
            snapshot = std::make_shared<const StepSnapshot>(take(pair_limit()));
            snapshots_.push_back(snapshot);
        } catch (...) {
            failure = status_of_exception();
        }
        Receivers receivers;
        {
            const std::lock_guard lock(mutex_);
            latest_ = snapshot;
            receivers = take_receivers(steps_);
        }
        pass_on(std::move(receivers), std::move(snapshot), failure);
    } catch (...) {
        // Out of memory: the watchers get no answer, and their calls end at their time limit.
    }
    const Clock::duration pause = intervals_per_copy * (processor_time() - begin);
    next_time_ = Clock::now() + std::max<Clock::duration>(pause, min_interval);
}

void ScenePublisher::close() noexcept {
    try {
        Receivers receivers;
        {
            const std::lock_guard lock(mutex_);
            closed_ = true;
            scene_.wake = nullptr;
            receivers = take_receivers(~std::uint64_t(0));
        }
        pass_on(std::move(receivers), nullptr, status_of(no_scene(id_)));
    } catch (...) {
        // Out of memory: the watchers get no answer, and their calls end at their time limit.
    }
}

v1::SceneReport ScenePublisher::report() const {
    v1::SceneReport report;
    report.set_id(id_);
    report.set_precision(scene_.precision == Precision::float64 ? v1::FLOAT64 : v1::FLOAT32);
    report.set_margin(scene_.margin);
    report.set_objects(objects_);
    report.set_pairs(pairs_);
    report.set_steps(steps_);
    report.set_seconds(seconds_);
    return report;
}

std::shared_ptr<const StepSnapshot> ScenePublisher::wait(Waiting waiting) {
    const std::lock_guard lock(mutex_);
    if (closed_) throw no_scene(id_);
    if (auto latest = latest_.lock();
        latest && latest->numbers.step > waiting.after_step && latest->lists(waiting.pair_limit))
        return latest;
    waiting_.push_back(std::move(waiting));
    update_wanted();
    scene_.wake();
    return nullptr;
}

void ScenePublisher::forget(const SnapshotReceiver& receiver) {
    const std::lock_guard lock(mutex_);
    std::erase_if(waiting_, [&](const Waiting& one) {
        const auto known = one.receiver.lock();
        return !known || known.get() == &receiver;
    });
    update_wanted();
}

/// Returns the number of pairs that the receivers want.
std::uint64_t ScenePublisher::pair_limit() const {
    const std::lock_guard lock(mutex_);
    std::uint64_t most = 0;
    for (const Waiting& one : waiting_) most = std::max(most, one.pair_limit);
    return most;
}

/// Removes the receivers that wait for a step up to `step`, and returns them. Requires: mutex_ is locked.
ScenePublisher::Receivers ScenePublisher::take_receivers(std::uint64_t step) {
    Receivers receivers;
    std::erase_if(waiting_, [&](const Waiting& one) {
        if (one.after_step >= step) return false;
        if (auto receiver = one.receiver.lock()) receivers.push_back(std::move(receiver));
        return true;
    });
    update_wanted();
    return receivers;
}

/// Requires: mutex_ is locked.
void ScenePublisher::update_wanted() {
    std::uint64_t after = ~std::uint64_t(0);
    for (const Waiting& one : waiting_) after = std::min(after, one.after_step);
    wanted_after_.store(after, std::memory_order_relaxed);
}

void ScenePublisher::pass_on(Receivers receivers, std::shared_ptr<const StepSnapshot> snapshot,
                             const grpc::Status& failure) {
    if (receivers.empty()) return;
    reader_.add(scene_.owner, [receivers = std::move(receivers), snapshot = std::move(snapshot), failure] {
        for (const auto& receiver : receivers) receiver->receive(snapshot, failure);
    });
}

void SceneTable::enter(const std::shared_ptr<ScenePublisher>& scene) {
    const std::lock_guard lock(mutex_);
    scenes_.emplace(scene->id(), scene);
}

void SceneTable::remove(const ScenePublisher& scene) {
    const std::lock_guard lock(mutex_);
    scenes_.erase(scene.id());
}

std::shared_ptr<ScenePublisher> SceneTable::find(const Caller& caller, const std::string& id) const {
    const std::lock_guard lock(mutex_);
    const auto found = scenes_.find(id);
    if (found == scenes_.end() || !caller.sees(found->second->owner())) throw no_scene(id);
    return found->second;
}

std::vector<std::shared_ptr<ScenePublisher>> SceneTable::of(const Caller& caller, const std::string& after,
                                                            std::size_t most) const {
    const std::lock_guard lock(mutex_);
    std::vector<std::shared_ptr<ScenePublisher>> scenes;
    for (auto at = scenes_.upper_bound(after); at != scenes_.end() && scenes.size() < most; ++at) {
        if (caller.sees(at->second->owner())) scenes.push_back(at->second);
    }
    return scenes;
}

}  // namespace octopair::service
