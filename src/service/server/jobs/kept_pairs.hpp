// KeptPairs: the pairs of a job, kept as pieces that are sent without change. PairsInMemory keeps them in memory.
//
// Threads     One thread calls append() and finish(). Other threads may read at the same time.
// Readable    Pairs in full pieces; after finish() all pairs. A reader may start at any pair.
// Lifetime    PairsInMemory hands pieces out without a copy. A piece lives until its last user releases it.
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

    /// Throws: LimitError, Error{io_failed}. Do not append after an exception.
    virtual void append(std::span<const Pair> pairs) = 0;
    /// Makes all pairs readable. Requires: no append() follows. Throws: as append().
    virtual void finish() = 0;
    /// Returns the pairs from number `offset` to the end of its piece, or nothing if this pair is not readable.
    virtual std::optional<grpc::Slice> piece(std::uint64_t offset) const = 0;
    /// Returns the number of readable pairs.
    virtual std::uint64_t ready() const = 0;
};

/// Keeps pairs in memory that is reserved from a budget.
class PairsInMemory final : public KeptPairs {
public:
    /// append() throws LimitError "pairs" for more than `most` pairs; 0: no limit.
    PairsInMemory(Budget& memory, std::uint64_t most, const std::string& client = {})
        : most_(most), reservation_(memory.take(0, client)) {}

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
    std::vector<grpc::Slice> full_;  // full pieces; after finish() also the last, shorter one
    grpc::Slice open_;               // piece being filled; used by the appending thread only
    std::size_t used_ = 0;           // pairs in open_
    std::uint64_t size_ = 0;         // pairs appended; used by the appending thread only
    std::uint64_t ready_ = 0;
};

/// Throws: LimitError "pairs" if `pairs` is greater than `most`. 0: no limit.
void check_pair_limit(std::uint64_t pairs, std::uint64_t most);

}  // namespace octopair::service
