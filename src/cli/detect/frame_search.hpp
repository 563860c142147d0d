// SearchGroup: the processes that search together, and FrameSearch: how they find and write the pairs of one frame after another.
// Each has two implementations:
// - stream_search.cpp: one process with any engine streams its pairs.
// - rank_group.hpp, rank_search.cpp: ranks of MPI read slices of the inputs, and join their pieces of the result.
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
    /// Finds and writes the pairs of a frame, or only counts them, and updates the report. Requires: frames are passed in ascending order.
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
    /// Collective. Compares the inputs of all ranks. Throws: Error{usage} if some ranks have read different files or objects.
    virtual void compare_inputs(DetectRun& run) = 0;
    /// Makes the search of this process. Collective, as are all functions of the search. Borrows the run. Requires: the inputs were read.
    /// Throws: what the makers of engines throw.
    virtual std::unique_ptr<FrameSearch> make_search(DetectRun& run) = 0;
};

std::unique_ptr<SearchGroup> one_process();

}  // namespace octopair::cli
