// Test hooks let tests count the paths through the algorithm that a call takes, lower all limits, and plant faults and stop requests.
//
// - Only a build with OCTOPAIR_TEST_HOOKS has the hooks. Without it, the functions are empty constants that the compiler removes.
// - All state is in one TestHooks. If OCTOPAIR_TEST_HOOKS_FILE names a file, the state is in that file, which processes share. So
//   the worker processes of a test use the test's tuning and fault, and add their paths to the test's counts.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string_view>

#include "base/tuning.hpp"

namespace octopair {

/// All paths through the algorithm, grouped by the source file that chooses the path. A test of tiny scenes takes each path.
// clang-format off
#define OCTOPAIR_PATHS(path) \
    /* octree/plan/octree_plan.cpp, octree/plan/directory.cpp */ \
    path(octant_divided) path(octant_too_small) path(octant_well_swept) path(octant_multiplies) path(octant_deepest) \
    path(table_further) \
    /* octree/build/linear_octree.cpp */ \
    path(build_one_block) path(build_blocks) path(scattered_twice) path(count_ranges) path(kept_above_leaf) \
    path(ghost_entries) path(ghosts_by_rule) path(refilled) path(class_bits_brought) \
    /* octree/scan/scan.cpp, octree/scan/handed_down.cpp */ \
    path(share_of_octants) path(large_octant) path(handed_down) \
    /* octree/scan/octant_scan.cpp */ \
    path(own_swept) path(own_too_large) path(own_window_too_wide) path(handed_swept) path(handed_too_large) \
    path(handed_window_too_wide) path(join_swept) path(join_crowded) path(swept_on_other_axis) \
    /* octree/scan/crowd.cpp */ \
    path(crowd_whole) path(crowd_swept) path(crowd_parted) path(part_swept) path(part_recursive) \
    path(nested_once) path(nested_twice) path(nested_thrice) path(nested_deeper) path(nested_join) \
    path(not_nested_largest) path(not_nested_growth) path(not_nested_depth) \
    /* octree/sweep/recursive_sweep.cpp */ \
    path(one_tile) path(tiles) path(tile_skipped) path(recursion_settled) path(recursion_swept) \
    path(recursion_spanning) path(recursion_halved) path(recursion_shared) \
    /* octree/sweep/start_order.cpp, octree/sweep/sweep_choice.cpp */ \
    path(sort_few) path(sort_buckets) path(sort_full_bucket) path(sort_radix) path(radix_blocks) path(hits_few) \
    /* octree/sweep/cell_sweep.cpp */ \
    path(cell_sweep_resumed) path(cell_hit_doubtful) path(cell_hit_refused) \
    /* octree/sweep/box_sweep.cpp */ \
    path(sweep_resumed) path(hit_turned) path(hit_settled) path(pairs_flushed) path(pairs_counted) \
    /* octree/dynamic/mutable_octree.cpp */ \
    path(change_listed) path(change_alone) path(change_joined) path(run_stopped) path(unit_in_cell) \
    path(unit_of_leaf) path(unit_of_inner) \
    /* engine/ */ \
    path(list_block_full) path(sparse_bucket_sorted) path(bucket_sorted) path(bucket_in_slots) path(bucket_split) \
    path(slotted_rows_in_page) path(slotted_rows_staged) path(slots_exceeded) path(long_row_sorted) path(row_in_bitmap) \
    path(buffer_over) path(window) path(window_of_one) path(limit_reached) path(counted_ahead) path(stream_lead_wrote) path(stream_lead_held) \
    path(stream_lead_full) path(stream_helper_full) path(radix_sorted) \
    /* engine/processes/ */ \
    path(region_kept) path(region_copied) path(ring_wrapped) path(nested_shared) \
    /* engine/mpi/ */ \
    path(ranks_top_divided) path(ranks_whole_octree) path(ranks_part_of_octree) path(ranks_regional) path(object_on_ranks) path(ranks_window) path(relay_full) path(relay_listed) \
    path(relay_found_again) path(positions_near) path(positions_far) \
    path(ranks_entries_sent) path(ranks_boxes_sent) path(ranks_crowd_forecast) path(ranks_bounds_missing) path(inner_entry_on_rank) path(inner_entry_on_ranks) \
    path(ranks_pair_postponed) path(ranks_pair_refused) \
    /* scene/ */ \
    path(step_full) path(step_idle) path(step_incremental) path(step_too_dear) path(log_overflowed) path(octree_rebuilt) \
    path(octree_for_queries) path(queries_sorted) path(pairs_waited) path(pairs_merged)
// clang-format on

enum class Path : unsigned {
#define OCTOPAIR_PATH(name) name,
    OCTOPAIR_PATHS(OCTOPAIR_PATH)
#undef OCTOPAIR_PATH
};

inline constexpr auto path_names = std::to_array<std::string_view>({
#define OCTOPAIR_PATH(name) #name,
    OCTOPAIR_PATHS(OCTOPAIR_PATH)
#undef OCTOPAIR_PATH
});

/// Errors that a test can plant in the code, to verify that a check finds them.
enum class Fault : unsigned {
    none,
    begins_bit_cleared,       ///< a ghost loses the class bits that it brought into a nested octree
    octant_border_open,       ///< a box that ends in the first cell of an octant is not stored in that octant
    window_end_open,          ///< a sweep does not test a column that begins where the rows of a block end
    cell_window_end_open,     ///< a sweep of one set on cells skips the last column of each row's window
    cell_depth_too_small,     ///< a hit whose ends are in equal cells counts as a pair without an exact test
    tile_end_open,            ///< a sweep skips a tile that begins where a tile of rows ends
    handed_to_wrong_child,    ///< an entry is handed down to an octant that it does not touch
    nested_space_moved,       ///< class bits of handed down entries are computed in a space that is shifted by one cell
    stream_windows_overlap,   ///< a window begins with the last object of the previous window
    sweep_repeats_block,      ///< a resumed sweep repeats its block of rows
    part_joined_twice,        ///< two parts of a crowded octant are joined in both directions: pairs are found twice
    rank_takes_neighbour,     ///< a rank's run of octants includes the first one of the next rank
    positions_always_near,    ///< ranks send only the lowest bits of positions, also if the positions are far apart
    postponed_pairs_kept,     ///< pairs that ranks cannot decide by cells count as pairs, without the exact test
    overlap_called_touching,  ///< convex shapes that penetrate each other are called touching
};
inline constexpr unsigned fault_count = 16;

/// Value of TestHooks::polls_before_stop with which no poll finds a stop request.
inline constexpr std::int64_t never_stopped = std::numeric_limits<std::int64_t>::max();

/// State that tests set and read. TestHooks holds no pointers, so it can lie in a file that processes share.
struct TestHooks {
    Tuning tuning;
    Fault fault = Fault::none;
    /// Number of polls without a stop. All later polls report a stop request, even if no caller requested a stop.
    std::atomic<std::int64_t> polls_before_stop = never_stopped;
    std::array<std::atomic<std::uint64_t>, path_names.size()> paths = {};  ///< number of times that each path was taken
};

#ifdef OCTOPAIR_TEST_HOOKS
inline constexpr bool has_test_hooks = true;
/// Returns the state of this process and of those that share its file. Throws: std::system_error if that file fails.
/// Thread safety: counters may be read at any time; change tuning and fault only between calls.
TestHooks& test_hooks();
/// Counts that a path was taken. Thread safety: any thread may call it.
void count_path(Path path);
/// Returns true if a test has planted this fault.
bool planted(Fault fault);
/// Counts a poll for a stop request. Returns true if a test has planned a stop for this poll or an earlier one.
bool is_stop_planned();
#else
inline constexpr bool has_test_hooks = false;
constexpr void count_path(Path) {}
constexpr bool planted(Fault) { return false; }
constexpr bool is_stop_planned() { return false; }
#endif

}  // namespace octopair
