// StateFolder: where detached jobs outlive the server (docs/formats.md). One server has it at a time.
//
// A job is N.job from when its submission is acknowledged, and N.result from when it has ended, until both are removed; N
// counts up, and jobs run in its order. What a crash left half-written has the ending .part, and goes at the next start.
#pragma once

#include <spdlog/fwd.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/descriptor.hpp"
#include "octopair/error.hpp"
#include "service/server/jobs/budget.hpp"
#include "service/server/store/disk_queue.hpp"
#include "service/server/store/state_format.hpp"

namespace octopair::service {

class StateFolder {
public:
    /// What a job takes beside input and pairs: its end, the blocks of the file system.
    static constexpr std::uint64_t bytes_beside = 16 << 10;

    /// Makes the folder if it is not there, for its owner alone. Throws Error{io_failed}, also if another server has it.
    StateFolder(std::string path, std::uint64_t most_bytes, std::shared_ptr<spdlog::logger> log);

    /// A job that was there.
    struct Found {
        std::string base;  ///< of its paths
        StoredSpec stored;
        Budget::Reservation disk, result_disk;
        std::optional<StoredResult> result;
        std::optional<Error> damage;  ///< of a file: it cannot run, or its result cannot be had
    };
    /// In the order in which they were submitted. What cannot be told whose it is is left where it is, and said in the log.
    std::vector<Found> find_jobs();

    /// Of paths of a new job. Thread-safe, as all from here on.
    std::string new_base();
    Budget& disk() { return disk_; }
    DiskQueue& disk_queue() { return disk_queue_; }
    spdlog::logger& log() { return *log_; }

private:
    void lock();
    std::vector<std::uint64_t> clean_up();
    std::optional<Found> find_job(const std::string& base);
    void find_result(Found& found);
    std::string base_of(std::uint64_t number) const;

    const std::string path_;
    const std::shared_ptr<spdlog::logger> log_;
    Descriptor lock_;
    Budget disk_;
    std::atomic<std::uint64_t> last_ = 0;
    DiskQueue disk_queue_;  // the last, so that it ends first
};

}  // namespace octopair::service
