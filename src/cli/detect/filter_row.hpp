// The filters of a run: made of what was asked and what the scene files say, once; then used frame by frame.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <stop_token>

#include "cli/detect/detection.hpp"
#include "cli/input/input_set.hpp"
#include "octopair/pipeline.hpp"

namespace octopair::cli {

/// Both sets of a search; `second` is null but for a join.
struct SetPair {
    const InputSet& first;
    const InputSet* second = nullptr;
};

class FilterRow {
public:
    virtual ~FilterRow() = default;
    /// An empty sink counts.
    virtual PipelineSummary run(Engine& engine, std::uint64_t frame, const CollisionSink& sink,
                                const Options& options) = 0;
    /// The same of pairs that were found before.
    virtual PipelineSummary filter(const PairList& pairs, const CollisionSink& sink, const Options& options) = 0;
};

/// Borrows from the sets. Throws what is wrong with rules, and with objects that do not fit their shapes.
std::unique_ptr<FilterRow> make_filter_row(const DetectRequest& request, const SetPair& sets,
                                           const std::stop_token& stop);

}  // namespace octopair::cli
