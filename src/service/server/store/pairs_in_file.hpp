// PairsInFile: keeps the pairs of a detached job in its result file. Pairs are written as they are found, and read to be sent.
//
// Invariants:
//  - Until seal() the file has the ending .part. A server removes such files when it starts.
//  - A file without .part is complete and contains how the job ended.
//
// Memory: one piece (1 MiB) while pairs are appended, and eight bytes for each piece.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "base/memory.hpp"
#include "service/server/jobs/kept_pairs.hpp"
#include "service/server/store/file.hpp"
#include "service/server/store/state_format.hpp"

namespace octopair::service {

class PairsInFile final : public KeptPairs {
public:
    struct Target {
        std::string path;
        std::string hash;  ///< hash of the job
        Budget& disk;
        std::uint64_t max_pairs = 0;  ///< 0: no limit
        std::string owner = {};       ///< client that the disk space counts for
    };

    /// For a job that has not ended.
    explicit PairsInFile(Target target)
        : target_(std::move(target)), reservation_(target_.disk.take(0, target_.owner)) {}
    /// For a job that has ended. `reservation`: disk space of the result file.
    PairsInFile(Target target, StoredResult stored, Budget::Reservation reservation);
    PairsInFile(const PairsInFile&) = delete;
    PairsInFile& operator=(const PairsInFile&) = delete;
    /// Removes the file if it was not sealed.
    ~PairsInFile() override;

    /// Throws: NoRoomError as well, if there may be room later.
    void append(std::span<const Pair> pairs) override;
    void finish() override;
    std::optional<grpc::Slice> piece(std::uint64_t offset) const override;
    std::uint64_t ready() const override;

    /// Returns the bytes of disk space that all appended pairs need, with the pairs that did not fit on the disk.
    std::uint64_t needed_bytes() const;
    /// Deletes all pairs. Does nothing after seal().
    void discard() noexcept;
    /// Completes the file with `ending`. Throws: Error{io_failed}.
    void seal(const v1::JobReport& ending);
    /// Deletes the pairs and the file.
    void remove() noexcept;

private:
    void open();
    void write_piece();
    void take_room(std::uint64_t bytes);

    const Target target_;
    Buffer<Pair> piece_;      // piece being filled; used by the appending thread only
    std::size_t used_ = 0;    // pairs in piece_
    std::uint64_t size_ = 0;  // pairs appended

    mutable std::mutex mutex_;
    Budget::Reservation reservation_;
    std::shared_ptr<File> part_;       // file N.result.part; null once sealed
    std::vector<std::uint64_t> sums_;  // checksum of each piece
    std::uint64_t ready_ = 0;
    std::uint64_t needed_bytes_ = 0;
    bool removed_ = false;
};

}  // namespace octopair::service
