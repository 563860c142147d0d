// What the two sets of a join must agree on, and the paddings of both.
#pragma once

#include <span>
#include <stop_token>
#include <string>

#include "cli/detect/detection.hpp"

namespace octopair::cli {

/// The frames of the result; a set that stands still goes with any number. Throws Error{bad_input} where both sets move
/// and have other numbers of frames.
io::FrameCount joint_frames(const io::FrameCount& inputs, const io::FrameCount& against, const DetectRequest& request);

/// How many objects each set has.
struct SetSizes {
    std::uint64_t inputs = 0;
    std::uint64_t against = 0;
};

/// One clearance for each object of the inputs; of a join also for those of the other set, after them.
class Paddings {
public:
    /// None if the request names no file. Throws what io::read_padding throws, and Error{bad_input} for another number.
    Paddings(const DetectRequest& request, const SetSizes& sizes, const std::stop_token& stop);

    /// Empty, or one an object.
    std::span<const double> inputs() const { return all_.span().first(inputs_); }
    std::span<const double> against() const { return all_.span().subspan(inputs_); }

private:
    Buffer<double> all_;
    std::size_t inputs_ = 0;
};

}  // namespace octopair::cli
