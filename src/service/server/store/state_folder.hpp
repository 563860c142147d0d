// StateFolder: the folder with the files of detached jobs (docs/formats.md).
//
// Invariants:
//  - One server uses a folder at a time.
//  - The file `version` has the version of the folder. A folder of an older version is converted before its jobs are read, one of a newer
//    version is not touched.
//  - N.job exists from the acknowledgement of a submission until the job is removed.
//  - N.result exists from the end of the job until the job is removed.
//  - N increases with every submission. Jobs run in the order of N.
//  - Incomplete files have the ending .part. A server removes them when it starts.
#pragma once

#include <spdlog/fwd.h>

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "base/descriptor.hpp"
#include "base/work_queue.hpp"
#include "octopair/error.hpp"
#include "service/server/jobs/budget.hpp"
#include "service/server/store/state_format.hpp"

namespace octopair::service {

/// Tasks that wait for disks, run one after another on a thread of their own, so that no thread of gRPC waits.
class DiskQueue {
public:
    /// Must not throw.
    using DiskTask = std::function<void()>;

    DiskQueue() : thread_([this] { tasks_.run([](const DiskTask& task) { task(); }); }) {}
    DiskQueue(const DiskQueue&) = delete;
    DiskQueue& operator=(const DiskQueue&) = delete;
    /// Runs all tasks that were added.
    ~DiskQueue() {
        tasks_.finish();
        thread_.join();
    }

    /// Thread safety: may be called from any thread.
    void add(DiskTask task) { tasks_.add(std::move(task)); }

private:
    WorkQueue<DiskTask> tasks_;
    std::thread thread_;
};

class StateFolder {
public:
    /// Disk space that is reserved for a job besides its input and pairs: for its ending, and for partly used file system
    /// blocks.
    static constexpr std::uint64_t overhead_bytes = 16 << 10;

    /// Bytes of disk space. 0: no limit.
    struct Room {
        std::uint64_t total = 0, per_client = 0;  ///< limit for all jobs together, and for the jobs of one client
    };

    /// Creates the folder, private to its owner, if it does not exist, and locks it. Throws: Error{usage} if other users may
    /// access it; Error{io_failed} on failure, if another server uses it, or if it has a newer version.
    StateFolder(std::string path, const Room& room, std::shared_ptr<spdlog::logger> log);

    /// A job that was found in the folder.
    struct Found {
        std::string base;  ///< path of its files without .job or .result
        StoredSpec stored;
        Budget::Reservation disk, result_disk;
        std::optional<StoredResult> result;
        std::optional<Error> damage;  ///< a file is damaged: the job cannot run, or its result cannot be read
    };
    /// Returns the jobs in the order of submission. Files whose owner cannot be read are logged and not touched.
    std::vector<Found> find_jobs();

    /// Returns the base path of a new job. Thread safety: this and all members below are safe.
    std::string new_base();
    Budget& disk() { return disk_; }
    struct DiskSpace {
        std::uint64_t total, free;  ///< size of the folder's disk, and free space that this program may use, in bytes
    };
    /// Returns the space on the folder's disk. If the system does not report the space, both numbers are the greatest 64-bit number.
    DiskSpace disk_space() const;
    DiskQueue& disk_queue() { return disk_queue_; }
    spdlog::logger& log() { return *log_; }

private:
    void lock();
    void check_version() const;
    std::vector<std::uint64_t> clean_up();
    std::optional<Found> find_job(const std::string& base);
    void find_result(Found& found);
    std::string base_of(std::uint64_t number) const;

    const std::string path_;
    const std::shared_ptr<spdlog::logger> log_;
    Descriptor lock_;
    Budget disk_;
    std::atomic<std::uint64_t> last_ = 0;  // greatest N in use
    DiskQueue disk_queue_;                 // last member: destroyed first, as its tasks use the others
};

}  // namespace octopair::service
