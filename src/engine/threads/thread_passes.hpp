// ThreadPasses: scans of a linear octree on the threads of this process.
#pragma once

#include "engine/search.hpp"
#include "octree/linear_octree.hpp"
#include "octree/scan.hpp"
#include "parallel/team.hpp"

namespace octopair {

class ThreadPasses : public Passes {
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
    /// Of the call's objects after build().
    LinearOctree& octree() { return octree_; }
    /// One pass over the octree.
    virtual void scan_into(Call& call, Executor& executor, double progress);
    /// Over these octants.
    static void scan_into(Call& call, const OctreeRange& octants, Executor& executor, double progress);

private:
    Team team_;
    LinearOctree octree_;
};

}  // namespace octopair
