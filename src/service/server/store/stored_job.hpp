// StoredJob: the files of one detached job, N.job and N.result; StoredUpload: the first of them while its input arrives.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "service/protocol/job_hash.hpp"
#include "service/server/jobs/input_target.hpp"
#include "service/server/jobs/job_record.hpp"
#include "service/server/store/file.hpp"
#include "service/server/store/pairs_in_file.hpp"
#include "service/server/store/state_folder.hpp"
#include "service/server/store/state_format.hpp"

namespace octopair::service {

class StoredJob final : public JobRecord {
public:
    struct Parts {
        StateFolder& folder;
        std::string base;  ///< of the paths: what is before .job and .result
        StoredSpec stored;
        Budget::Reservation disk;
        std::shared_ptr<PairsInFile> pairs;
        Budget& memory;
        std::uint64_t memory_bytes = 0;  ///< that the job takes when it runs
    };

    explicit StoredJob(Parts parts) : parts_(std::move(parts)) {}

    const StoredSpec& stored() const { return parts_.stored; }
    const std::shared_ptr<PairsInFile>& pairs() const { return parts_.pairs; }

    std::string hash() const override { return parts_.stored.hash; }
    std::optional<Budget::Reservation> ask_memory() override;
    std::unique_ptr<UploadedInput> load(Engine& engine, const std::stop_token& stop) const override;
    void end(const v1::JobReport& ending) override;
    void later(std::function<void()> errand) override { parts_.folder.disk_queue().add(std::move(errand)); }

    /// Its files go.
    void remove() noexcept;

private:
    Parts parts_;
};

/// The input goes to a file as it comes, or nowhere: then its hash alone is wanted.
class StoredUpload final : public InputTarget {
public:
    /// Throws a LimitError if the folder has no room, Error{io_failed}.
    StoredUpload(StateFolder& folder, StoredSpec stored);
    /// To nowhere.
    explicit StoredUpload(StoredSpec stored);
    StoredUpload(const StoredUpload&) = delete;
    StoredUpload& operator=(const StoredUpload&) = delete;
    /// Takes away what was not handed over.
    ~StoredUpload() override;

    void append(std::span<const std::byte> data) override;
    std::uint64_t missing() const override { return missing_; }

    const StoredSpec& stored() const { return stored_; }
    bool has_file() const { return file_.open(); }
    /// Of a complete input.
    std::string hash() const { return hash_.digest(); }
    /// When it returns, the job is on the disk. Gives the base of its paths, and what it takes. Throws Error{io_failed}.
    std::string commit();
    Budget::Reservation take_disk() { return std::move(disk_); }
    /// What was committed is another's to remove.
    void hand_over() { handed_over_ = true; }

private:
    StoredSpec stored_;
    JobHash hash_;
    std::uint64_t missing_ = 0;
    std::string base_, job_path_, block_;
    Budget::Reservation disk_;
    File file_;
    std::uint64_t at_ = 0;
    bool handed_over_ = false;
};

}  // namespace octopair::service
