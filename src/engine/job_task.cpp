#include "engine/job_task.hpp"

#include <exception>
#include <new>
#include <span>
#include <utility>

#include "base/call_scope.hpp"

namespace octopair::detail {

namespace {

template <typename Real>
Boxes boxes_of(const std::vector<Box<Real>>& boxes) {
    return std::span(boxes);
}

template <typename Element>
Boxes boxes_of(const BoxArray<Element>& boxes) {
    return boxes.boxes();
}

Objects objects_of(const OwnedObjects& owned) {
    return {std::visit([](const auto& boxes) { return boxes_of(boxes); }, owned.boxes), owned.padding};
}

Objects objects_of(const BorrowedObjects& borrowed) { return borrowed.objects(); }

Objects view(const JobObjects& objects) {
    return std::visit([](const auto& either) { return objects_of(either); }, objects);
}

}  // namespace

Input view(const JobInput& input) {
    if (!input.second) return view(input.first);
    return Join{view(input.first), view(*input.second)};
}

JobTask::JobTask(Work work) : work_(std::move(work)) {
    caller_progress_ = std::exchange(work_->options.progress, [this](double done) { report_progress(done); });
    if (!work_->sink) pairs_.emplace();
}

void JobTask::belong_to(const Engine& engine, std::thread::id thread) {
    const std::lock_guard lock(mutex_);
    engine_ = &engine;
    queue_thread_ = thread;
}

bool JobTask::run(Engine& engine) noexcept {
    if (!hold(JobState::running)) return false;
    try {
        const Summary summary = call(engine);
        progress_.store(1, std::memory_order_relaxed);
        end({JobState::done, summary});
    } catch (...) {
        end(failure());
    }
    return true;
}

/// Makes the calling thread the holder. Returns false if the task already has a holder.
bool JobTask::hold(JobState state) {
    const std::lock_guard lock(mutex_);
    if (holder_ != std::thread::id()) return false;
    holder_ = std::this_thread::get_id();
    state_ = state;
    return true;
}

Summary JobTask::call(Engine& engine) {
    const Input input = view(work_->input);
    const std::stop_token stop = stop_.get_token();
    return pairs_ ? engine.find_pairs(input, *pairs_, work_->options, stop)
                  : engine.stream_pairs(input, *work_->sink, work_->options, stop);
}

void JobTask::report_progress(double done) {
    progress_.store(done, std::memory_order_relaxed);
    if (caller_progress_) caller_progress_(done);
}

/// Converts the exception that is being handled to the job's end. Requires: called in a catch block.
JobTask::Ending JobTask::failure() noexcept {
    try {
        try {
            throw;
        } catch (const Error& error) {
            return {error.code() == ErrorCode::cancelled ? JobState::cancelled : JobState::failed,
                    {},
                    error,
                    error.place()};
        } catch (const std::bad_alloc&) {
            return {JobState::failed};
        } catch (const std::exception& error) {
            return {JobState::failed, {}, Error(ErrorCode::engine_failed, error.what())};
        } catch (...) {
            return {JobState::failed,
                    {},
                    Error(ErrorCode::engine_failed, "the job threw an exception that is not a std::exception")};
        }
    } catch (...) {  // no memory for the message
        return {JobState::failed};
    }
}

/// Requires: the calling thread is the holder. Sets the state last, so the input is already freed when the state is visible.
void JobTask::end(Ending ending) noexcept {
    if (ending.state != JobState::done) pairs_.reset();
    work_.reset();
    caller_progress_ = nullptr;
    const std::lock_guard lock(mutex_);
    ending_ = std::move(ending);
    state_ = ending_.state;
    ended_.notify_all();
}

JobState JobTask::state() const {
    const std::lock_guard lock(mutex_);
    return state_;
}

bool JobTask::ended() const {
    const std::lock_guard lock(mutex_);
    return is_last();
}

void JobTask::cancel() noexcept {
    if (hold(JobState::queued)) {
        end({JobState::cancelled});
    } else {
        stop_.request_stop();
    }
}

/// Requires: the lock is held.
void JobTask::check_can_end() const {
    if (is_last()) return;
    const std::thread::id here = std::this_thread::get_id();
    if (here != queue_thread_ && here != holder_ && !CallScope::is_inside(engine_)) return;
    throw Error(ErrorCode::usage, "deadlock: a callback waits for a job of the engine that runs it");
}

void JobTask::wait() const {
    std::unique_lock lock(mutex_);
    check_can_end();
    ended_.wait(lock, [&] { return is_last(); });
}

bool JobTask::wait_at_most(std::chrono::nanoseconds time) const {
    std::unique_lock lock(mutex_);
    return ended_.wait_for(lock, time, [&] { return is_last(); });
}

void JobTask::wait_unless_holder() const {
    std::unique_lock lock(mutex_);
    if (holder_ != std::this_thread::get_id()) ended_.wait(lock, [&] { return is_last(); });
}

void JobTask::throw_unless_done() const {
    if (state_ == JobState::done) return;
    if (ending_.error && ending_.place) throw PlacedError(ending_.error->code(), ending_.error->what(), *ending_.place);
    if (ending_.error) throw Error(*ending_.error);
    if (state_ == JobState::cancelled) throw Error(ErrorCode::cancelled, "cancelled");
    throw Error(ErrorCode::resource_limit, "out of memory");
}

Summary JobTask::summary() const {
    wait();
    const std::lock_guard lock(mutex_);
    throw_unless_done();
    return ending_.summary;
}

PairList JobTask::take_pairs() {
    wait();
    const std::lock_guard lock(mutex_);
    throw_unless_done();
    if (!pairs_) throw Error(ErrorCode::usage, "the job's pairs were taken before, or went to a sink");
    PairList pairs = std::move(*pairs_);
    pairs_.reset();
    return pairs;
}

}  // namespace octopair::detail
