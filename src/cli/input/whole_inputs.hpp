// WholeInputs: all objects and paddings that `octopair detect` reads.
#pragma once

#include <optional>
#include <stop_token>

#include "cli/command/progress_line.hpp"
#include "cli/detect/detection.hpp"
#include "cli/input/input_set.hpp"
#include "cli/input/join.hpp"

namespace octopair::cli {

/// Neither copyable nor movable, because the sets borrow from `padding`.
struct WholeInputs {
    WholeInputs() = default;
    WholeInputs(const WholeInputs&) = delete;
    WholeInputs& operator=(const WholeInputs&) = delete;

    InputSet first;
    InputSet second;  ///< second set of a join, else empty
    io::FrameCount frames;
    std::optional<Paddings> padding;  ///< paddings of --padding

    /// Reads the inputs, with shapes if filters need shapes. Shows progress.
    /// Throws: what read_input_set(), make_shaped(), joint_frames() and Paddings throw.
    void read(const DetectRequest& request, ProgressLine& progress, const std::stop_token& stop);
};

}  // namespace octopair::cli
