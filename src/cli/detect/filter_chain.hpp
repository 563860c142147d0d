// FilterChain: the filters of a run. They are made once, from the request and the scene files, and run on each frame.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "cli/detect/detection.hpp"
#include "cli/detect/row_filters.hpp"
#include "cli/input/input_set.hpp"
#include "octopair/pipeline.hpp"

namespace octopair::cli {

class FilterChain {
public:
    virtual ~FilterChain() = default;
    /// Returns warnings about rules that can leave out nothing, each one line.
    virtual const std::vector<std::string>& warnings() const = 0;
    /// Finds the pairs of a frame, filters them, and passes the result to `sink`. With an empty sink, it counts only.
    virtual PipelineSummary run(Engine& engine, std::uint64_t frame, const CollisionSink& sink,
                                const Options& options) = 0;
    /// Filters `pairs`, which an engine has found for the frame, and passes the result to `sink`. With an empty sink, it counts only.
    virtual PipelineSummary filter(const PairList& pairs, const CollisionSink& sink, const Options& options) = 0;
    /// Finds the pairs of a frame that exclusion rules leave out, ascending. Requires: the request has --verify.
    /// Memory: 8 bytes per pair of boxes, if there are rules.
    virtual std::vector<Pair> excluded(Engine& engine, std::uint64_t frame) = 0;
    /// Returns the pairs that options such as --exclude, --min-depth and --classes have left out. Requires: the request has --statuses.
    virtual std::span<const Pair> left_out() const = 0;
    /// Returns the collisions that --classes has left out. Requires: the request has --verify.
    virtual const LeftOut& left_out_by_class() const = 0;
};

/// Makes the filters of the request. Borrows the shapes and names of the sets.
/// Throws: Error for invalid exclusion rules, and for objects that do not fit their shapes.
std::unique_ptr<FilterChain> make_filter_chain(const DetectRequest& request, const SetPair& sets,
                                               const std::stop_token& stop);

}  // namespace octopair::cli
