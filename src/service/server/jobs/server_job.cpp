#include "service/server/jobs/server_job.hpp"

#include <algorithm>
#include <exception>
#include <string>
#include <utility>

#include "service/protocol/errors.hpp"
#include "service/protocol/job_spec.hpp"
#include "service/protocol/status.hpp"

namespace octopair::service {

namespace {

/// Returns the message without the folders of absolute paths, because clients must not see them. Removes all text from the first
/// path to the last slash, because names of folders may contain spaces.
std::string without_folders(const std::string& message) {
    const std::size_t first = message.starts_with('/') ? 0 : message.find(" /");
    if (first == std::string::npos) return message;
    return message.substr(0, first == 0 ? 0 : first + 1) + message.substr(message.rfind('/') + 1);
}

/// Returns the failure for the current exception. Requires: called in a catch block.
v1::Failure failure_of_exception() noexcept {
    v1::Failure failure;
    try {
        throw;
    } catch (const Error& error) {
        failure = failure_of(error);
        failure.set_message(without_folders(failure.message()));
    } catch (const std::bad_alloc&) {
        failure.set_code(v1::RESOURCE_LIMIT);
        failure.set_message("out of memory");
    } catch (const std::exception& error) {
        failure.set_code(v1::ENGINE_FAILED);
        failure.set_message(error.what());
    }
    return failure;
}

}  // namespace

void ServerJob::queue() {
    {
        const std::lock_guard lock(mutex_);
        if (state_ != v1::UPLOADING || early_) return;
        hash_ = detached() ? parts_.record->hash() : parts_.input->hash();
        state_ = v1::QUEUED;
        queued_ = Clock::now();
    }
    notify_watchers();
}

void ServerJob::set_ended(const v1::JobReport& ending) {
    const std::lock_guard lock(mutex_);
    hash_ = ending.head().hash();
    algorithm_ = ending.head().algorithm();
    summary_ = ending.summary();
    failure_ = ending.failure();
    state_ = ending.state();
    ended_ = Clock::now();
}

bool ServerJob::ask_memory() {
    const std::lock_guard lock(mutex_);
    if (!detached() || state_ != v1::QUEUED || early_) return true;
    auto memory = parts_.record->ask_memory();
    if (memory) parts_.memory = std::move(*memory);
    return memory.has_value();
}

bool ServerJob::waits_for_room() {
    {
        const std::lock_guard lock(mutex_);
        if (!needs_room_ || state_ != v1::QUEUED || early_) return false;
    }
    return !parts_.record->has_room();
}

ServerJob::Ran ServerJob::run(const std::shared_ptr<Engine>& engine) noexcept {
    {
        const std::lock_guard lock(mutex_);
        if (state_ != v1::QUEUED || early_ || abandoned_) {
            parts_.memory.give_back();
            return Ran::ended;
        }
        state_ = v1::RUNNING;
        needs_room_ = false;
        began_ = Clock::now();
    }
    notify_watchers();
    try {
        if (detached()) parts_.input = parts_.record->load(engine, stop_.get_token());
        const Summary summary = find(*engine, options());
        parts_.pairs->finish();
        end_done(summary);
    } catch (const NoRoomError& why) {
        if (queue_again(why)) {
            notify_watchers();
            return Ran::queued_again;
        }
    } catch (...) {
        end_failed(failure_of_exception());
    }
    notify_watchers();
    return Ran::ended;
}

/// Puts the running job back into the state queued. Returns false if the job has ended instead, because its result can never fit, or
/// because of end_early().
bool ServerJob::queue_again(const NoRoomError& why) noexcept {
    try {
        Clock::time_point began;
        {
            const std::lock_guard lock(mutex_);
            if (early_ || abandoned_) throw Error(ErrorCode::cancelled, "cancelled");
            began = began_;
        }
        parts_.record->wait_for_room(why, Clock::now() - began);
    } catch (...) {
        end_failed(failure_of_exception());
        return false;
    }
    progress_ = 0;
    const std::lock_guard lock(mutex_);
    needs_room_ = true;
    requeue();
    return true;
}

void ServerJob::end_done(const Summary& summary) {
    if (detached()) {
        v1::JobReport last = ending(v1::DONE, {});
        last.set_progress(1);
        *last.mutable_summary() = message_of(summary);
        parts_.record->end(last);
    }
    const std::lock_guard lock(mutex_);
    summary_ = message_of(summary);
    set_ended(v1::DONE);
}

/// Returns the report about the ended job, as the record stores it for servers that start later.
v1::JobReport ServerJob::ending(v1::JobState state, const v1::Failure& failure) const {
    v1::JobReport last = report();
    last.set_state(state);
    if (state == v1::FAILED) *last.mutable_failure() = failure;
    return last;
}

/// Stores `ending` in the record. If this fails, the ending is known only until the server ends.
void ServerJob::store_ending(const v1::JobReport& ending) noexcept {
    try {
        if (detached()) parts_.record->end(ending);
    } catch (const std::exception&) {
        return;
    }
}

/// Ends the running job, which stopped with `failure`. The job becomes cancelled if a cancel request caused the failure.
void ServerJob::end_failed(v1::Failure failure) noexcept {
    bool cancelled = false;
    {
        const std::lock_guard lock(mutex_);
        if (abandoned_ && !early_) return requeue();
        if (early_ && *early_) failure = **early_;
        cancelled = early_ ? !early_->has_value() : failure.code() == v1::CANCELLED_BY_CALLER;
    }
    const v1::JobState state = cancelled ? v1::CANCELLED : v1::FAILED;
    if (detached()) store_ending(ending(state, failure));
    const std::lock_guard lock(mutex_);
    failure_ = std::move(failure);
    set_ended(state);
}

Summary ServerJob::find(Engine& engine, const Options& options) {
    const PairSink sink = parts_.spec.count_only() ? PairSink() : [this](std::span<const Pair> pairs) {
        const std::uint64_t before = parts_.pairs->ready();
        parts_.pairs->append(pairs);
        if (parts_.pairs->ready() > before) notify_watchers();
    };
    return engine.stream_pairs(parts_.input->objects(), sink, options, stop_.get_token());
}

Options ServerJob::options() {
    Options options = options_of(parts_.spec);
    options.buffer_bytes = parts_.buffer_bytes;
    options.progress = [this](double done) { report_progress(done); };
    return options;
}

/// Notifies the watchers at most ten times a second.
void ServerJob::report_progress(double done) {
    constexpr std::chrono::milliseconds apart(100);
    progress_.store(done, std::memory_order_relaxed);
    const auto now = Clock::now();
    if (now - last_progress_report_ < apart) return;
    last_progress_report_ = now;
    notify_watchers();
}

void ServerJob::end_early(const Ending& why) {
    {
        const std::lock_guard lock(mutex_);
        if (early_ || is_terminal()) return;
        early_ = why;
        if (state_ == v1::RUNNING) {
            stop_.request_stop();  // then run() ends the job
            return;
        }
    }
    if (!detached()) return end_in_queue();
    parts_.record->run_on_disk_queue([self = shared_from_this()] { self->end_in_queue(); });
}

/// Ends a job that is not running: failed if `early_` holds a failure, otherwise cancelled.
void ServerJob::end_in_queue() {
    const v1::JobState state = *early_ ? v1::FAILED : v1::CANCELLED;
    if (detached()) store_ending(ending(state, early_->value_or(v1::Failure())));
    {
        const std::lock_guard lock(mutex_);
        if (*early_) failure_ = **early_;
        set_ended(state);
    }
    notify_watchers();
}

void ServerJob::abandon() {
    const std::lock_guard lock(mutex_);
    if (is_terminal()) return;
    abandoned_ = true;
    stop_.request_stop();
}

/// Puts the job back into the state queued. Requires: mutex_ is locked.
void ServerJob::requeue() noexcept {
    state_ = v1::QUEUED;
    parts_.input.reset();
    parts_.memory.give_back();
}

/// Requires: mutex_ is locked.
void ServerJob::set_ended(v1::JobState state) noexcept {
    const bool uploaded = state_ != v1::UPLOADING;  // otherwise the uploading call may be writing to the input
    state_ = state;
    ended_ = Clock::now();
    parts_.slot = {};
    if (!uploaded) return;
    parts_.input.reset();
    parts_.memory.give_back();
}

v1::JobState ServerJob::state() const {
    const std::lock_guard lock(mutex_);
    return state_;
}

bool ServerJob::ended() const {
    const std::lock_guard lock(mutex_);
    return is_terminal();
}

v1::JobReport ServerJob::report() const {
    const std::lock_guard lock(mutex_);
    v1::JobReport report;
    report.set_id(parts_.spec.id());
    report.set_detached(detached());
    report.set_count_only(parts_.spec.count_only());
    report.set_state(state_);
    report.set_progress(state_ == v1::DONE ? 1 : progress_.load(std::memory_order_relaxed));
    report.set_objects(object_count(parts_.spec));
    report.set_waits_for_room(needs_room_ && state_ == v1::QUEUED);
    if (!hash_.empty()) {
        report.mutable_head()->set_hash(hash_);
        report.mutable_head()->set_algorithm(algorithm_);
    }
    if (state_ == v1::DONE) *report.mutable_summary() = summary_;
    if (state_ == v1::FAILED) *report.mutable_failure() = failure_;
    return report;
}

std::string ServerJob::input_hash() const {
    const std::lock_guard lock(mutex_);
    return hash_;
}

void ServerJob::check_deadline(Clock::time_point now) {
    {
        const std::lock_guard lock(mutex_);
        const std::chrono::duration<double> ran = now - began_;
        if (state_ != v1::RUNNING || parts_.max_seconds <= 0 || ran.count() <= parts_.max_seconds) return;
    }
    fail(failure_of(ran_too_long("the job", parts_.max_seconds)));
}

std::optional<ServerJob::Clock::time_point> ServerJob::ended_at() const {
    const std::lock_guard lock(mutex_);
    if (!is_terminal()) return {};
    return ended_;
}

double ServerJob::queue_seconds() const {
    const std::lock_guard lock(mutex_);
    if (queued_ == Clock::time_point()) return 0;
    const bool has_run = began_ != Clock::time_point();
    return std::chrono::duration<double>((has_run ? began_ : is_terminal() ? ended_ : Clock::now()) - queued_).count();
}

double ServerJob::seconds() const {
    const std::lock_guard lock(mutex_);
    if (began_ == Clock::time_point()) return 0;
    return std::chrono::duration<double>((is_terminal() ? ended_ : Clock::now()) - began_).count();
}

void ServerJob::watch(const std::shared_ptr<JobWatcher>& watcher) {
    const std::lock_guard lock(mutex_);
    std::erase_if(watchers_, [](const auto& known) { return known.expired(); });
    watchers_.push_back(watcher);
}

void ServerJob::notify_watchers() noexcept {
    std::vector<std::weak_ptr<JobWatcher>> watchers;
    v1::JobState from = v1::UPLOADING, to = v1::UPLOADING;
    {
        const std::lock_guard lock(mutex_);
        watchers = watchers_;
        to = state_;
        from = std::exchange(reported_state_, to);
    }
    for (const auto& weak : watchers) {
        if (const auto watcher = weak.lock()) watcher->job_changed();
    }
    // The log callback comes after the watchers: clients wait for the watchers, but nobody waits for the log.
    if (from != to && parts_.on_state_change) parts_.on_state_change(*this, from, to);
}

}  // namespace octopair::service
