// Inputs of a search: one set, or the two sets of a join, with their frames and paddings, and warnings about them.
#pragma once

#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "cli/command/progress_line.hpp"
#include "cli/detect/detection.hpp"
#include "cli/input/input_set.hpp"

namespace octopair::cli {

/// Returns the number of frames of the result: that of the set that moves. A set that does not move is the same in each frame.
/// Throws: Error{bad_input} if both sets move and have different numbers of frames.
io::FrameCount joint_frames(const io::FrameCount& inputs, const io::FrameCount& against, const DetectRequest& request);

/// Number of objects of each set.
struct SetSizes {
    std::uint64_t inputs = 0;
    std::uint64_t against = 0;
};

/// Paddings of --padding: first of the objects of the inputs, then of the objects of the second set of a join.
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

/// All objects and paddings that `octopair detect` reads. Neither copyable nor movable, because the sets borrow from `padding`.
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

/// Returns warnings, each one line: warnings of the readers, and about inputs without objects, coarse coordinates, different axes up, missing units, and
/// inputs that do not meet.
/// Coordinates are coarse if the steps of float32, to which they were rounded, are large compared with the scene or the tolerance.
/// Requires: the sets are whole and have boxes.
std::vector<std::string> input_warnings(const DetectRequest& request, const SetPair& sets);

/// Refuses files without objects: with --fail-on-collision, a check of nothing must not pass. Throws: Error{bad_input} that names the file.
void refuse_empty_parts(std::span<const Part> parts);

}  // namespace octopair::cli
