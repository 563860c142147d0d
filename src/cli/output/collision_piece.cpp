// CollisionPiece: keeps the collisions of one rank until rank 0 writes the collisions of all ranks.
//
// A piece has blocks of arrays of trivially copyable values, so that ranks can send the arrays without conversion.
#include <algorithm>

#include "cli/output/piece_output.hpp"

namespace octopair::cli {

namespace {

constexpr std::size_t block_pairs = 1 << 14;

using Block = CollisionPiece::Block;

void append_finding(Block& block, const Finding& finding) {
    block.contacts.insert(block.contacts.end(), finding.contacts.begin(), finding.contacts.end());
    block.findings.push_back({finding.collision_class, finding.depth_kind, finding.thickness_kind, finding.open,
                              finding.more_contacts, std::uint32_t(finding.contacts.size()), finding.distance,
                              finding.depth, finding.depth_at_most, finding.thickness, finding.time, finding.nearest,
                              finding.note});
}

/// Lengths of the arrays of a block.
struct Lengths {
    std::uint64_t pairs = 0, findings = 0, contacts = 0;
};

/// Sends blocks from one rank to rank 0.
class BlockTransfer {
public:
    BlockTransfer(Cluster& cluster, unsigned from) : cluster_(cluster), from_(from) {}

    /// Collective. Sends `block` of rank `from`; the blocks of other ranks are ignored. Returns the received block on rank 0.
    const Block& send(const Block& block) {
        const auto lengths =
            cluster_.all_gather(Lengths{block.pairs.size(), block.findings.size(), block.contacts.size()})[from_];
        cluster_.together([&] {
            if (!cluster_.first()) return;
            received_.pairs.resize(std::size_t(lengths.pairs));
            received_.findings.resize(std::size_t(lengths.findings));
            received_.contacts.resize(std::size_t(lengths.contacts));
        });
        send_values(block.pairs, received_.pairs);
        send_values(block.findings, received_.findings);
        send_values(block.contacts, received_.contacts);
        return received_;
    }

private:
    template <typename Value>
    void send_values(const std::vector<Value>& own, std::vector<Value>& received) {
        cluster_.send_to_first(from_, std::span<const Value>(own), std::span(received));
    }

    Cluster& cluster_;
    unsigned from_;
    Block received_;
};

}  // namespace

std::vector<Finding> CollisionPiece::Block::full_findings() const {
    std::vector<Finding> full(findings.size());
    auto contact = contacts.begin();
    for (std::size_t i = 0; i < full.size(); ++i) {
        const FlatFinding& flat = findings[i];
        const auto end = contact + std::ptrdiff_t(flat.contacts);
        full[i] = {.collision_class = flat.collision_class,
                   .distance = flat.distance,
                   .nearest = flat.nearest,
                   .depth = flat.depth,
                   .depth_kind = flat.depth_kind,
                   .depth_at_most = flat.depth_at_most,
                   .open = flat.open,
                   .time = flat.time,
                   .contacts = {contact, end},
                   .more_contacts = flat.more_contacts,
                   .note = flat.note,
                   .thickness = flat.thickness,
                   .thickness_kind = flat.thickness_kind};
        contact = end;
    }
    return full;
}

std::array<std::uint64_t, collision_classes> CollisionPiece::of_class() const {
    std::array<std::uint64_t, collision_classes> counts = {};
    for (const Block& block : blocks_) {
        for (const FlatFinding& finding : block.findings) ++counts[std::size_t(finding.collision_class)];
    }
    return counts;
}

void CollisionPiece::add(std::span<const Pair> pairs, std::span<const Finding> findings) {
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        if (blocks_.empty() || blocks_.back().pairs.size() == block_pairs) blocks_.emplace_back();
        Block& block = blocks_.back();
        block.pairs.push_back(pairs[i]);
        if (!findings.empty()) append_finding(block, findings[i]);
        ++size_;
    }
}

void CollisionPiece::cut(std::uint64_t most) {
    if (most >= size_) return;
    size_ = most;
    blocks_.resize(std::size_t((most + block_pairs - 1) / block_pairs));
    if (blocks_.empty()) return;
    Block& last = blocks_.back();
    last.pairs.resize(std::size_t(most - (blocks_.size() - 1) * block_pairs));
    if (last.findings.empty()) return;
    last.findings.resize(last.pairs.size());
    std::size_t contacts = 0;
    for (const FlatFinding& finding : last.findings) contacts += finding.contacts;
    last.contacts.resize(contacts);
}

void relay(Cluster& cluster, const CollisionPiece& piece,
           const std::function<void(std::span<const Pair>, std::span<const Finding>)>& take) {
    const std::vector<std::uint64_t> blocks = cluster.all_gather(std::uint64_t(piece.blocks().size()));
    for (unsigned from = 0; from < cluster.ranks(); ++from) {
        BlockTransfer transfer(cluster, from);
        const Block none;
        for (std::size_t i = 0; i < blocks[from]; ++i) {
            const Block& own = cluster.rank() == from ? piece.blocks()[i] : none;
            const Block& received = from == 0 ? own : transfer.send(own);
            cluster.together([&] {
                if (cluster.first()) take(received.pairs, received.full_findings());
            });
        }
    }
}

}  // namespace octopair::cli
