// SearchGroup: the processes that search together, and FrameSearch: how they find and write the pairs of one frame after another.
// There are two of each: one process with any engine streams its pairs (stream_search.cpp); ranks of MPI read slices and join their
// pieces (rank_group.hpp).
#pragma once

#include <cstdint>
#include <memory>
#include <stop_token>

#include "cli/command/progress_line.hpp"
#include "cli/detect/detection.hpp"
#include "cli/input/search_inputs.hpp"
#include "cli/ranks/group.hpp"

namespace octopair::cli {

/// One run of `octopair detect`: its request, its inputs, and its report so far.
struct DetectRun {
    const DetectRequest& request;
    std::stop_token stop;
    ProgressLine progress;
    WholeInputs inputs = {};  ///< on ranks without filters: only a slice of each set
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

class SearchGroup {
public:
    virtual ~SearchGroup() = default;
    virtual Group& processes() = 0;
    /// Reads the objects that this process needs. Requires: called within Group::together().
    virtual void read_inputs(DetectRun& run) = 0;
    /// Throws: Error{resource_limit} for more objects than the requested output, filters or verification can number.
    /// Requires: called within Group::together().
    virtual void check_objects(DetectRun& run) = 0;
    /// Collective. Throws: Error{usage} if the processes have read other objects, so that their pairs would belong to no scene.
    virtual void compare_inputs(DetectRun& run) = 0;
    /// Makes the search of this process. Collective, as are all functions of the search. Borrows the run. Requires: the inputs were read.
    /// Throws: what the makers of engines throw.
    virtual std::unique_ptr<FrameSearch> make_search(DetectRun& run) = 0;
};

std::unique_ptr<SearchGroup> one_process();

}  // namespace octopair::cli
