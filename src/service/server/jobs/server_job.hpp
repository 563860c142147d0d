// ServerJob: one job on the server, from its first message until it is forgotten.
//
//   uploading → queued → running → done | failed | cancelled
//
// Whoever waits for it watches it: a watcher is told of every change, and looks for itself. The input goes as soon as the
// job has ended; the pairs stay as long as the job does.
//
// A detached job has a record: its input is read from there when its turn comes, and it has ended only when that is kept
// there.
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
#include "service/server/jobs/job_table.hpp"
#include "service/server/jobs/kept_pairs.hpp"
#include "service/server/jobs/watchdog.hpp"
#include "service/server/jobs/uploaded_input.hpp"

namespace octopair::service {

/// Told of changes, from any thread and with no lock held; must not block.
class JobWatcher {
public:
    virtual ~JobWatcher() = default;
    virtual void job_changed() = 0;
};

class ServerJob final : public Watched, public std::enable_shared_from_this<ServerJob> {
public:
    using Clock = std::chrono::steady_clock;

    struct Parts {
        std::string owner;                     ///< who submitted it: others do not see it
        v1::JobSpec spec;                      ///< checked
        std::unique_ptr<UploadedInput> input;  ///< of a detached job: while it runs
        std::shared_ptr<JobRecord> record;     ///< of a detached job
        std::shared_ptr<KeptPairs> pairs;
        Budget::Reservation memory;                                  ///< for the input and for finding the pairs
        ClientCounts::Place place;                             ///< until it has ended
        double most_seconds = 0;                               ///< that it may run; 0: no limit
        std::uint64_t buffer_bytes = std::uint64_t(64) << 20;  ///< for pairs that are put in order
        /// Told of each change of state, with no lock held; null: nobody.
        std::function<void(const ServerJob&, v1::JobState from, v1::JobState to)> moved;
    };

    explicit ServerJob(Parts parts) : parts_(std::move(parts)) {}
    ServerJob(const ServerJob&) = delete;
    ServerJob& operator=(const ServerJob&) = delete;

    const std::string& owner() const { return parts_.owner; }
    const v1::JobSpec& spec() const { return parts_.spec; }
    bool detached() const { return parts_.record != nullptr; }

    /// While uploading, for the one who uploads.
    UploadedInput& input() { return *parts_.input; }
    /// The input is complete.
    void queue();
    /// Instead of that: it has ended, before the server began.
    void set_ended(const v1::JobReport& ending);
    /// It can run now: what it needs is there. Asked by a lane, with the next job at hand if not.
    bool ask_memory();
    /// On a lane's thread.
    void run(Engine& engine) noexcept;
    /// Stops it without an end, unless it was told to end before: it is for the next server.
    void abandon();

    /// Ends the job as soon as it can be: cancelled, or failed for the given reason. Thread-safe, as all from here on.
    void cancel() { end_early({}); }
    void fail(v1::Failure why) { end_early(std::move(why)); }

    v1::JobState state() const;
    bool ended() const;
    v1::JobReport report() const;
    /// Of a complete input and the options.
    std::string input_hash() const;
    /// Ends the job if it has run too long.
    void look(Clock::time_point now) override;
    bool is_over() const override { return ended(); }
    std::optional<Clock::time_point> ended_at() const;
    /// That it has run, or ran.
    double seconds() const;
    const KeptPairs& pairs() const { return *parts_.pairs; }
    /// None of an attached job.
    const std::shared_ptr<JobRecord>& record() const { return parts_.record; }

    void watch(const std::shared_ptr<JobWatcher>& watcher);

private:
    using Ending = std::optional<v1::Failure>;  // none: cancelled

    void end_early(const Ending& why);
    Summary find(Engine& engine, const Options& options);
    Options options();
    void tell_progress(double done);
    void end_well(const Summary& summary);
    void end_by(v1::Failure failure) noexcept;
    v1::JobReport ending(v1::JobState state, const v1::Failure& failure) const;
    void keep(const v1::JobReport& ending) noexcept;
    void end_in_queue();
    void set_ended(v1::JobState state) noexcept;
    void set_waiting() noexcept;
    bool is_last() const { return state_ != v1::UPLOADING && state_ != v1::QUEUED && state_ != v1::RUNNING; }
    void tell() noexcept;

    Parts parts_;
    std::stop_source stop_;
    std::atomic<double> progress_ = 0;
    Clock::time_point told_{};  // the running thread's

    mutable std::mutex mutex_;
    v1::JobState state_ = v1::UPLOADING;
    v1::JobState moved_ = v1::UPLOADING;  // that others have been told of
    std::optional<Ending> early_;
    bool abandoned_ = false;
    std::string hash_;
    std::uint32_t algorithm_ = algorithm_version;
    v1::Summary summary_;
    v1::Failure failure_;
    Clock::time_point began_{}, ended_{};
    std::vector<std::weak_ptr<JobWatcher>> watchers_;
};

}  // namespace octopair::service
