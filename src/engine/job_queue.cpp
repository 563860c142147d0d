#include "engine/job_queue.hpp"

#include <string>
#include <system_error>

#include "base/floating_point_scope.hpp"
#include "engine/job_task.hpp"
#include "octopair/error.hpp"

namespace octopair::detail {

JobQueue::~JobQueue() {
    skipped_ ? tasks_.finish() : tasks_.close();
    // No job is added any more: nobody may call an engine that is being destroyed.
    for (const auto& task : tasks_.items()) task->cancel();
    if (thread_.joinable()) thread_.join();
}

void JobQueue::add(const std::shared_ptr<JobTask>& task) {
    const std::lock_guard lock(mutex_);
    if (!thread_.joinable()) start_thread();
    task->belong_to(engine_, thread_.get_id());
    if (skipped_) return tasks_.add(task);
    tasks_.add(task, [](const auto& waiting) { return waiting->ended(); });
}

void JobQueue::start_thread() {
    try {
        thread_ = std::thread([this] { run_jobs(); });
    } catch (const std::system_error& error) {
        throw Error(ErrorCode::resource_limit, std::string("cannot start a thread: ") + error.what());
    }
}

void JobQueue::run_jobs() {
    const FloatingPointScope scope;
    tasks_.run([this](const std::shared_ptr<JobTask>& task) {
        if (!task->run(engine_) && skipped_) skipped_();
    });
}

void JobQueue::wait_for_all() {
    {
        const std::lock_guard lock(mutex_);
        if (thread_.get_id() == std::this_thread::get_id()) return;
    }
    tasks_.wait_until_idle();
}

}  // namespace octopair::detail
