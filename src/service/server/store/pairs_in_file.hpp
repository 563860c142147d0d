// The pairs of a detached job, in the file of its result: written as they are found, read from there as they are sent.
//
// The file has its name, and how the job ended, only when that is final; until then it is a part that a server which starts
// throws away. Memory: one piece while pairs are appended, and eight bytes a piece.
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
    struct Place {
        std::string path;
        std::string hash;  ///< of the job
        Budget& disk;
        std::uint64_t most_pairs = 0;  ///< 0: no limit
    };

    /// Of a job that has not ended.
    explicit PairsInFile(Place place) : place_(std::move(place)), reservation_(place_.disk.take(0)) {}
    /// Of one that has; `share`: what its file takes.
    PairsInFile(Place place, StoredResult stored, Budget::Reservation share);
    PairsInFile(const PairsInFile&) = delete;
    PairsInFile& operator=(const PairsInFile&) = delete;
    /// Takes away what has no end.
    ~PairsInFile() override;

    void append(std::span<const Pair> pairs) override;
    void finish() override;
    std::optional<grpc::Slice> piece(std::uint64_t offset) const override;
    std::uint64_t ready() const override;

    /// There are no pairs: the job was not done.
    void discard() noexcept;
    /// The result is final, as `ending` says. Throws Error{io_failed}.
    void seal(const v1::JobReport& ending);
    /// The file goes.
    void remove() noexcept;

private:
    void open();
    void write_piece();

    const Place place_;
    Buffer<Pair> piece_;    // the appending thread's
    std::size_t used_ = 0;  // pairs in it
    std::uint64_t size_ = 0;

    mutable std::mutex mutex_;
    Budget::Reservation reservation_;
    std::shared_ptr<File> part_;  // until it is final
    std::vector<std::uint64_t> sums_;
    std::uint64_t ready_ = 0;
    bool removed_ = false;
};

}  // namespace octopair::service
