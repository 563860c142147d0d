// Tests that a StagedWriter appends the same entries to the same lists as a ChunkWriter, however it stages them. Tests that
// readers of damaged lists end.
#include "octree/build/chunk_lists.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "octopair/error.hpp"

namespace octopair::test {
namespace {

struct Appended {
    std::uint32_t list;
    CellEntry entry;
};

/// Returns entries for random lists. `skew`: the greater, the more of them are in the first lists. One in 16 is discarded.
std::vector<Appended> random_entries(std::size_t count, std::uint32_t lists, double skew, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> part(0, 1);
    std::vector<Appended> all(count);
    for (std::size_t i = 0; i < count; ++i) {
        const auto list = std::uint32_t(std::pow(part(random), skew) * lists);
        const auto word = [&] { return std::uint32_t(random()); };
        all[i] = {random() % 16 == 0 ? lists : list, {{word(), word(), word()}, std::uint32_t(i)}};
    }
    return all;
}

/// Appends entries to each block, in batches as LinearOctree does.
template <typename Writer>
void append(ChunkLists& lists, std::size_t blocks, std::span<const Appended> all) {
    for (std::size_t block = 0; block < blocks; ++block) {
        Writer writer(lists, block);
        const std::size_t begin = all.size() * block / blocks, end = all.size() * (block + 1) / blocks;
        for (std::size_t i = begin; i < end; ++i) {
            writer.append(all[i].list, all[i].entry);
            if (i % 8 == 7) writer.reset_discarded();
            if ((i - begin) % StagedWriter::max_batch == StagedWriter::max_batch - 1 && writer.full()) writer.flush();
        }
        writer.finish();
    }
}

std::vector<CellEntry> entries_of(const ChunkLists& lists, std::size_t list) {
    std::vector<CellEntry> all;
    lists.for_each_run(list, [&](std::span<const CellEntry> run) { all.insert(all.end(), run.begin(), run.end()); });
    return all;
}

struct Load {
    std::size_t blocks, entries;
    std::uint32_t lists;
    double skew;
};

void expect_same_lists(const Load& load) {
    const auto all = random_entries(load.entries, load.lists, load.skew, 7);
    ChunkLists direct(own_pages()), staged(own_pages());
    for (ChunkLists* lists : {&direct, &staged}) lists->resize(load.blocks, load.lists, load.entries);
    append<ChunkWriter>(direct, load.blocks, all);
    // Twice: a repeated step replaces the entries of the first.
    for (int i = 0; i < 2; ++i) append<StagedWriter>(staged, load.blocks, all);
    std::size_t in_lists = 0, discarded = 0;
    for (const Appended& appended : all) discarded += appended.list == load.lists ? 1 : 0;
    for (std::uint32_t list = 0; list < load.lists; ++list) {
        const auto expected = entries_of(direct, list), found = entries_of(staged, list);
        in_lists += found.size();
        ASSERT_EQ(found.size(), expected.size()) << "list " << list;
        for (std::size_t i = 0; i < found.size(); ++i) {
            ASSERT_EQ(found[i].object, expected[i].object) << "list " << list << ", entry " << i;
            ASSERT_EQ(found[i].ends, expected[i].ends) << "list " << list << ", entry " << i;
        }
    }
    EXPECT_EQ(in_lists + discarded, load.entries);
}

TEST(StagedWriter, FillsTheSameListsOverManyFlushes) { expect_same_lists({1, 400000, 3001, 1}); }
TEST(StagedWriter, FillsTheSameListsOfSeveralBlocks) { expect_same_lists({3, 200000, 1777, 1}); }
TEST(StagedWriter, FillsTheSameListsIfOneGroupHasMostEntries) { expect_same_lists({1, 300000, 3001, 20}); }
TEST(StagedWriter, FillsTheSameListsIfThereAreFew) {
    for (const std::uint32_t lists : {1u, 2u, 511u, 512u, 513u}) expect_same_lists({1, 20000, lists, 1});
}
TEST(StagedWriter, FillsNoListWithoutEntries) { expect_same_lists({2, 0, 100, 1}); }

/// A worker with damaged records writes a block while others read it. The chunks of a list then led from one list into another,
/// and round in a circle.
TEST(ChunkLists, HaveAnEndWhenASecondWriterDamagesThem) {
    ChunkLists lists(own_pages());
    lists.resize(1, 2, 10'000);
    const auto append_to = [](ChunkWriter& writer, std::uint32_t list, int count) {
        for (int i = 0; i < count; ++i) writer.append(list, {});
    };
    ChunkWriter first(lists, 0);
    append_to(first, 0, 2000);
    first.finish();
    EXPECT_EQ(entries_of(lists, 0).size(), 2000u);
    ChunkWriter second(lists, 0);
    append_to(second, 0, 1);
    append_to(second, 1, 2000);
    append_to(second, 0, 2000);
    EXPECT_THROW((void)entries_of(lists, 0), Error);
}

}  // namespace
}  // namespace octopair::test
