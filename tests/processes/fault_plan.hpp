// A plan of faults for worker processes, in memory that a test shares with the workers that follow it
// (faulty_worker.cpp).
//
// A fault waits for its step: the next worker that begins a share of it, after some that it lets pass, takes it and lets
// it happen at its moment. Faults are taken one after another.
#pragma once

#include <sys/mman.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <span>
#include <string>

#include "base/descriptor.hpp"
#include "engine/processes/shared_memory/layout.hpp"

namespace octopair::test {

/// `mute`: the worker fails and does not say why; it lives on, so that this is no loss and not counted.
enum class FaultKind : std::uint32_t { kill, crash, stop, mute };
enum class Moment : std::uint32_t { begin, tick, end };

struct Fault {
    Step step = Step::encode;
    FaultKind kind = FaultKind::kill;
    Moment moment = Moment::begin;
    std::uint32_t ticks = 0;    ///< tick: which one; where there are fewer, the end
    std::uint32_t pass_by = 0;  ///< shares of the step to let pass
};

/// How many workers were lost, by step and kind.
using FaultCounts = std::array<std::array<std::uint64_t, 3>, step_names.size()>;

struct FaultPlan {
    static constexpr std::uint32_t most = 64;
    std::atomic<std::uint32_t> next, end;  ///< of the faults below
    std::atomic<std::uint32_t> passed;     ///< shares that the next fault has let pass
    std::array<Fault, most> faults;
    std::array<std::array<std::atomic<std::uint64_t>, 3>, step_names.size()> happened;
};

inline constexpr const char* plan_variable = "OCTOPAIR_TEST_FAULTS";    // in the environment: the plan's file
inline constexpr const char* damage_variable = "OCTOPAIR_TEST_DAMAGE";  // a seed: what to write where

/// The plan, mapped.
class MappedPlan {
public:
    /// An empty plan, which the environment of this process names as long as it lives.
    MappedPlan();
    /// The one that the environment names; operator-> must not be used if there is none.
    struct Named {};
    explicit MappedPlan(Named named);
    ~MappedPlan();
    MappedPlan(const MappedPlan&) = delete;
    MappedPlan& operator=(const MappedPlan&) = delete;

    FaultPlan* operator->() const { return plan_; }
    explicit operator bool() const { return plan_ != nullptr; }

    /// Replaces what is left of the faults.
    void set(std::span<const Fault> faults);
    /// Whether all have been taken.
    bool empty() const { return plan_->next.load() >= plan_->end.load(); }
    FaultCounts happened() const;

private:
    void map();

    Descriptor file_;
    FaultPlan* plan_ = nullptr;
    bool named_ = false;
};

}  // namespace octopair::test
