// Job: the handle. Each member function forwards to the JobTask that the handle and the queue share. Also the calls of Engine that make jobs.
#include "octopair/job.hpp"

#include <memory>
#include <new>
#include <utility>

#include "base/floating_point_scope.hpp"
#include "engine/job_queue.hpp"
#include "engine/job_task.hpp"
#include "engine/request.hpp"

namespace octopair {

Job::Job(std::shared_ptr<detail::JobTask> task) noexcept : task_(std::move(task)) {}

Job detail::make_job(std::shared_ptr<JobTask> task) noexcept { return Job(std::move(task)); }

Job& Job::operator=(Job&& other) noexcept {
    const std::shared_ptr<detail::JobTask> next = std::move(other.task_);
    if (next != task_) let_go();
    task_ = next;
    return *this;
}

Job::~Job() { let_go(); }

void Job::let_go() noexcept {
    if (task_ == nullptr) return;
    task_->cancel();
    task_->wait_unless_holder();
}

JobState Job::state() const noexcept { return task_ != nullptr ? task_->state() : JobState::cancelled; }

double Job::progress() const noexcept { return task_ != nullptr ? task_->progress() : 0; }

void Job::wait() const {
    if (task_ != nullptr) task_->wait();
}

bool Job::wait_at_most(std::chrono::nanoseconds time) const { return task_ == nullptr || task_->wait_at_most(time); }

void Job::cancel() noexcept {
    // The copy keeps the task alive: cancelling frees the job's input and sink, which may own this handle.
    if (const std::shared_ptr<detail::JobTask> task = task_) task->cancel();
}

namespace {

[[noreturn]] void throw_empty() { throw Error(ErrorCode::usage, "the handle has no job"); }

}  // namespace

Summary Job::summary() const {
    if (task_ == nullptr) throw_empty();
    return task_->summary();
}

PairList Job::take_pairs() {
    if (task_ == nullptr) throw_empty();
    return task_->take_pairs();
}

template <typename Work>
Job Engine::submit_work(Work work) {
    const FloatingPointScope scope;
    check(detail::request_of(detail::view(work.input), work.options));
    try {
        const auto task = std::make_shared<detail::JobTask>(std::move(work));
        jobs().add(task);
        return detail::make_job(task);
    } catch (const std::bad_alloc&) {
        throw Error(ErrorCode::resource_limit, "out of memory");
    }
}

Job Engine::submit(JobInput input, Options options) {
    return submit_work(detail::JobTask::Work{std::move(input), {}, std::move(options)});
}

Job Engine::submit_stream(JobInput input, PairSink sink, Options options) {
    return submit_work(detail::JobTask::Work{std::move(input), std::move(sink), std::move(options)});
}

}  // namespace octopair
