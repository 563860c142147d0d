// StoredJob: the files of one detached job, N.job and N.result. StoredUpload: writes N.job while the input arrives.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "service/protocol/job_hash.hpp"
#include "service/server/jobs/job_record.hpp"
#include "service/server/jobs/uploaded_input.hpp"
#include "service/server/store/file.hpp"
#include "service/server/store/pairs_in_file.hpp"
#include "service/server/store/state_folder.hpp"
#include "service/server/store/state_format.hpp"

namespace octopair::service {

class StoredJob final : public JobRecord {
public:
    struct Parts {
        StateFolder& folder;
        std::string base;  ///< path of the files without .job or .result
        StoredSpec stored;
        Budget::Reservation disk;
        std::shared_ptr<PairsInFile> pairs;
        Budget& memory;
        std::uint64_t memory_bytes = 0;  ///< memory that the job needs to run
    };

    explicit StoredJob(Parts parts) : parts_(std::move(parts)) {}

    const StoredSpec& stored() const { return parts_.stored; }
    const std::shared_ptr<PairsInFile>& pairs() const { return parts_.pairs; }

    std::string hash() const override { return parts_.stored.hash; }
    std::optional<Budget::Reservation> ask_memory() override;
    std::unique_ptr<UploadedInput> load(const std::shared_ptr<Engine>& engine,
                                        const std::stop_token& stop) const override;
    void end(const v1::JobReport& ending) override;
    void wait_for_room(const NoRoomError& why, std::chrono::duration<double> run) override;
    bool has_room() override;
    void run_on_disk_queue(std::function<void()> task) override { parts_.folder.disk_queue().add(std::move(task)); }

    /// Deletes the files.
    void remove() noexcept;

private:
    Parts parts_;
    // For a job whose result did not fit on the disk: bytes that the result needs at least, and time of the next check for room.
    std::uint64_t needed_bytes_ = 0;
    std::chrono::duration<double> pause_{0};
    std::chrono::steady_clock::time_point next_check_{};
};

/// Receives the input of a job and computes its hash. Writes the input to a file, or discards it.
class StoredUpload final : public InputTarget {
public:
    /// Creates N.job.part in `folder`. Throws: LimitError if the folder is full; Error{io_failed}.
    StoredUpload(StateFolder& folder, StoredSpec stored);
    /// Discards the input; only its hash is computed.
    explicit StoredUpload(StoredSpec stored);
    StoredUpload(const StoredUpload&) = delete;
    StoredUpload& operator=(const StoredUpload&) = delete;
    /// Deletes the file unless hand_over() was called.
    ~StoredUpload() override;

    void append(std::span<const std::byte> data) override;
    std::uint64_t missing() const override { return missing_; }

    const StoredSpec& stored() const { return stored_; }
    bool has_file() const { return file_.open(); }
    /// Returns the hash of input and options. Requires: the input is complete.
    std::string hash() const { return hash_.digest(); }
    /// Completes N.job, syncs it to the disk, and returns the base of the paths. Requires: has_file(), and the input is
    /// complete.
    /// Throws: Error{io_failed}.
    std::string commit();
    /// Returns the reservation of the disk space of the job.
    Budget::Reservation take_disk() { return std::move(disk_); }
    /// Keeps the committed file when this object is destroyed.
    void hand_over() { handed_over_ = true; }

private:
    StoredSpec stored_;
    JobHash hash_;
    std::uint64_t missing_ = 0;  // bytes
    std::string base_, job_path_, block_;
    Budget::Reservation disk_;
    File file_;
    std::uint64_t at_ = 0;  // offset of the next write
    bool handed_over_ = false;
};

}  // namespace octopair::service
