// All that `octopair detect` reads, whole: the objects of the inputs, those of the other set of a join, and paddings.
#pragma once

#include <optional>
#include <stop_token>

#include "cli/detect/detection.hpp"
#include "cli/input/input_set.hpp"
#include "cli/input/join.hpp"

namespace octopair::cli {

/// Sets borrow from it, so it stays where it is.
struct WholeInputs {
    WholeInputs() = default;
    WholeInputs(const WholeInputs&) = delete;
    WholeInputs& operator=(const WholeInputs&) = delete;

    InputSet first;
    InputSet second;  ///< of a join
    io::FrameCount frames;
    std::optional<Paddings> padding;  ///< of the request's file

    /// With shapes, where filters need them. Throws what read_input_set, joint_frames and Paddings throw.
    void read(const DetectRequest& request, const std::stop_token& stop);
};

}  // namespace octopair::cli
