#include "engine/processes/worker/worker.hpp"

#include <poll.h>
#include <unistd.h>

#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "base/floating_point.hpp"
#include "engine/processes/shared_memory/control_messages.hpp"
#include "engine/processes/worker/worker_pass.hpp"
#include "engine/processes/worker_limits.hpp"
#include "octopair/error.hpp"

namespace octopair {

namespace {

/// The stop source of the pass under way, and which pass was stopped last.
class Stops {
public:
    std::stop_token begin(std::uint32_t pass) {
        const std::lock_guard lock(mutex_);
        pass_ = pass;
        source_ = {};
        if (stopped_ == pass) source_.request_stop();
        return source_.get_token();
    }
    void stop(std::uint32_t pass) {
        const std::lock_guard lock(mutex_);
        stopped_ = pass;
        if (pass_ == pass) source_.request_stop();
    }

private:
    std::mutex mutex_;
    std::stop_source source_;
    std::uint32_t pass_ = 0, stopped_ = 0;
};

class Worker {
public:
    Worker(Descriptor socket, unsigned slot, ShareObserver* observer)
        : socket_(std::move(socket)), number_(slot), observer_(observer), parent_(::getppid()) {}

    /// Takes what the client sends, until it is gone.
    void read_mail() {
        while (client_lives()) {
            std::optional<ReceivedMessage> received = receive_message(socket_);
            if (!received) return;
            const ControlMessage& message = received->message;
            switch (message.kind) {
                case ControlMessageKind::region:
                    take_region(message, std::move(received->file));
                    break;
                case ControlMessageKind::forget:
                    regions_.forget(message.number);
                    forgot_.store(true);
                    if (ControlBlockView* const view = view_) view->slot(number_).command.raise();
                    break;
                case ControlMessageKind::stop:
                    stop(message.number);
                    break;
            }
        }
    }

    [[noreturn]] void work() {
        const FloatingPointScope scope;
        const auto memory = regions_.get(control_region);
        ControlBlockView view(*memory);
        if (view.control_block().client != ::getppid()) throw Error(ErrorCode::engine_failed, "the client is gone");
        if (number_ >= view.slots()) throw Error(ErrorCode::engine_failed, "there is no such slot");
        view_ = &view;
        WorkerProgram program(view, regions_);
        Slot& slot = view.slot(number_);
        slot.attached.store(1);
        view.control_block().for_client.raise();
        for (;;) {
            const std::uint32_t seen = slot.command.count.load();
            const std::uint32_t asked = slot.asked.load();
            if (asked == slot.finished.load()) {
                if (forgot_.exchange(false)) program.forget_job();
                const WaitingMark waiting(slot);
                slot.command.wait(seen, worker_limits::max_command_sleep, worker_limits::max_spins_for_pass);
                continue;
            }
            const Pass pass = view.control_block().pass;
            const std::stop_token token = stops_.begin(asked);
            if (view.control_block().stopped.load() == asked) stops_.stop(asked);
            program.run(pass, {number_, asked, observer_}, token);
            slot.finished.store(asked);
            view.control_block().for_client.raise();
            // It has told why; another will be sent what this one could not take.
            if (regions_.failed()) throw Error(ErrorCode::resource_limit, "shared memory could not be taken");
        }
    }

private:
    void take_region(const ControlMessage& message, Descriptor file) {
        try {
            regions_.add(message.number, SharedMemory::open(std::move(file), message.bytes));
        } catch (...) {
            regions_.fail(std::current_exception());
        }
    }

    /// Waits for message or the end of the client. Its process is looked for as well: a copy of its end of the socket may
    /// live on in some child that it forked.
    bool client_lives() const {
        for (;;) {
            pollfd waiting{socket_.number(), POLLIN, 0};
            const int ready = ::poll(&waiting, 1, int(worker_limits::client_check_interval.count()));
            if (ready > 0) return true;
            if (::getppid() != parent_) return false;
        }
    }

    void stop(std::uint32_t pass) {
        stops_.stop(pass);
        if (ControlBlockView* const view = view_) {
            view->control_block().among_workers.raise();
            view->slot(number_).command.raise();
        }
    }

    Descriptor socket_;
    const unsigned number_;
    ShareObserver* observer_;
    const pid_t parent_;
    WorkerRegions regions_;
    Stops stops_;
    std::atomic<ControlBlockView*> view_ = nullptr;
    std::atomic<bool> forgot_ = false;
};

}  // namespace

void run_worker(Descriptor socket, unsigned slot, ShareObserver* observer, const std::function<void()>& gone) {
    // It stays until the process ends, with the thread that reads its message.
    static Worker worker(std::move(socket), slot, observer);
    std::thread([gone] {
        try {
            worker.read_mail();
        } catch (...) {
            // Without its message it is of no use; the client starts another.
        }
        gone();
    }).detach();
    worker.work();
}

}  // namespace octopair
