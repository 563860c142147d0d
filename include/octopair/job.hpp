// Jobs: work that is submitted to an engine, done on a thread of its own, and collected later.
//
// Result    what the direct call gives (engine.hpp): the same pairs, the same bytes.
// Order     an engine runs its jobs one after another, as they were submitted; direct calls take turns with them.
// Ownership a job keeps OwnedObjects until it has ended. BorrowedObjects, and what a sink or a progress refers to, the
//           caller keeps alive and unchanged until then.
// Errors    a job fails by the Error that the direct call would throw; what else a sink or a progress throws becomes
//           Error{engine_failed} with its words. Neither may call the job's engine or wait for a job of it (submit and
//           cancel they may).
// Threads   the members of one Job may be called from several threads at once, but for assigning, moving, destroying.
// Cost      submitting moves the objects and takes a lock; the first job of an engine starts its thread.
#pragma once

#include <chrono>
#include <concepts>
#include <cstdint>
#include <memory>
#include <utility>
#include <variant>
#include <vector>

#include "octopair/box_array.hpp"
#include "octopair/input.hpp"
#include "octopair/objects.hpp"
#include "octopair/pair_list.hpp"
#include "octopair/summary.hpp"

namespace octopair {

class Job;

namespace detail {  // not for users
class JobTask;
Job make_job(std::shared_ptr<JobTask> task) noexcept;
}  // namespace detail

/// `done`, `failed` and `cancelled` are terminal states.
enum class JobState : std::uint8_t {
    queued,     ///< others are before it
    running,    ///< its turn, unless a direct call is still under way
    done,       ///< summary and pairs are there
    failed,     ///< its Error is
    cancelled,  ///< by the handle, by the engine's end, or by an Error{cancelled} of its sink or progress
};

using OwnedBoxes = std::variant<std::vector<Box3f>, std::vector<Box3d>, BoxArray<Box3f>, BoxArray<Box3d>>;

/// Objects (objects.hpp) that a job keeps. Boxes alone convert: submit(boxes) copies a vector, submit(std::move(boxes))
/// hands it over, as it does a BoxArray.
struct OwnedObjects {
    template <typename Source>
        requires(std::constructible_from<OwnedBoxes, Source>)
    // NOLINTNEXTLINE(google-explicit-constructor): boxes are objects.
    OwnedObjects(Source source, std::vector<double> paddings = {})
        : boxes(std::move(source)), padding(std::move(paddings)) {}

    OwnedBoxes boxes;
    std::vector<double> padding;  ///< empty, or one clearance per object
};

/// Objects that stay the caller's, who keeps the arrays alive and unchanged until the job has ended.
class BorrowedObjects {
public:
    const Objects& objects() const noexcept { return objects_; }

private:
    friend BorrowedObjects borrowed(const Objects& objects);
    explicit BorrowedObjects(const Objects& objects) : objects_(objects) {}

    Objects objects_;
};
inline BorrowedObjects borrowed(const Objects& objects) { return BorrowedObjects(objects); }

using JobObjects = std::variant<OwnedObjects, BorrowedObjects>;

using JobJoin = JoinOf<JobObjects>;
/// The objects of a job: JobObjects, or JobJoin{first, second}.
using JobInput = InputOf<JobObjects>;

/// The handle of a job. Destroying it or assigning over it cancels the job and waits until the engine has let go of its
/// input, sink and progress; only within these themselves it does not wait. May outlive the engine, whose end cancels
/// its jobs.
///
/// One that was default-constructed or moved from has no job: it says `cancelled`, no progress, and ended; summary()
/// and take_pairs() throw Error{usage}.
class Job {
public:
    Job() noexcept = default;
    Job(Job&&) noexcept = default;
    Job& operator=(Job&& other) noexcept;
    ~Job();

    bool valid() const noexcept { return task_ != nullptr; }  ///< has a job
    JobState state() const noexcept;
    double progress() const noexcept;  ///< 0 to 1, never falling; 1 when done

    /// Until the job has ended. Throws Error{usage} where that would be for ever: in a sink or a progress of its
    /// engine's jobs.
    void wait() const;
    /// As long at the most, and no longer than a year; whether the job has ended.
    template <typename Rep, typename Period>
    bool wait_for(std::chrono::duration<Rep, Period> time) const;
    template <typename Clock, typename Duration>
    bool wait_until(std::chrono::time_point<Clock, Duration> time) const;

    /// Ends the job: at once if it is queued, else within 200 ms (or when its sink or progress returns), by `done` if
    /// that was nearer. Does not wait for it. Does nothing if the job has ended or was cancelled before.
    void cancel() noexcept;

    /// Waits. Throws the job's own Error if it failed, Error{cancelled} if it was cancelled.
    Summary summary() const;
    /// Waits, throws as summary(); and Error{usage} the second time, or if the pairs went to a sink.
    PairList take_pairs();

private:
    friend Job detail::make_job(std::shared_ptr<detail::JobTask> task) noexcept;
    explicit Job(std::shared_ptr<detail::JobTask> task) noexcept;
    bool wait_at_most(std::chrono::nanoseconds time) const;
    void let_go() noexcept;

    std::shared_ptr<detail::JobTask> task_;
};

template <typename Rep, typename Period>
bool Job::wait_for(std::chrono::duration<Rep, Period> time) const {
    constexpr std::chrono::hours year(24 * 365);
    if (!(time > time.zero())) return wait_at_most({});
    return wait_at_most(time > year ? year : std::chrono::ceil<std::chrono::nanoseconds>(time));
}

template <typename Clock, typename Duration>
bool Job::wait_until(std::chrono::time_point<Clock, Duration> time) const {
    for (;;) {
        const auto now = Clock::now();
        if (now >= time) return wait_at_most({});
        if (wait_for(time - now)) return true;
    }
}

}  // namespace octopair
