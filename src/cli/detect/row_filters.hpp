// The last filters of `octopair detect`: which collisions become rows, by their depth and their class (--min-depth, --classes).
//
// - A row that --min-depth leaves out stays out whatever --tolerance and --duplicate-tolerance are. So options together never give more
//   rows than one of them alone.
// - --tolerance and --duplicate-tolerance leave out nothing. They change the class.
#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "cli/detect/pipeline_options.hpp"
#include "octopair/pipeline.hpp"

namespace octopair::cli {

/// Returns the filter "depth" for a pipeline whose feature filter has other tolerances than the default. Requires: it is before the feature
/// filter. It drops pairs that are less deep than `min_depth` by the finding of `features`, but leaves the findings of the batch as they are.
std::unique_ptr<Filter> make_early_depth_filter(std::unique_ptr<Filter> features, double min_depth);

/// Returns the filter "classes", which keeps collisions of these classes.
std::unique_ptr<Filter> make_class_filter(const ClassSet& classes);

/// Pairs that a filter has dropped. Thread safety: several threads may add.
struct LeftOut {
    bool keeps_findings = false;
    std::mutex mutex = {};
    std::vector<Pair> pairs = {};
    std::vector<Finding> findings = {};  ///< with keeps_findings, one per pair; empty findings before the exact filters
};

/// Returns a filter that does the same as `filter`, and adds the dropped pairs to `left_out`. Borrows `left_out`.
std::unique_ptr<Filter> make_recorded_filter(std::unique_ptr<Filter> filter, LeftOut& left_out);

}  // namespace octopair::cli
