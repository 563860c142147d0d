// CollisionPiece: the collisions of one rank, stored until rank 0 writes those of all ranks.
//
// They are stored in blocks of trivially copyable values, so that ranks can send the arrays without conversion.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "cli/output/found_writer.hpp"
#include "cli/ranks/cluster.hpp"
#include "octopair/pipeline.hpp"

namespace octopair::cli {

class CollisionPiece {
public:
    /// A Finding without its list of contacts. `contacts` is their number; they are in Block::contacts.
    struct FlatFinding {
        CollisionClass collision_class;
        DepthKind depth_kind;
        std::array<bool, 2> open;
        bool more_contacts;
        std::uint32_t contacts;
        double distance, depth, depth_at_most, time;
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

/// Collective. Writes the pieces of all ranks, in the order of the ranks, block by block. `writer` is null except on rank 0.
/// Throws: what the writer throws, on all ranks.
void relay(Cluster& cluster, const CollisionPiece& piece, FoundWriter* writer);

}  // namespace octopair::cli
