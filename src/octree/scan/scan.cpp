#include "octree/scan/scan.hpp"

#include <algorithm>
#include <vector>

#include "base/stop.hpp"
#include "base/test_hooks.hpp"
#include "base/tuning.hpp"
#include "octree/scan/handed_down.hpp"
#include "octree/scan/octant_scan.hpp"

namespace octopair {

ScanMemoryPool::ScanMemoryPool() = default;
ScanMemoryPool::~ScanMemoryPool() = default;

ScanMemoryPool::Lent ScanMemoryPool::lend() {
    const std::lock_guard lock(mutex_);
    if (free_.empty()) {
        free_.reserve(allocated_ + 1);  // so that give_back() needs no memory
        free_.push_back(std::make_unique<ScanMemory>());
        ++allocated_;
    }
    Lent lent(free_.back().release(), GiveBack{this});
    free_.pop_back();
    return lent;
}

void ScanMemoryPool::give_back(ScanMemory* memory) noexcept {
    const std::lock_guard lock(mutex_);
    free_.emplace_back(memory);
}

namespace {

/// A run of octants in pre-order that is scanned as one share. A large octant is a share alone.
struct Share {
    OctantIndex begin = 0, end = 0;
    bool large = false;
};

std::vector<Share> shares_of(const OctreeRange& octants, unsigned width) {
    const LinearOctree& octree = octants.octree;
    const std::uint64_t even =
        octree.entry_count(octants.begin, octants.end) / (std::uint64_t(width) * tuning().scan.shares_per_thread) + 1;
    const std::uint64_t most = std::min<std::uint64_t>(even, tuning().scan.max_share_entries);
    std::vector<Share> shares;
    std::uint64_t held = 0;
    for (OctantIndex octant = octants.begin; octant < octants.end; ++octant) {
        const std::size_t size = std::size_t(octree.entry_count(octant));
        const bool large = size > tuning().scan.large_octant;
        if (shares.empty() || large || shares.back().large || held + size > most) {
            shares.push_back({octant, octant, large});
            held = 0;
        }
        shares.back().end = octant + 1;
        held += size;
    }
    return shares;
}

}  // namespace

void scan(const OctreeRange& octants, const ScanContext& context, Executor& executor,
          const std::function<void(std::uint64_t)>& progress) {
    const LinearOctree& octree = octants.octree;
    const std::vector<Share> shares = shares_of(octants, executor.width());
    KeptEntries kept(octree, context.source);
    const auto scan_share = [&](const Share& share, Executor& within) {
        HandedDown handed(octree, kept, planted(Fault::nested_space_moved) && context.nesting > 0 ? 1 : 0);
        const ScanMemoryPool::Lent memory = context.memory.lend();
        OctantScan scans(octree, context, *memory, within);
        for (OctantIndex octant = share.begin; octant < share.end; ++octant) {
            if (octree.entry_count(octant) > 0) scans.scan(octant, handed.at(octant));
        }
        throw_if_stopped(context.stop);
        if (progress) progress(octree.entry_count(share.begin, share.end));
    };
    for (std::size_t i = 0; i < shares.size();) {
        if (shares[i].large) {
            count_path(Path::large_octant);
            scan_share(shares[i++], executor);
            continue;
        }
        count_path(Path::share_of_octants);
        std::size_t end = i;
        while (end < shares.size() && !shares[end].large) ++end;
        executor.for_each_writing(end - i, [&](std::size_t k, ShareWriter& writer) {
            SerialExecutor serial(writer);
            scan_share(shares[i + k], serial);
        });
        i = end;
    }
}

}  // namespace octopair
