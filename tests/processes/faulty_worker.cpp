// A worker that fails: octopair-worker, with planned faults (fault_plan.hpp) and damage to the memory that the worker
// shares with the client (damage.hpp).
#include <signal.h>
#include <unistd.h>

#include <cstdlib>
#include <exception>
#include <memory>
#include <optional>
#include <stdexcept>

#include "engine/processes/worker/worker.hpp"
#include "processes/damage.hpp"
#include "processes/fault_plan.hpp"

namespace octopair::test {
namespace {

[[noreturn]] void end_by(int signal) {
    // A sanitizer may have installed a handler that does not end the process.
    (void)::signal(signal, SIG_DFL);
    (void)::raise(signal);
    ::_exit(99);
}

class PlannedFaults final : public ShareObserver {
public:
    explicit PlannedFaults(MappedPlan& plan) : plan_(plan) {}

    void begin(Step step) override {
        step_ = step;
        // Also drops an earlier fault whose pass ended before the fault's moment.
        fault_ = take(step);
        ticks_ = 0;
        if (fault_ && fault_->moment == Moment::begin) happen(Moment::begin);
    }
    void tick() override {
        if (fault_ && fault_->moment == Moment::tick && ticks_++ == fault_->ticks) happen(Moment::tick);
    }
    void reach(CommitPoint point) override {
        const Moment moment = point == CommitPoint::before ? Moment::before_commit : Moment::in_commit;
        if (fault_ && fault_->moment == moment) happen(moment);
    }
    void end() override {
        if (fault_) happen(Moment::end);
    }

private:
    std::optional<Fault> take(Step step) {
        for (;;) {
            std::uint32_t next = plan_->next.load();
            if (next >= plan_->end.load()) return std::nullopt;
            const Fault fault = plan_->faults.at(next % FaultPlan::most);
            if (fault.step != step) return std::nullopt;
            if (plan_->passed.fetch_add(1) < fault.pass_by) return std::nullopt;
            if (!plan_->next.compare_exchange_strong(next, next + 1)) continue;
            plan_->passed.store(0);
            return fault;
        }
    }

    void happen(Moment moment) {
        const Fault fault = *fault_;
        fault_.reset();
        if (fault.kind == FaultKind::mute) throw std::runtime_error("");
        plan_->happened.at(std::size_t(step_)).at(std::size_t(fault.kind)).fetch_add(1);
        if (step_ == Step::scan) plan_->in_scan.at(std::size_t(moment)).fetch_add(1);
        switch (fault.kind) {
            case FaultKind::kill:
                end_by(SIGKILL);
            case FaultKind::crash:
                end_by(SIGSEGV);
            case FaultKind::stop:
                (void)::raise(SIGSTOP);
                break;
            case FaultKind::mute:
                break;
        }
    }

    MappedPlan& plan_;
    Step step_ = Step::prepare;
    std::optional<Fault> fault_;
    std::uint32_t ticks_ = 0;
};

std::unique_ptr<ShareObserver> make_observer(unsigned slot, MappedPlan& plan) {
    if (const char* const seed = std::getenv(damage_variable)) {
        return make_damage(std::strtoull(seed, nullptr, 10), slot);
    }
    if (plan) return std::make_unique<PlannedFaults>(plan);
    return nullptr;
}

}  // namespace
}  // namespace octopair::test

int main(int count, char** arguments) {
    if (count != 2) return 2;
    const auto slot = unsigned(std::strtoul(arguments[1], nullptr, 10));
    octopair::test::MappedPlan plan{octopair::test::MappedPlan::Named{}};
    const auto observer = octopair::test::make_observer(slot, plan);
    try {
        octopair::run_worker(octopair::Descriptor(octopair::worker_socket), slot, observer.get(), [] { ::_exit(0); });
    } catch (const std::exception&) {
        return 1;
    }
}
