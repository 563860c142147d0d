// WorkQueue: a first-in, first-out queue of items, and the loop of the threads that work on them.
//
// Invariants
//   An added item waits, then exactly one thread works on the item, then the queue removes it.
//   A thread in run() takes the first waiting item, or the first waiting item that its `choose` accepts.
//   After close() or finish() no thread waits for items.
#pragma once

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <iterator>
#include <list>
#include <mutex>
#include <utility>

namespace octopair {

/// Thread safety: all functions may be called from any thread. The owner joins its threads before the queue is destroyed.
template <typename Item>
class WorkQueue {
public:
    using Items = std::list<Item>;

    /// Appends an item and wakes a thread.
    void add(Item item) {
        Items added;
        added.push_back(std::move(item));
        const std::lock_guard lock(mutex_);
        append(added);
    }

    /// Appends an item. Removes the waiting items for which is_obsolete(item) holds, each time the queue has doubled.
    /// Complexity: constant on average.
    template <typename IsObsolete>
    void add(Item item, const IsObsolete& is_obsolete) {
        Items added;
        added.push_back(std::move(item));
        const std::lock_guard lock(mutex_);
        if (waiting_.size() >= clean_at_) {
            waiting_.remove_if(is_obsolete);
            clean_at_ = std::max(smallest_to_clean, 2 * waiting_.size());
        }
        append(added);
    }

    /// Calls work(item) for one item after another on the calling thread, until close() or finish(). `work` must not throw.
    template <typename Work>
    void run(const Work& work) {
        constexpr std::chrono::hours never(1);
        run([](Items& waiting) { return waiting.begin(); }, never, work);
    }

    /// Calls work(item) for one item after another, which `choose` selects: choose(waiting) returns an iterator to the next item, or
    /// waiting.end() if no waiting item can be worked on yet. `choose` runs with the queue locked; it is called again after `retry`.
    template <typename Choose, typename Work>
    void run(const Choose& choose, std::chrono::nanoseconds retry, const Work& work) {
        constexpr std::chrono::hours rarely(1);
        run(choose, retry, work, Idle{rarely, [] {}});
    }

    /// A thread in run() calls `task` whenever no item waits for the time `after`. `task` runs with the queue unlocked.
    template <typename Task>
    struct Idle {
        std::chrono::nanoseconds after;
        Task task;
    };
    template <typename Task>
    Idle(std::chrono::nanoseconds, Task) -> Idle<Task>;

    template <typename Choose, typename Work, typename Task>
    void run(const Choose& choose, std::chrono::nanoseconds retry, const Work& work, const Idle<Task>& idle) {
        std::unique_lock lock(mutex_);
        const auto take_next = [&] { return take(lock, choose, retry, idle); };
        for (auto next = take_next(); next != in_work_.end(); next = take_next()) {
            lock.unlock();
            work(*next);
            Items done;
            lock.lock();
            done.splice(done.begin(), in_work_, next);
            if (is_idle()) idle_.notify_all();
            lock.unlock();
            done.clear();  // with the queue unlocked: an item's destructor may take long, or add another item
            lock.lock();
        }
    }

    /// Lets run() return after the item in work; waiting items stay.
    void close() { end(End::now); }
    /// Lets run() return once no item waits.
    void finish() { end(End::when_empty); }

    /// Returns once no item waits or is in work.
    void wait_until_idle() {
        std::unique_lock lock(mutex_);
        idle_.wait(lock, [&] { return is_idle(); });
    }

    std::size_t waiting() const {
        const std::lock_guard lock(mutex_);
        return waiting_.size();
    }

    /// Returns copies of all items: first the items in work, then the waiting items in their order.
    std::list<Item> items() const {
        const std::lock_guard lock(mutex_);
        Items all = in_work_;
        all.insert(all.end(), waiting_.begin(), waiting_.end());
        return all;
    }

    /// Returns how many items wait before the first one for which is_wanted(item) holds; 0 if none does.
    template <typename IsWanted>
    std::size_t waiting_before(const IsWanted& is_wanted) const {
        const std::lock_guard lock(mutex_);
        const auto found = std::ranges::find_if(waiting_, is_wanted);
        return found == waiting_.end() ? 0 : std::size_t(std::distance(waiting_.begin(), found));
    }

private:
    enum class End : unsigned char { never, when_empty, now };
    static constexpr std::size_t smallest_to_clean = 64;

    bool is_idle() const { return waiting_.empty() && in_work_.empty(); }

    void append(Items& added) {
        waiting_.splice(waiting_.end(), added);
        changed_.notify_one();
    }

    void end(End end) {
        const std::lock_guard lock(mutex_);
        end_ = end;
        changed_.notify_all();
    }

    /// Waits for an item and moves the item to `in_work_`. Returns in_work_.end() if run() must return.
    template <typename Choose, typename Task>
    typename Items::iterator take(std::unique_lock<std::mutex>& lock, const Choose& choose,
                                  std::chrono::nanoseconds retry, const Idle<Task>& idle) {
        for (;;) {
            if (end_ == End::now || (end_ == End::when_empty && waiting_.empty())) return in_work_.end();
            const auto chosen = waiting_.empty() ? waiting_.end() : choose(waiting_);
            if (chosen != waiting_.end()) {
                in_work_.splice(in_work_.end(), waiting_, chosen);
                return std::prev(in_work_.end());
            }
            if (!waiting_.empty()) {
                changed_.wait_for(lock, retry);
            } else if (changed_.wait_for(lock, idle.after) == std::cv_status::timeout && waiting_.empty()) {
                lock.unlock();
                idle.task();
                lock.lock();
            }
        }
    }

    mutable std::mutex mutex_;
    std::condition_variable changed_, idle_;
    Items waiting_, in_work_;
    std::size_t clean_at_ = smallest_to_clean;
    End end_ = End::never;
};

}  // namespace octopair
