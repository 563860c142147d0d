#include "engine/job_queue.hpp"

#include <algorithm>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "base/floating_point.hpp"
#include "engine/job_task.hpp"
#include "octopair/error.hpp"

namespace octopair::detail {

JobQueue::~JobQueue() {
    {
        const std::lock_guard lock(mutex_);
        ending_ = true;
        changed_.notify_all();
    }
    // Nobody submits to an engine that goes.
    std::vector<std::shared_ptr<JobTask>> left;
    {
        const std::lock_guard lock(mutex_);
        left.assign(waiting_.begin(), waiting_.end());
        if (running_) left.push_back(running_);
    }
    for (const auto& task : left) task->cancel();
    if (thread_.joinable()) thread_.join();
}

void JobQueue::add(const std::shared_ptr<JobTask>& task) {
    const std::lock_guard lock(mutex_);
    if (!thread_.joinable()) start_thread();
    if (waiting_.size() >= drop_from_ && !skipped_) drop_ended();
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
    const FloatingPointScope scope;
    while (const auto task = next()) {
        if (!task->run(engine_) && skipped_) skipped_();
    }
}

/// The job whose turn it is; null at the end.
std::shared_ptr<JobTask> JobQueue::next() {
    std::unique_lock lock(mutex_);
    running_ = nullptr;
    if (waiting_.empty()) idle_.notify_all();
    changed_.wait(lock, [&] { return ending_ || !waiting_.empty(); });
    if (waiting_.empty() || (ending_ && !skipped_)) return nullptr;
    running_ = std::move(waiting_.front());
    waiting_.pop_front();
    return running_;
}

void JobQueue::wait_for_all() {
    std::unique_lock lock(mutex_);
    if (thread_.get_id() == std::this_thread::get_id()) return;
    idle_.wait(lock, [&] { return waiting_.empty() && running_ == nullptr; });
}

void JobQueue::drop_ended() {
    std::erase_if(waiting_, [](const auto& task) { return task->ended(); });
    drop_from_ = std::max<std::size_t>(64, 2 * waiting_.size());
}

}  // namespace octopair::detail
