// Overseer: looks at all that must not take for ever, ten times a second, by a clock that nobody can set.
#pragma once

#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace octopair::service {

class LimitError;

class Overseen {
public:
    virtual ~Overseen() = default;
    /// From the overseer's thread; must not block.
    virtual void look(std::chrono::steady_clock::time_point now) = 0;
    /// It need not be looked at any more.
    virtual bool is_over() const { return false; }
};

/// Thread-safe.
class Overseer {
public:
    Overseer();
    Overseer(const Overseer&) = delete;
    Overseer& operator=(const Overseer&) = delete;
    ~Overseer();

    /// As long as it lives.
    void watch(const std::shared_ptr<Overseen>& overseen);

private:
    void look_around();

    std::mutex mutex_;
    std::condition_variable changed_;
    std::vector<std::weak_ptr<Overseen>> overseen_;
    bool ending_ = false;
    std::thread thread_;
};

/// The limit that `what` ("the job") ran into.
LimitError ran_too_long(const std::string& what, double most_seconds);

}  // namespace octopair::service
