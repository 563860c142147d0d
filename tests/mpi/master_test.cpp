// Tests the paper's algorithm on ranks: the master finds the pairs that threads find, and the other ranks take part.
#include <gtest/gtest.h>

#include "baselines/baselines.hpp"
#include "cluster/paper_master.hpp"
#include "mpi/ranks.hpp"
#include "octopair/engine.hpp"
#include "samples/scenes.hpp"
#include "support/kinds.hpp"

namespace octopair::test {
namespace {

using baselines::PaperEntry;
using cluster::Costs;
using cluster::PaperMaster;

/// Returns the objects that a rank has at first: all or none.
std::vector<Box3f> at_first(const std::vector<Box3f>& boxes) { return own_rank() == 0 ? boxes : std::vector<Box3f>(); }

/// Expects that the master has all pairs and other ranks have none.
void expect_pairs(const PaperMaster& master, const std::vector<Box3f>& boxes) {
    EXPECT_EQ(master.pairs(), own_rank() == 0 ? find_pairs(boxes) : std::vector<Pair>());
}

void expect_search(const std::vector<Box3f>& boxes, unsigned ranks_per_machine) {
    PaperMaster master(MPI_COMM_WORLD, ranks_per_machine);
    const std::vector<Box3f> own = at_first(boxes);
    master.find_pairs(own);
    expect_pairs(master, boxes);
    if (own_rank() == 0) {
        EXPECT_EQ(master.entries(), baselines::paper_pairs(boxes).entries);
    }
}

/// Some kinds have few objects here, because an object has an entry for each octant that it meets.
TEST(RankMaster, FindsThePairsOfThreads) {
    unsigned number = 0;
    for (const std::string& kind : all_kind_names()) {
        SCOPED_TRACE(kind);
        expect_search(make_boxes(kind, 80 + number, number), 1 + number % 3);
        ++number;
    }
    for (const std::string kind : {"uniform", "dense"}) expect_search(samples::make_scene(kind, 3'000, 1), 2);
}

TEST(RankMaster, IsOneOfTheRanksThatBuildLists) {
    constexpr std::uint64_t objects = 50'000;
    const std::vector<Box3f> boxes = samples::make_scene("uniform", objects, 1), own = at_first(boxes);
    PaperMaster paper(MPI_COMM_WORLD, 2);
    paper.find_pairs(own);
    expect_pairs(paper, boxes);
    const std::uint64_t ranks = rank_count(), rank = own_rank();
    const bool master = rank == 0, merges = rank % 2 == 0 && rank + 1 < ranks;
    const std::uint64_t run = objects * (rank + 1) / ranks - objects * rank / ranks;
    const Costs& costs = paper.costs();
    EXPECT_EQ(costs.objects, master ? objects : 0);
    EXPECT_EQ(costs.objects_received, master ? 0 : run);
    EXPECT_GT(costs.build, 0);
    EXPECT_EQ(costs.scan > 0, master);
    EXPECT_EQ(costs.messages_sent, master ? ranks - 1 : 1);
    if (master) {  // the master sends boxes, but no entries
        EXPECT_EQ(costs.bytes_sent, (objects - run) * sizeof(Box3f));
    } else {
        EXPECT_GE(costs.bytes_sent, run * sizeof(PaperEntry) * (merges ? 2 : 1));
    }
    EXPECT_EQ(costs.merge > 0, master || rank % 2 == 0);
}

/// A rank alone repeats its steps with what it received.
TEST(RankMaster, RepeatsWhatEachRankDid) {
    const std::vector<Box3f> boxes = samples::make_scene("dense", 5'000, 1), own = at_first(boxes);
    PaperMaster paper(MPI_COMM_WORLD, 2);
    paper.find_pairs(own);
    const Costs before = paper.costs();
    const std::uint64_t entries = paper.entries();
    for (unsigned rank = 0; rank < rank_count(); ++rank) {
        MPI_Barrier(MPI_COMM_WORLD);
        if (rank != own_rank()) continue;
        paper.repeat_alone();
        paper.repeat_alone();
    }
    expect_pairs(paper, boxes);
    EXPECT_EQ(paper.entries(), entries);
    EXPECT_EQ(paper.costs().objects_received, before.objects_received);
    EXPECT_GT(paper.costs().build, 0);
    EXPECT_EQ(paper.costs().bytes_sent, 0u);
}

TEST(RankMaster, HasFewObjectsOrNone) {
    PaperMaster paper(MPI_COMM_WORLD, 2);
    for (const std::size_t objects : {0, 1, 2, 3}) {
        const std::vector<Box3f> boxes(objects, Box3f{{0, 0, 0}, {1, 1, 1}}), own = at_first(boxes);
        paper.find_pairs(own);
        expect_pairs(paper, boxes);
    }
}

}  // namespace
}  // namespace octopair::test
