#include "engine/processes/worker/worker.hpp"

#include <poll.h>
#include <unistd.h>

#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "base/floating_point_scope.hpp"
#include "engine/processes/shared_memory/control_messages.hpp"
#include "engine/processes/worker/pass_runner.hpp"
#include "engine/processes/worker_timeouts.hpp"
#include "octopair/error.hpp"

namespace octopair {

namespace {

/// Stop source of the current pass, and number of the pass that was stopped last.
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

    /// Handles messages of the client until the client has ended.
    void read_messages() {
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
        if (view.control_block().client != ::getppid())
            throw Error(ErrorCode::engine_failed, "the client process has ended");
        if (number_ >= view.slots())
            throw Error(ErrorCode::engine_failed,
                        "the control block has no slot of the number given on the command line");
        view_ = &view;
        PassRunner program(view, regions_);
        Slot& slot = view.slot(number_);
        slot.attached.store(1);
        view.control_block().for_client.raise();
        for (;;) {
            const std::uint32_t seen = slot.command.count.load();
            const std::uint32_t requested = slot.requested.load();
            if (requested == slot.finished.load()) {
                if (forgot_.exchange(false)) program.forget_job();
                const WaitingMark waiting(slot);
                slot.command.wait(seen, worker_timeouts::max_command_sleep, worker_timeouts::max_spins_for_pass);
                continue;
            }
            const Pass pass = view.control_block().pass;
            const std::stop_token token = stops_.begin(requested);
            if (view.control_block().stopped.load() == requested) stops_.stop(requested);
            program.run(pass, {number_, requested, observer_}, token);
            slot.finished.store(requested);
            view.control_block().for_client.raise();
            // The pass has reported the failure. End this process: its replacement receives all regions again.
            if (regions_.failed())
                throw Error(ErrorCode::resource_limit, "cannot map a region of shared memory that the client sent");
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

    /// Waits for a message. Returns false if the client has ended. Also checks the parent process: a child that the client
    /// forked may keep the client's end of the socket open.
    bool client_lives() const {
        for (;;) {
            pollfd waiting{socket_.number(), POLLIN, 0};
            const int ready = ::poll(&waiting, 1, int(worker_timeouts::client_check_interval.count()));
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
    // Static, because the detached thread below uses the worker until the process ends.
    static Worker worker(std::move(socket), slot, observer);
    std::thread([gone] {
        try {
            worker.read_messages();
        } catch (...) {
            // A worker that cannot read messages is useless. It ends, and the client starts a replacement.
        }
        gone();
    }).detach();
    worker.work();
}

}  // namespace octopair
