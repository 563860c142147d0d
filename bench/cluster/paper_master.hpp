// PaperMaster: the paper's algorithm on ranks (section 4), for comparison with octopair's. The steps are those of paper_steps.hpp.
//   1. Rank 0, the master, has all objects, and deals them out in equal runs.
//   2. Each rank computes the octal codes of its run and sorts them. The first rank of each machine merges the lists of its machine.
//   3. The master merges the lists of the machines, scans, and has all pairs.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <span>
#include <vector>

#include "baselines/paper_steps.hpp"
#include "cluster/measured.hpp"

namespace octopair::cluster {

/// Ranks [r, r + 1, ..., r + ranks_per_machine - 1] count as one machine, for r = 0, ranks_per_machine, ...
class PaperMaster {
public:
    /// Collective. `comm` is borrowed. Requires: ranks_per_machine >= 1, the same on all ranks.
    PaperMaster(MPI_Comm comm, unsigned ranks_per_machine);
    PaperMaster(const PaperMaster&) = delete;
    PaperMaster& operator=(const PaperMaster&) = delete;
    ~PaperMaster();

    /// Collective. Finds the pairs of `boxes`, which rank 0 alone has. Borrows `boxes` until the next call.
    /// Requires: fewer than 2^31 objects, and entries on each machine.
    void find_pairs(std::span<const Box3f> boxes);
    /// Repeats the steps of this rank in the last find_pairs(), with what the rank received then. Not collective.
    void repeat_alone();

    /// Returns the pairs in ascending order on rank 0, and none elsewhere.
    const std::vector<Pair>& pairs() const { return pairs_; }
    /// Returns the number of entries in the lists of all ranks, on rank 0.
    std::uint64_t entries() const { return entries_; }
    /// Returns the costs of the last call: `plan` of the octree, `build` of the list, `merge`, `scan`, and traffic.
    const Costs& costs() const { return costs_; }

private:
    void deal_out();
    void make_list();
    void merge_machine();
    void merge_all();
    void scan();
    bool is_master() const { return rank_ == 0; }

    MPI_Comm comm_;
    int rank_ = 0, size_ = 1;
    MPI_Comm machine_ = MPI_COMM_NULL;  // ranks of this machine
    MPI_Comm leaders_ = MPI_COMM_NULL;  // first ranks of the machines; MPI_COMM_NULL on other ranks
    std::span<const Box3f> boxes_;      // of the master
    baselines::PaperOctree octree_{};
    std::vector<Box3f> own_;  // this rank's run
    std::uint32_t first_index_ = 0;
    baselines::PaperList list_;          // of this rank
    baselines::PaperList machine_list_;  // of the machine, on its first rank
    baselines::PaperList whole_list_;    // of all machines, on the master
    /// Lists that this rank received: of the ranks of its machine, and of the machines.
    std::vector<baselines::PaperList> from_ranks_, from_machines_;
    std::vector<Pair> pairs_;
    std::uint64_t entries_ = 0;
    Costs costs_;
};

}  // namespace octopair::cluster
