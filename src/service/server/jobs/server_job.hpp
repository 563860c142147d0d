// ServerJob: one job on the server, from its first message until it is removed.
//
//   uploading → queued → running → done | failed | cancelled
//
// A running detached job becomes queued again if there is no room for its result. It runs again from its input when there is.
//
// Invariants:
//  - done, failed and cancelled are terminal states.
//  - Every watcher is called after every change of state, and after new pairs or progress. A watcher reads the job's state
//    itself.
//  - The input is freed when the job ends. The pairs live as long as the job.
//  - A detached job has a record. Its input is read from the record just before the job runs.
//  - A detached job enters a terminal state only after the record was asked to store the ending.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "octopair/engine.hpp"
#include "service/protocol/octopair.pb.h"
#include "service/server/jobs/budget.hpp"
#include "service/server/jobs/job_record.hpp"
#include "service/server/jobs/kept_pairs.hpp"
#include "service/server/jobs/uploaded_input.hpp"
#include "service/server/jobs/watchdog.hpp"

namespace octopair::service {

/// Callback for changes of a job. Called on any thread, with no lock held. Requires: job_changed() does not block.
class JobWatcher {
public:
    virtual ~JobWatcher() = default;
    virtual void job_changed() = 0;
};

class ServerJob final : public Watched, public std::enable_shared_from_this<ServerJob> {
public:
    using Clock = std::chrono::steady_clock;

    struct Parts {
        std::string owner;                     ///< client that submitted the job; other clients cannot find the job
        v1::JobSpec spec;                      ///< checked by check() of job_spec.hpp
        std::unique_ptr<UploadedInput> input;  ///< detached job: null except while the job runs
        std::shared_ptr<JobRecord> record;     ///< null for an attached job
        std::shared_ptr<KeptPairs> pairs;
        Budget::Reservation memory;                            ///< for the input and the search
        Budget::Reservation slot;                              ///< slot of a job, held until the job ends
        double max_seconds = 0;                                ///< maximum run time; 0: no limit
        std::uint64_t buffer_bytes = std::uint64_t(64) << 20;  ///< Options::buffer_bytes of the search
        /// Called after each change of state, with no lock held; may be null.
        std::function<void(const ServerJob&, v1::JobState from, v1::JobState to)> on_state_change;
    };

    explicit ServerJob(Parts parts) : parts_(std::move(parts)) {}
    ServerJob(const ServerJob&) = delete;
    ServerJob& operator=(const ServerJob&) = delete;

    const std::string& owner() const { return parts_.owner; }
    const v1::JobSpec& spec() const { return parts_.spec; }
    bool detached() const { return parts_.record != nullptr; }

    /// Requires: the job is uploading. For the uploading call only.
    UploadedInput& input() { return *parts_.input; }
    /// Changes the state from uploading to queued. Requires: the input is complete.
    void queue();
    /// Restores a job that ended under an earlier server, or that cannot run. Called instead of queue().
    void set_ended(const v1::JobReport& ending);
    /// Returns whether the job can run now, and reserves the memory of a detached job. False: the memory is not free yet.
    bool ask_memory();
    /// Returns whether the job is queued and there is no room for its result.
    bool waits_for_room();
    enum class Ran : std::uint8_t { ended, queued_again };
    /// Runs the job on the calling thread. The job then has ended, or is queued again if its result did not fit on the disk.
    Ran run(const std::shared_ptr<Engine>& engine) noexcept;
    /// Stops the job without storing an ending, so that the next server runs the job again. Has no effect on a job that has ended, or that
    /// cancel() or fail() is ending.
    void abandon();

    /// Ends the job as soon as possible, cancelled or failed for the given reason. Thread safety: this and all members below
    /// are safe.
    void cancel() { end_early({}); }
    void fail(v1::Failure why) { end_early(std::move(why)); }

    v1::JobState state() const;
    bool ended() const;
    v1::JobReport report() const;
    /// Returns the hash of input and options; empty while the job is uploading.
    std::string input_hash() const;
    /// Fails the job if it has run longer than `max_seconds`.
    void check_deadline(Clock::time_point now) override;
    bool is_over() const override { return ended(); }
    std::optional<Clock::time_point> ended_at() const;
    /// Returns how long the job waited for an engine before it ran, or has waited so far, in seconds.
    double queue_seconds() const;
    /// Returns the run time so far, or of the whole run, in seconds.
    double seconds() const;
    const KeptPairs& pairs() const { return *parts_.pairs; }
    /// Returns null for an attached job.
    const std::shared_ptr<JobRecord>& record() const { return parts_.record; }

    void watch(const std::shared_ptr<JobWatcher>& watcher);

private:
    using Ending = std::optional<v1::Failure>;  // empty: cancelled

    void end_early(const Ending& why);
    Summary find(Engine& engine, const Options& options);
    Options options();
    void report_progress(double done);
    void end_done(const Summary& summary);
    bool queue_again(const NoRoomError& why) noexcept;
    void end_failed(v1::Failure failure) noexcept;
    v1::JobReport ending(v1::JobState state, const v1::Failure& failure) const;
    void store_ending(const v1::JobReport& ending) noexcept;
    void end_in_queue();
    void set_ended(v1::JobState state) noexcept;
    void requeue() noexcept;
    bool is_terminal() const { return state_ != v1::UPLOADING && state_ != v1::QUEUED && state_ != v1::RUNNING; }
    void notify_watchers() noexcept;

    Parts parts_;
    std::stop_source stop_;
    std::atomic<double> progress_ = 0;
    Clock::time_point last_progress_report_{};  // used by the running thread only

    mutable std::mutex mutex_;
    v1::JobState state_ = v1::UPLOADING;
    v1::JobState reported_state_ = v1::UPLOADING;  // state that on_state_change was last called with
    std::optional<Ending> early_;
    bool abandoned_ = false;
    bool needs_room_ = false;  // the result did not fit on the disk, and the job is queued again
    std::string hash_;
    std::uint32_t algorithm_ = algorithm_version;
    v1::Summary summary_;
    v1::Failure failure_;
    Clock::time_point queued_{}, began_{}, ended_{};
    std::vector<std::weak_ptr<JobWatcher>> watchers_;
};

}  // namespace octopair::service
