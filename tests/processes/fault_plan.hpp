// A plan of faults for worker processes, in memory that a test shares with its workers (faulty_worker.cpp).
//
// A fault belongs to a step. After a given number of shares of the step, the worker that begins the next share takes
// the fault. The fault happens at its planned moment. Faults are taken one after another.
#pragma once

#include <sys/mman.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <span>

#include "base/descriptor.hpp"
#include "engine/processes/shared_memory/layout.hpp"

namespace octopair::test {

/// `mute`: the worker fails without a message and stays alive. This is not counted as a loss.
enum class FaultKind : std::uint32_t { kill, crash, stop, mute };
/// In a share: at its begin, while it runs, in its commit (CommitPoint), or when it is committed but not yet marked done.
enum class Moment : std::uint32_t { begin, tick, before_commit, in_commit, end };
inline constexpr std::size_t moments = 5;

struct Fault {
    Step step = Step::encode;
    FaultKind kind = FaultKind::kill;
    Moment moment = Moment::begin;
    std::uint32_t ticks = 0;    ///< Moment::tick: index of the tick. A share without the moment fails at its end
    std::uint32_t pass_by = 0;  ///< number of shares of the step to skip
};

/// Number of lost workers, by step and kind.
using FaultCounts = std::array<std::array<std::uint64_t, 3>, step_names.size()>;

struct FaultPlan {
    static constexpr std::uint32_t most = 64;
    std::atomic<std::uint32_t> next, end;  ///< indices into `faults`
    std::atomic<std::uint32_t> passed;     ///< number of shares skipped for the next fault
    std::array<Fault, most> faults;
    std::array<std::array<std::atomic<std::uint64_t>, 3>, step_names.size()> happened;
    std::array<std::atomic<std::uint64_t>, moments> in_scan;  ///< faults that happened in shares of the scan, by moment
};

inline constexpr const char* plan_variable = "OCTOPAIR_TEST_FAULTS";    // environment variable: the file of the plan
inline constexpr const char* damage_variable = "OCTOPAIR_TEST_DAMAGE";  // environment variable: the seed of the damage

/// Maps the plan into memory.
class MappedPlan {
public:
    /// Makes an empty plan, and names its file in the environment of this process until destruction.
    MappedPlan();
    /// Selects the plan that the environment names. operator-> must not be used if there is no such plan.
    struct Named {};
    explicit MappedPlan(Named named);
    ~MappedPlan();
    MappedPlan(const MappedPlan&) = delete;
    MappedPlan& operator=(const MappedPlan&) = delete;

    FaultPlan* operator->() const { return plan_; }
    explicit operator bool() const { return plan_ != nullptr; }

    /// Replaces the remaining faults.
    void set(std::span<const Fault> faults);
    /// Returns whether all faults have been taken.
    bool empty() const { return plan_->next.load() >= plan_->end.load(); }
    FaultCounts happened() const;

private:
    void map();

    Descriptor file_;
    FaultPlan* plan_ = nullptr;
    bool named_ = false;
};

}  // namespace octopair::test
