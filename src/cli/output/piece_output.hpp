// Where the pieces of all ranks become one result: an .npy file that all write side by side, or text that the first rank
// writes as the others hand it theirs.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <stop_token>

#include "cli/detect/detection.hpp"
#include "cli/ranks/cluster.hpp"
#include "io/results/pair_writer.hpp"
#include "octopair/mpi.hpp"

namespace octopair::cli {

/// All functions are collective and throw on all ranks alike.
class PieceOutput {
public:
    virtual ~PieceOutput() = default;
    /// This rank's piece of a frame, the frames in order.
    virtual void write(std::uint64_t frame, const PairList& piece) = 0;
    /// The same with indices of 64 bits: to .npy alone, Error{usage} otherwise.
    virtual void write(std::uint64_t frame, std::span<const Pair64> piece) = 0;
    virtual void finish() = 0;
};

/// `names`: of all objects, on the first rank; borrowed.
std::unique_ptr<PieceOutput> make_piece_output(const DetectRequest& request, Cluster& cluster,
                                               const io::PairNames& names, const std::stop_token& stop, bool moving);

}  // namespace octopair::cli
