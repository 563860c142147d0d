// ResultReader: a thread that reads pieces of results for the calls that send them. Clients take turns (fair_order.hpp).
//
// Reading and checking a piece of 1 MiB takes some tenths of a millisecond. gRPC has few threads. If gRPC's threads read results, a client
// with many results would delay the calls of all other clients.
#pragma once

#include <chrono>
#include <functional>
#include <set>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

#include "base/work_queue.hpp"
#include "service/server/jobs/fair_order.hpp"

namespace octopair::service {

/// Thread safety: any thread may call it.
class ResultReader {
public:
    ResultReader() : thread_([this] { work(); }) {}
    ResultReader(const ResultReader&) = delete;
    ResultReader& operator=(const ResultReader&) = delete;
    /// Drops the tasks that wait.
    ~ResultReader() {
        tasks_.close();
        thread_.join();
    }

    /// Runs `task` on the reader's thread. Requires: `task` does not throw.
    void add(const std::string& client, std::function<void()> task) { tasks_.add({client, std::move(task)}); }

private:
    struct ReadTask {
        std::string client;
        std::function<void()> run;
    };
    using Tasks = WorkQueue<ReadTask>;

    void work() {
        constexpr std::chrono::hours never(1);
        tasks_.run([this](Tasks::Items& tasks) { return next(tasks); }, never,
                   [](const ReadTask& task) { task.run(); });
    }

    /// Returns the first task of the client whose turn it is.
    Tasks::Items::iterator next(Tasks::Items& tasks) {
        auto chosen = tasks.begin();
        std::set<std::string_view> seen;
        for (auto task = tasks.begin(); task != tasks.end(); ++task) {
            if (!seen.insert(task->client).second) continue;
            if (order_.start_of(task->client) < order_.start_of(chosen->client)) chosen = task;
        }
        order_.begin(chosen->client, 1);
        return chosen;
    }

    Tasks tasks_;
    FairOrder order_;  // used with the queue locked
    std::thread thread_;
};

}  // namespace octopair::service
