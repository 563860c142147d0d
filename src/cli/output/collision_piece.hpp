// Collisions of one rank, held until the first rank writes those of all: in blocks of plain values, which ranks can send
// each other as they are.
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
    /// A Finding with its contacts elsewhere.
    struct FlatFinding {
        CollisionClass collision_class;
        bool more_contacts;
        std::uint32_t contacts;
        double distance, depth, time;
        std::array<Point3d, 2> nearest;
        std::uint64_t note;
    };
    struct Block {
        std::vector<Pair> pairs;
        std::vector<FlatFinding> findings;  ///< as many, or none
        std::vector<Contact> contacts;      ///< of all findings, one after another

        std::vector<Finding> full_findings() const;
    };

    std::uint64_t size() const { return size_; }
    std::span<const Block> blocks() const { return blocks_; }
    /// Behind those that are there; as many findings as pairs, or none, and so in all calls.
    void add(std::span<const Pair> pairs, std::span<const Finding> findings);
    /// The first so many stay.
    void cut(std::uint64_t most);

private:
    std::vector<Block> blocks_;
    std::uint64_t size_ = 0;
};

/// Collective: writes the pieces of all ranks, in order, some at a time. Only the first rank has a writer. What it throws is
/// thrown on all.
void relay(Cluster& cluster, const CollisionPiece& piece, FoundWriter* writer);

}  // namespace octopair::cli
