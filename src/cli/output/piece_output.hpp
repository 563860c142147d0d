// PieceOutput: makes one result of the pieces of all ranks.
//
// All ranks write an .npy file of pairs together, each its own part. For other outputs, all ranks send their pieces to the first rank,
// whose FoundWriter writes the result.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "cli/detect/detection.hpp"
#include "cli/output/found_writer.hpp"
#include "cli/ranks/cluster.hpp"
#include "octopair/mpi.hpp"
#include "octopair/pair_list.hpp"
#include "octopair/pipeline.hpp"

namespace octopair::cli {

// collision_piece.cpp

/// The collisions that one rank keeps, in blocks that can be sent as flat arrays.
class CollisionPiece {
public:
    /// A Finding without its list of contacts. `contacts` is their number; they are in Block::contacts.
    struct FlatFinding {
        CollisionClass collision_class;
        DepthKind depth_kind;
        ThicknessKind thickness_kind;
        std::array<bool, 2> open;
        bool more_contacts;
        std::uint32_t contacts;
        double distance, depth, depth_at_most, thickness, time;
        std::array<Point3d, 2> nearest;
        std::uint64_t note;
    };
    struct Block {
        std::vector<Pair> pairs;
        std::vector<FlatFinding> findings;  ///< one per pair, or empty
        std::vector<Contact> contacts;      ///< contacts of all findings, in order

        std::vector<Finding> full_findings() const;
    };

    std::uint64_t size() const { return size_; }
    /// Returns the number of collisions of each class.
    std::array<std::uint64_t, collision_classes> of_class() const;
    std::span<const Block> blocks() const { return blocks_; }
    /// Appends collisions. Requires: in all calls `findings` has one element per pair, or in all calls it is empty.
    void add(std::span<const Pair> pairs, std::span<const Finding> findings);
    /// Keeps at most the first `most` collisions.
    void cut(std::uint64_t most);

private:
    std::vector<Block> blocks_;
    std::uint64_t size_ = 0;
};

/// Collective. Calls take(pairs, findings) on rank 0 with the pieces of all ranks, in the order of the ranks, block by block.
/// Throws: what `take` throws, on all ranks.
void relay(Cluster& cluster, const CollisionPiece& piece,
           const std::function<void(std::span<const Pair>, std::span<const Finding>)>& take);

// piece_output.cpp

/// All functions are collective, and throw the same Error on all ranks. Frames come in order.
class PieceOutput {
public:
    virtual ~PieceOutput() = default;
    /// Writes the pairs of a frame. `piece`: the pairs of this rank.
    virtual void write(std::uint64_t frame, const PairList& piece) = 0;
    /// Throws: Error{usage} unless the output is an .npy file.
    virtual void write(std::uint64_t frame, std::span<const Pair64> piece) = 0;
    virtual void write(std::uint64_t frame, const CollisionPiece& piece) = 0;
    /// Takes the pairs that options leave out on this rank, for --statuses.
    virtual void leave_out(std::span<const Pair>) {}
    /// `complete`: false if --limit has cut the result.
    virtual void finish(bool complete) = 0;
    /// Returns, on the first rank, how the result differs from the older result of --baseline; nothing without --baseline. Requires:
    /// finish() was called.
    virtual std::optional<io::ChangeCounts> changes() const { return std::nullopt; }
    /// Returns, on the first rank, the number of collisions by status; nothing without --statuses. Requires: finish() was called.
    virtual std::optional<io::StatusCounts> statuses() const { return std::nullopt; }
};

/// Borrows the request, the cluster and, on the first rank, the sets.
std::unique_ptr<PieceOutput> make_piece_output(const DetectRequest& request, Cluster& cluster, const FoundIn& sets,
                                               const std::stop_token& stop);

}  // namespace octopair::cli
