// Job: work that is submitted to an engine, runs on the engine's job thread, and is collected later.
//
// Result    The same pairs and the same bytes as from the direct call (engine.hpp).
// Order     An engine runs its jobs one after another, in the order of submission. Direct calls take turns with them.
// Ownership A job owns its OwnedObjects until it has ended. BorrowedObjects, and all that a sink or progress function refers
//           to, must stay alive and unchanged until then.
// Errors    A job fails with the Error that the direct call would throw. Any other exception of a sink or progress function
//           becomes Error{engine_failed} with the same message. In both functions, calls of the job's engine and waiting for its
//           jobs throw Error{usage}; submitting and cancelling is allowed.
// Threads   Several threads may call members of one Job at once, except assignment, move and destruction.
// Cost      submit() moves the objects and takes a lock. The first job of an engine starts its thread.
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

namespace [[gnu::visibility("default")]] octopair {

class Job;

namespace detail {  // not for users
class JobTask;
Job make_job(std::shared_ptr<JobTask> task) noexcept;
}  // namespace detail

/// `done`, `failed` and `cancelled` are terminal states.
enum class JobState : std::uint8_t {
    queued,     ///< waits for earlier jobs
    running,    ///< runs, or waits until the engine has finished a direct call
    done,       ///< summary and pairs are available
    failed,     ///< summary() throws the job's Error
    cancelled,  ///< by its handle, by the destruction of its engine, or by an Error{cancelled} of its callbacks
};

using OwnedBoxes = std::variant<std::vector<Box3f>, std::vector<Box3d>, BoxArray<Box3f>, BoxArray<Box3d>>;

/// Objects (objects.hpp) that a job owns. Boxes convert implicitly: submit(boxes) copies a vector, submit(std::move(boxes))
/// moves a vector or a BoxArray.
struct OwnedObjects {
    template <typename Source>
        requires(std::constructible_from<OwnedBoxes, Source>)
    // NOLINTNEXTLINE(google-explicit-constructor): boxes convert to objects.
    OwnedObjects(Source source, std::vector<double> paddings = {})
        : boxes(std::move(source)), padding(std::move(paddings)) {}

    OwnedBoxes boxes;
    std::vector<double> padding;  ///< empty, or one clearance per object
};

/// Objects that the caller owns. The arrays must stay alive and unchanged until the job has ended.
class BorrowedObjects {
public:
    const Objects& objects() const noexcept { return objects_; }

private:
    friend BorrowedObjects borrowed(const Objects& objects);
    explicit BorrowedObjects(const Objects& objects) : objects_(objects) {}

    Objects objects_;
};
/// Marks `objects` as borrowed: the job does not copy them.
inline BorrowedObjects borrowed(const Objects& objects) { return BorrowedObjects(objects); }

using JobObjects = std::variant<OwnedObjects, BorrowedObjects>;

using JobJoin = JoinOf<JobObjects>;
/// The objects of a job: JobObjects, or JobJoin{first, second}.
using JobInput = InputOf<JobObjects>;

/// The handle of a job. It may outlive the engine, whose destruction cancels its jobs.
///
/// Destruction and assignment cancel the job and wait until the engine has released the job's input, sink and progress
/// function. If this sink or progress function itself destroys or assigns the handle, they do not wait.
///
/// A handle that was default-constructed or moved from has no job. Its state is `cancelled`, its progress is 0, and waiting
/// returns at once; summary() and take_pairs() throw Error{usage}.
class Job {
public:
    Job() noexcept = default;
    Job(Job&&) noexcept = default;
    Job& operator=(Job&& other) noexcept;
    ~Job();

    bool valid() const noexcept { return task_ != nullptr; }  ///< true if this handle has a job
    JobState state() const noexcept;
    double progress() const noexcept;  ///< fraction of the work that is done, 0 to 1; never decreases

    /// Waits until the job has ended. Throws: Error{usage} in a callback of the same engine, because the wait would never end.
    void wait() const;
    /// Waits until the job has ended, but at most for `time` and at most a year. Returns true if the job has ended.
    template <typename Rep, typename Period>
    bool wait_for(std::chrono::duration<Rep, Period> time) const;
    /// Waits until the job has ended, but not beyond `time`. Returns true if the job has ended.
    template <typename Clock, typename Duration>
    bool wait_until(std::chrono::time_point<Clock, Duration> time) const;

    /// Requests that the job ends, and returns at once. A queued job ends immediately; a running one within 200 ms, or when its
    /// sink or progress function returns. A job that is almost finished may still become `done`. No effect on an ended job.
    void cancel() noexcept;

    /// Waits until the job has ended, and returns its summary.
    /// Throws: the job's Error if it failed; Error{cancelled} if it was cancelled; Error{usage} as wait().
    Summary summary() const;
    /// Waits until the job has ended, and returns its pairs.
    /// Throws: as summary(); Error{usage} if the pairs were taken before or went to a sink.
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
