// Tests small scenes with tiny tuning on the local engine against brute force. A few boxes take every path of crowded
// scenes.
#include <gtest/gtest.h>

#include "exactness/small_scenes.hpp"
#include "support/scale.hpp"

#ifdef OCTOPAIR_TEST_HOOKS

namespace octopair::test {
namespace {

constexpr std::uint64_t usual_small_scenes = scaled(10'000, 20);
constexpr std::uint64_t small_parts = 4;  // the scenes are split, so that several processes can share them

class SmallScenes : public ::testing::TestWithParam<std::uint64_t> {};

TEST_P(SmallScenes, AreWhatBruteForceFinds) {
    const SceneRange seeds = scene_range(SceneSize::small, usual_small_scenes).part(GetParam(), small_parts);
    const auto finding = check_small_cases(seeds, local_engines());
    ASSERT_FALSE(finding) << finding->check << ": " << finding->text;
    if (sanitized || seeds.size() < usual_small_scenes / small_parts) return;
    using enum Path;
    EXPECT_EQ(paths_not_taken({octant_divided,
                               octant_too_small,
                               octant_well_swept,
                               octant_multiplies,
                               octant_deepest,
                               table_further,
                               build_one_block,
                               build_blocks,
                               scattered_twice,
                               count_ranges,
                               kept_above_leaf,
                               ghost_entries,
                               ghosts_by_rule,
                               class_bits_brought,
                               share_of_octants,
                               large_octant,
                               handed_down,
                               own_swept,
                               own_too_large,
                               own_window_too_wide,
                               handed_swept,
                               handed_too_large,
                               handed_window_too_wide,
                               join_swept,
                               join_crowded,
                               swept_on_other_axis,
                               crowd_whole,
                               crowd_swept,
                               crowd_parted,
                               part_swept,
                               part_recursive,
                               nested_once,
                               nested_twice,
                               nested_thrice,
                               nested_deeper,
                               nested_join,
                               not_nested_largest,
                               not_nested_growth,
                               not_nested_depth,
                               one_tile,
                               tiles,
                               tile_skipped,
                               recursion_settled,
                               recursion_swept,
                               recursion_spanning,
                               recursion_halved,
                               recursion_shared,
                               sort_few,
                               sort_buckets,
                               sort_full_bucket,
                               sort_radix,
                               radix_blocks,
                               hits_few,
                               cell_sweep_resumed,
                               cell_hit_doubtful,
                               cell_hit_refused,
                               sweep_resumed,
                               hit_turned,
                               hit_settled,
                               pairs_flushed,
                               pairs_counted,
                               list_block_full,
                               bucket_sorted,
                               bucket_in_slots,
                               slotted_rows_in_page,
                               slotted_rows_staged,
                               slots_exceeded,
                               sparse_bucket_sorted,
                               bucket_split,
                               long_row_sorted,
                               row_in_bitmap,
                               buffer_over,
                               counted_ahead,
                               window,
                               window_of_one,
                               limit_reached,
                               stream_lead_wrote,
                               stream_lead_held,
                               stream_lead_full,
                               stream_helper_full,
                               radix_sorted}),
              "");
}

INSTANTIATE_TEST_SUITE_P(Parts, SmallScenes, ::testing::Range(std::uint64_t(0), small_parts));

}  // namespace
}  // namespace octopair::test

#endif
