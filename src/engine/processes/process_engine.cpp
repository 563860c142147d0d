// The process engine: runs the steps of the algorithm in worker processes that share memory with the application.

#include <algorithm>
#include <memory>

#include "base/control_group.hpp"
#include "base/floating_point_scope.hpp"
#include "engine/job_queue.hpp"
#include "engine/processes/client/process_passes.hpp"
#include "engine/processes/client/worker_pool.hpp"
#include "engine/processes/client/worker_program.hpp"
#include "engine/search.hpp"
#include "engine/ticket_lock.hpp"
#include "octopair/error.hpp"
#include "octopair/processes.hpp"

namespace octopair {

namespace {

unsigned worker_count(unsigned requested) {
    if (requested > max_workers) {
        throw Error(ErrorCode::usage, std::to_string(requested) + " workers; at most " + std::to_string(max_workers));
    }
    return requested > 0 ? requested : std::min(available_cores(), max_workers);
}

class ProcessEngine final : public Engine {
public:
    ProcessEngine(const ProcessOptions& options, const std::string& packaged_worker)
        : pool_(find_worker_program(options.worker_program, packaged_worker), worker_count(options.workers)),
          passes_(pool_, *arrays_),
          search_(passes_) {}

    WorkerFaults faults() const { return pool_.faults(); }

private:
    Summary run(const detail::Request& request, const detail::Output& output, const detail::Control& control) override {
        const TicketLock::Guard turn(ticket_lock_, control.stop);
        return search_.run(request, output, control);
    }
    std::shared_ptr<void> allocate(std::size_t bytes) override { return SharedArrays::allocate(arrays_, bytes); }
    detail::JobQueue& jobs() override { return jobs_; }
    unsigned verification_threads() const override { return passes_.width(); }

    TicketLock ticket_lock_;
    std::shared_ptr<SharedArrays> arrays_ = std::make_shared<SharedArrays>();
    WorkerPool pool_;
    ProcessPasses passes_;
    Search search_;
    detail::JobQueue jobs_{*this};  // last member, so it is destroyed first
};

}  // namespace

std::unique_ptr<Engine> make_process_engine(const ProcessOptions& options, detail::PackagedWorker package) {
    const FloatingPointScope scope;
    return std::make_unique<ProcessEngine>(options, package.path);
}

std::unique_ptr<Engine> make_process_engine(unsigned workers, detail::PackagedWorker package) {
    return make_process_engine(ProcessOptions{.workers = workers}, package);
}

WorkerFaults worker_faults(const Engine& engine) {
    const auto* const processes = dynamic_cast<const ProcessEngine*>(&engine);
    if (processes == nullptr)
        throw Error(ErrorCode::usage, "worker_faults: the engine was not made by make_process_engine");
    return processes->faults();
}

}  // namespace octopair
