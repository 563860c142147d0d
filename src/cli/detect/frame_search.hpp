// FrameSearch: finds and writes the pairs of one frame after another. There are two: one streams the pairs of a single
// process (stream_search.cpp), the other joins the pieces of all ranks (rank_search.cpp).
#pragma once

#include <cstdint>
#include <memory>
#include <stop_token>

#include "cli/command/progress_line.hpp"
#include "cli/detect/detection.hpp"
#include "cli/input/whole_inputs.hpp"

namespace octopair::cli {

/// One run of `octopair detect`: what was asked, what was read, what has come out so far.
struct DetectRun {
    const DetectRequest& request;
    std::stop_token stop;
    ProgressLine progress;
    WholeInputs inputs = {};  ///< or a slice of each set
    DetectReport report = {};

    bool join() const { return !request.against.empty(); }
    /// Returns the other set of a join, or the only set.
    const InputSet& second_or_first() const { return join() ? inputs.second : inputs.first; }
    /// Throws: Error{bad_input} if an input file was changed. Call before the results of a frame are completed.
    void check_inputs() const {
        for (const InputSet* set : {&inputs.first, &inputs.second}) set->scene.check_mapped();
    }
    /// Returns the options of the call for a frame, given the frames that the report already counts.
    Options call_options(std::uint64_t frame);
};

class FrameSearch {
public:
    virtual ~FrameSearch() = default;
    /// Makes filters and output files. To be called once, before search().
    virtual void prepare() = 0;
    /// Finds the pairs of a frame, writes them unless they are only counted, and adds to the report. Frames come in order.
    virtual void search(std::uint64_t frame) = 0;
    /// Completes the output files. To be called once, after the last frame.
    virtual void finish() = 0;
};

/// Borrows the run, whose inputs are whole. Throws what the makers of engines throw.
std::unique_ptr<FrameSearch> make_stream_search(DetectRun& run);

#ifdef OCTOPAIR_WITH_MPI
class Cluster;

/// True if every rank needs all objects. Filters and verification look at any object, and boxes of shapes may depend on all.
bool needs_whole_inputs(const DetectRequest& request);
/// Reads this rank's slice of each set.
void read_slices(DetectRun& run, const Cluster& cluster);
/// Throws: Error{resource_limit} for more objects than the requested output, filters or verification can number.
void check_index_width(const DetectRun& run);

/// Collective, as all functions of its result. Borrows both.
std::unique_ptr<FrameSearch> make_rank_search(DetectRun& run, Cluster& cluster);
#endif

}  // namespace octopair::cli
