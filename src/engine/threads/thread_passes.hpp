// ThreadPasses: scans a linear octree on the threads of this process.
#pragma once

#include "base/private_export.hpp"
#include "engine/passes.hpp"
#include "octree/build/linear_octree.hpp"
#include "octree/scan/scan.hpp"
#include "octree/scan/scan_memory.hpp"
#include "parallel/team.hpp"

namespace octopair {

class OCTOPAIR_PRIVATE_EXPORT ThreadPasses : public Passes {
public:
    explicit ThreadPasses(unsigned threads) : team_(threads) {}

    unsigned width() const override { return team_.threads(); }
    std::uint64_t count(Call& call, double progress) override;
    void count_by_object(Call& call, std::span<std::uint32_t> counts, double progress) override;
    void list_octal(Call& call, detail::PairStorage& list, double progress) override;
    void stream_octal(Call& call, const Deliver& deliver, double progress) override;
    void list_ascending(Call& call, detail::PairStorage& list, const AscendingBounds& bounds, double progress) override;

protected:
    Team& team() { return team_; }
    /// Returns the octree of the call's objects. Requires: build() was called.
    LinearOctree& octree() { return octree_; }
    /// Returns the boxes that the octree is built of.
    virtual const EntrySource& searched(const Call& call) const { return call.source; }
    /// Scans the whole octree once, and passes its pairs to the writers of `executor`.
    virtual void scan_into(Call& call, Executor& executor, double progress);
    /// Scans `octants` once, and passes their pairs to the writers of `executor`.
    void scan_into(Call& call, const OctreeRange& octants, Executor& executor, double progress);

private:
    Team team_;
    LinearOctree octree_;
    ScanMemoryPool scan_memory_;
};

}  // namespace octopair
