// Frames and paddings of the two sets of a join.
#pragma once

#include <span>
#include <stop_token>
#include <string>

#include "cli/detect/detection.hpp"

namespace octopair::cli {

/// Returns the frames of the result. A set that does not move fits any number of frames.
/// Throws: Error{bad_input} if both sets move and have different numbers of frames.
io::FrameCount joint_frames(const io::FrameCount& inputs, const io::FrameCount& against, const DetectRequest& request);

/// Number of objects of each set.
struct SetSizes {
    std::uint64_t inputs = 0;
    std::uint64_t against = 0;
};

/// Paddings of the objects of the inputs, and after them those of the second set of a join.
class Paddings {
public:
    /// Reads the file of --padding. Without --padding, there are no paddings.
    /// Throws: what io::read_padding() throws; Error{bad_input} if the number of paddings is wrong.
    Paddings(const DetectRequest& request, const SetSizes& sizes, const std::stop_token& stop);

    // Each function returns a span that is empty, or has one padding per object of the set.

    std::span<const double> inputs() const { return all_.span().first(inputs_); }
    std::span<const double> against() const { return all_.span().subspan(inputs_); }

private:
    Buffer<double> all_;
    std::size_t inputs_ = 0;
};

}  // namespace octopair::cli
