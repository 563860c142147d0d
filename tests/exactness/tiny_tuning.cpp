#include "exactness/tiny_tuning.hpp"

#include <algorithm>
#include <initializer_list>

#include "samples/random.hpp"

namespace octopair::test {

namespace {

/// Replaces constants by random small values.
class Shrinker {
public:
    explicit Shrinker(std::uint64_t seed)
        : random_(seed, 0), kept_(random_.below(3) == 0 ? 0.4 * random_.uniform() : 0) {}

    template <typename Value>
    void one_of(Value& constant, std::initializer_list<Value> values) {
        const std::uint64_t chosen = random_.below(values.size());
        if (random_.uniform() >= kept_) constant = values.begin()[chosen];
    }

private:
    samples::RandomStream random_;
    double kept_;  // part of the constants that keep their values
};

void shrink(Tuning::Sampling& sampling, Shrinker& to) {
    to.one_of<std::size_t>(sampling.stride, {1, 1, 2, 3, 7});
    to.one_of<std::size_t>(sampling.min_objects, {1, 1, 3});
    to.one_of<std::size_t>(sampling.max_objects, {8, 20, 1000});
    to.one_of<std::size_t>(sampling.max_stride, {1, 2, 5});
    to.one_of<std::size_t>(sampling.space_objects, {1, 5, 60});
}

void shrink(Tuning::Split& split, Shrinker& to) {
    to.one_of<double>(split.always_above, {1, 2, 5, 12});
    to.one_of<double>(split.never_up_to, {0, 1, 3});
    split.never_up_to = std::min(split.never_up_to, split.always_above);
    to.one_of<double>(split.max_tests_per_object, {0, 0.5, 3});
    to.one_of<double>(split.max_entries_per_object, {1.6, 3, 8});
    to.one_of<double>(split.max_handed_growth, {1.5, 3, 8});
    to.one_of<std::uint64_t>(split.max_cells_per_octant, {1, 2});
}

void shrink(Tuning::Build& build, Shrinker& to) {
    to.one_of<std::size_t>(build.blocks_per_thread, {1, 3});
    to.one_of<std::size_t>(build.min_block, {1, 3, 17});
    to.one_of<std::size_t>(build.counts_per_range, {1, 8, 50});
    to.one_of<std::size_t>(build.batch, {1, 3, 16});
    to.one_of<std::size_t>(build.max_chunk, {16, 32});
    to.one_of<std::size_t>(build.chunk_part, {1, 4});
}

void shrink(Tuning::Scan& scan, Shrinker& to) {
    to.one_of<std::size_t>(scan.large_octant, {1, 4, 20, 60});
    to.one_of<std::size_t>(scan.max_share_entries, {1, 5, 30});
    to.one_of<std::size_t>(scan.shares_per_thread, {1, 3});
    to.one_of<std::size_t>(scan.max_swept_list, {1, 4, 16, 50});
    to.one_of<std::uint64_t>(scan.max_tests_per_box, {0, 1, 3, 8});
    to.one_of<double>(scan.max_whole_crowd, {0, 0.25, 1});
    to.one_of<double>(scan.max_part_in_octant, {0.6, 0.8, 0.95, 1});
    to.one_of<double>(scan.max_growth, {1.5, 4, 16});
    to.one_of<unsigned>(scan.max_nesting, {1, 2, 3, 5, 8});
}

void shrink(Tuning::Sweep& sweep, Shrinker& to) {
    to.one_of<std::size_t>(sweep.tile, {1, 2, 5, 16});
    to.one_of<std::size_t>(sweep.small_set, {1, 3, 8});
    to.one_of<std::uint64_t>(sweep.cheap_tests, {0, 1, 3});
    to.one_of<std::uint64_t>(sweep.tests_per_pair, {1, 4});
    to.one_of<std::size_t>(sweep.large_join, {1, 4, 20});
    to.one_of<std::size_t>(sweep.tests_per_call, {1, 2, 7});
    to.one_of<std::size_t>(sweep.hits, {8, 9, 20});
    to.one_of<std::size_t>(sweep.cell_hits, {320, 321, 400});
    to.one_of<std::size_t>(sweep.max_cell_buckets, {1, 2, 8});
    to.one_of<std::size_t>(sweep.pairs, {1, 9, 30});
    to.one_of<std::size_t>(sweep.max_buckets, {2, 4, 16});
    to.one_of<std::size_t>(sweep.max_comparison_sort, {1, 2, 5});
    to.one_of<std::size_t>(sweep.max_bucket_sort, {1, 4, 20});
    to.one_of<std::size_t>(sweep.radix_block, {1, 5});
    to.one_of<unsigned>(sweep.radix_digit_bits, {3, 5});
    to.one_of<std::size_t>(sweep.min_measured, {1, 4, 16});
    to.one_of<std::size_t>(sweep.max_measured, {16, 40});
    to.one_of<std::size_t>(sweep.tried_rows, {1, 5});
    to.one_of<std::size_t>(sweep.measured_row_stride, {1, 3});
}

void shrink(Tuning::Dynamic& dynamic, Shrinker& to) {
    to.one_of<std::size_t>(dynamic.max_listed_visits, {1, 2, 5, 20});
    to.one_of<std::size_t>(dynamic.hits, {1, 3, 10});
    to.one_of<double>(dynamic.max_cell_objects, {1, 2});
    to.one_of<double>(dynamic.max_growth, {1.1, 3, 8});
    to.one_of<unsigned>(dynamic.max_grid_bits, {0, 1, 4});
}

void shrink(Tuning::Output& output, Shrinker& to) {
    to.one_of<std::uint64_t>(output.min_buffer_bytes, {8, 64, 1000, 10000});
    to.one_of<std::size_t>(output.batch, {1, 3, 50});
    to.one_of<std::size_t>(output.max_pairs_per_sink_call, {1, 4, 100});
    to.one_of<std::size_t>(output.list_block, {1, 5, 100});
    to.one_of<std::size_t>(output.page, {1, 2, 8});
    to.one_of<unsigned>(output.bucket_row_bits, {0, 1, 3});
    to.one_of<unsigned>(output.bucket_bits, {1, 2, 4});
    to.one_of<unsigned>(output.bucket_split_bits, {1, 2});
    to.one_of<std::size_t>(output.sorted_at_once, {1, 3, 20});
    to.one_of<std::size_t>(output.bucket_pairs, {1, 3, 20});
    to.one_of<unsigned>(output.sparse_row_bits, {0, 2, 20});
    to.one_of<std::size_t>(output.bitmap_columns, {1, 2, 64});
    to.one_of<std::size_t>(output.min_radix_sort, {1, 4});
    to.one_of<std::size_t>(output.shares_ahead, {1, 2});
    to.one_of<std::uint64_t>(output.unchecked_bytes, {8, 100, 1 << 28});
    to.one_of<std::uint64_t>(output.checked_step, {1, 1000});
    to.one_of<std::uint64_t>(output.forecast_pairs, {1, 10});
    to.one_of<double>(output.counting_seconds, {0, 10});
}

void shrink(Tuning::Processes& processes, Shrinker& to) {
    to.one_of<std::uint64_t>(processes.objects_per_worker, {1, 10, 50});
    to.one_of<std::uint64_t>(processes.worth_keeping, {1, 30});
    to.one_of<std::size_t>(processes.kept_regions, {1, 2});
    to.one_of<std::uint64_t>(processes.ring_block, {1, 5});
    to.one_of<unsigned>(processes.blocks_at_once, {1, 2});
}

void shrink(Tuning::Ranks& ranks, Shrinker& to) {
    to.one_of<std::uint64_t>(ranks.round_bytes, {48, 500});
    to.one_of<std::size_t>(ranks.batch, {1, 5});
    to.one_of<std::uint64_t>(ranks.objects_per_octant, {0, 1000});
    to.one_of<std::size_t>(ranks.block, {1, 10});
    to.one_of<std::size_t>(ranks.share_pairs, {1, 10});
    to.one_of<std::uint64_t>(ranks.octants, {1, 4, 20});
    to.one_of<std::size_t>(ranks.key_samples, {1, 3});
    to.one_of<std::size_t>(ranks.relayed, {1, 10});
    to.one_of<unsigned>(ranks.row_bin_bits, {0, 2, 5});
}

void shrink(Tuning::Scene& scene, Shrinker& to) {
    to.one_of<StepChoice>(scene.step, {StepChoice::full, StepChoice::incremental, StepChoice::incremental});
    to.one_of<unsigned>(scene.max_refills, {0, 1, 3});
    to.one_of<double>(scene.log_part, {0, 0.5});
    to.one_of<double>(scene.min_log, {1, 10, 1000});
    to.one_of<std::uint64_t>(scene.visits, {1, 20, 100000});
    to.one_of<std::uint64_t>(scene.changed_pairs, {1, 30, 100000});
    to.one_of<std::size_t>(scene.share_visits, {1, 7});
    to.one_of<std::size_t>(scene.run_visits, {1, 3});
    to.one_of<std::uint64_t>(scene.waiting_part, {1, 100});
    to.one_of<std::uint64_t>(scene.min_waiting, {1, 10});
    to.one_of<std::size_t>(scene.share_queries, {1, 2});
    to.one_of<std::size_t>(scene.min_sorted_queries, {1, 1000});
    to.one_of<std::size_t>(scene.max_kept_answers, {0, 1000});
    to.one_of<std::size_t>(scene.exact_part, {1, 2, 5});
}

void shrink(Tuning::Large& large, Shrinker& to) {
    to.one_of<std::size_t>(large.min_lists, {1, 50, 1000});
    to.one_of<std::size_t>(large.max_groups, {1, 3, 16});
    to.one_of<std::size_t>(large.staged_per_list, {1, 2});
    to.one_of<std::size_t>(large.stage_chunk, {1, 5});
    to.one_of<std::size_t>(large.max_near_table, {1, 1 << 17});
}

/// Drawn last, so that the seeds of earlier findings keep the other values.
void shrink_later(Tuning& tuning, Shrinker& to) {
    to.one_of<std::size_t>(tuning.dynamic.range_entries, {1, 10, 100});
    tuning.dynamic.min_range_entries = 1;
    to.one_of<std::size_t>(tuning.output.slotted_pairs_per_row, {0, 2, 12});
    to.one_of<unsigned>(tuning.output.max_slotted_row_bits, {2, 14});
    to.one_of<std::size_t>(tuning.sweep.cell_rows_per_call, {4, 8, 4096});
    to.one_of<double>(tuning.ranks.coordinates, {0, 0, 1 << 12, 1 << 20});
    to.one_of<double>(tuning.ranks.rounded_coordinates, {0, 0, 1 << 12, 1 << 20});
    to.one_of<double>(tuning.ranks.max_fine_part, {0, 0.5, 1});
    to.one_of<double>(tuning.ranks.max_inner_part, {0.2, 1});
    to.one_of<unsigned>(tuning.ranks.part_of_ranks, {1, 4});
    to.one_of<double>(tuning.ranks.crowd_part, {0, 1});
    to.one_of<double>(tuning.ranks.core_part, {0, 1});
    to.one_of<double>(tuning.ranks.handed_part, {0, 1});
    to.one_of<unsigned>(tuning.ranks.calls_with_boxes, {0, 1});
    tuning.ranks.calls_with_boxes = std::min(tuning.ranks.calls_with_boxes, 3u);  // tests make few calls in each scene
}

/// Accepts few sweeps and takes small samples, so that most octants count as crowded and octrees nest in them.
void favour_crowds(Tuning& tuning) {
    tuning.sampling.stride = 5;
    tuning.sampling.min_objects = 1;
    tuning.scan.max_swept_list = 1;
    tuning.scan.max_tests_per_box = 0;
    tuning.scan.max_part_in_octant = 0.9;
    tuning.scan.max_growth = 16;
    tuning.sweep.small_set = 2;
    tuning.sweep.cheap_tests = 0;
    tuning.sweep.tests_per_pair = 1;
}

}  // namespace

Tuning tiny_tuning(std::uint64_t seed) {
    Tuning tuning;
    Shrinker to(seed);
    shrink(tuning.sampling, to);
    shrink(tuning.split, to);
    shrink(tuning.build, to);
    shrink(tuning.scan, to);
    shrink(tuning.sweep, to);
    shrink(tuning.dynamic, to);
    shrink(tuning.output, to);
    shrink(tuning.processes, to);
    shrink(tuning.ranks, to);
    shrink(tuning.scene, to);
    shrink(tuning.large, to);
    shrink_later(tuning, to);
    if (seed % 3 == 0) favour_crowds(tuning);
    if (seed % 4 == 1) tuning.processes.nested_bytes = ~std::uint64_t(0);  // each worker builds its own nested octrees
    return tuning;
}

}  // namespace octopair::test
