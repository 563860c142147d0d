// PieceOutput: makes one result of the pieces of all ranks.
//
// An .npy file of pairs is written by all ranks side by side. Everything else goes to the first rank, whose FoundWriter
// writes it.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>

#include "cli/detect/detection.hpp"
#include "cli/output/found_writer.hpp"
#include "cli/ranks/cluster.hpp"
#include "octopair/mpi.hpp"
#include "octopair/pair_list.hpp"

namespace octopair::cli {

class CollisionPiece;

/// All functions are collective, and throw the same Error on all ranks. Frames come in order.
class PieceOutput {
public:
    virtual ~PieceOutput() = default;
    /// Writes a frame, of which `piece` is this rank's part.
    virtual void write(std::uint64_t frame, const PairList& piece) = 0;
    /// Throws: Error{usage} unless the output is an .npy file.
    virtual void write(std::uint64_t frame, std::span<const Pair64> piece) = 0;
    virtual void write(std::uint64_t frame, const CollisionPiece& piece) = 0;
    virtual void finish() = 0;
    /// Returns how the result differs from an older one, on the first rank, if the request names one. After finish().
    virtual std::optional<io::ChangeCounts> changes() const { return std::nullopt; }
};

/// Borrows the request, the cluster and, on the first rank, the sets.
std::unique_ptr<PieceOutput> make_piece_output(const DetectRequest& request, Cluster& cluster, const FoundIn& sets,
                                               const std::stop_token& stop);

}  // namespace octopair::cli
