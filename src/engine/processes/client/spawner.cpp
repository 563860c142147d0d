#include "engine/processes/client/spawner.hpp"

#include <unistd.h>

#include <condition_variable>
#include <csignal>
#include <mutex>
#include <thread>

namespace octopair {

namespace {

class Spawner {
public:
    Spawner() : owner_(::getpid()) {
        // The thread takes no signals: they belong to the threads of the application.
        sigset_t all, before;
        ::sigfillset(&all);
        ::pthread_sigmask(SIG_SETMASK, &all, &before);
        try {
            std::thread([this] { serve(); }).detach();
        } catch (...) {
            ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
            throw;
        }
        ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
    }

    pid_t owner() const { return owner_; }

    void run(const std::function<void()>& work) {
        const std::lock_guard one_at_a_time(callers_);
        std::unique_lock lock(mutex_);
        work_ = &work;
        changed_.notify_all();
        changed_.wait(lock, [this] { return work_ == nullptr; });
    }

private:
    [[noreturn]] void serve() {
        std::unique_lock lock(mutex_);
        for (;;) {
            changed_.wait(lock, [this] { return work_ != nullptr; });
            (*work_)();
            work_ = nullptr;
            changed_.notify_all();
        }
    }

    const pid_t owner_;
    std::mutex callers_, mutex_;
    std::condition_variable changed_;
    const std::function<void()>* work_ = nullptr;
};

}  // namespace

void run_on_spawner(const std::function<void()>& work) {
    static Spawner* const spawner = new Spawner;  // never destroyed, because its thread never ends
    spawner->owner() == ::getpid() ? spawner->run(work) : work();
}

}  // namespace octopair
