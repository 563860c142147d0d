#include "engine/job_queue.hpp"

#include <algorithm>
#include <string>
#include <system_error>
#include <utility>

#include "engine/job_task.hpp"
#include "octopair/error.hpp"

namespace octopair {

JobQueue::~JobQueue() {
    {
        const std::lock_guard lock(mutex_);
        ending_ = true;
        changed_.notify_all();
    }
    // The thread takes no job any more, and nobody submits to an engine that goes.
    for (const auto& task : waiting_) task->cancel();
    if (!thread_.joinable()) return;
    if (const auto running = [&] { return std::lock_guard(mutex_), running_; }()) running->cancel();
    thread_.join();
}

void JobQueue::add(const std::shared_ptr<Job::Task>& task) {
    const std::lock_guard lock(mutex_);
    if (!thread_.joinable()) start_thread();
    if (waiting_.size() >= drop_from_) drop_ended();
    task->belong_to(thread_.get_id());
    waiting_.push_back(task);
    changed_.notify_all();
}

void JobQueue::start_thread() {
    try {
        thread_ = std::thread([this] { run_jobs(); });
    } catch (const std::system_error& error) {
        throw Error(ErrorCode::resource_limit, std::string("cannot start a thread: ") + error.what());
    }
}

void JobQueue::run_jobs() {
    while (const auto task = next()) task->run(engine_);
}

/// The job whose turn it is; null at the end.
std::shared_ptr<Job::Task> JobQueue::next() {
    std::unique_lock lock(mutex_);
    running_ = nullptr;
    changed_.wait(lock, [&] { return ending_ || !waiting_.empty(); });
    if (ending_) return nullptr;
    running_ = std::move(waiting_.front());
    waiting_.pop_front();
    return running_;
}

void JobQueue::drop_ended() {
    std::erase_if(waiting_, [](const auto& task) { return task->ended(); });
    drop_from_ = std::max<std::size_t>(64, 2 * waiting_.size());
}

}  // namespace octopair
