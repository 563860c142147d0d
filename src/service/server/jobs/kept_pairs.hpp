// The pairs of a job, kept as pieces that go out as they are.
//
// One thread appends and finishes, others read meanwhile: what is in a full piece, or in any once the pairs are finished,
// can be read, from any offset on. A piece is handed out without copying, and lives until the last who has it lets go.
#pragma once

#include <grpcpp/support/slice.h>

#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "octopair/objects.hpp"
#include "service/server/jobs/budget.hpp"

namespace octopair::service {

class KeptPairs {
public:
    virtual ~KeptPairs() = default;

    /// Throws a LimitError, or Error{io_failed}; then no more is appended.
    virtual void append(std::span<const Pair> pairs) = 0;
    /// No more will come. Throws as append.
    virtual void finish() = 0;
    /// The rest of the piece that the pair `offset` is in; none: it cannot be read yet, or there is no such pair.
    virtual std::optional<grpc::Slice> piece(std::uint64_t offset) const = 0;
    /// That can be read.
    virtual std::uint64_t ready() const = 0;
};

/// In memory that counts against a budget.
class PairsInMemory final : public KeptPairs {
public:
    /// Throws a LimitError "pairs" beyond `most`; 0: there is no such limit.
    PairsInMemory(Budget& memory, std::uint64_t most) : most_(most), reservation_(memory.take(0)) {}

    void append(std::span<const Pair> pairs) override;
    void finish() override;
    std::optional<grpc::Slice> piece(std::uint64_t offset) const override;
    std::uint64_t ready() const override;

private:
    std::span<Pair> room() const;
    void open_piece();

    const std::uint64_t most_;
    mutable std::mutex mutex_;
    Budget::Reservation reservation_;
    std::vector<grpc::Slice> full_;  // a piece each, but for the last when finished
    grpc::Slice open_;               // the appending thread's
    std::size_t used_ = 0;           // pairs in it
    std::uint64_t size_ = 0;         // the appending thread's
    std::uint64_t ready_ = 0;
};

/// Throws the LimitError of a job with more pairs than are kept.
void check_kept(std::uint64_t pairs, std::uint64_t most);

}  // namespace octopair::service
