// The files named on the command line as one set of objects whose frames are read one by one: of a moving scene no more
// than a frame is in memory. What is numbered and what is refused is the same as for an InputSet.
#pragma once

#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "cli/input/input_set.hpp"

namespace octopair::cli {

class FrameSet {
public:
    /// Throws what read_input_set throws.
    FrameSet(const std::vector<std::string>& paths, const io::SceneContent& content, const std::stop_token& stop);

    std::uint64_t objects() const { return objects_; }  ///< in each frame
    const io::FrameCount& frames() const { return frames_; }
    bool wide() const { return wide_; }  ///< float64 somewhere
    /// Empty, or one an object.
    const std::vector<std::string>& names() const { return still_.scene.names; }

    /// Fills `boxes`, as many as there are objects, from a frame; Real is double where the set is wide. Throws
    /// Error{bad_input} that names the file and the object for what is not a box; Error{io_failed, cancelled}.
    template <typename Real>
    void read(std::uint64_t frame, std::span<Box<Real>> boxes, const std::stop_token& stop) const;

private:
    struct MovingPart {
        std::string path;
        io::NpyFrames file;
    };

    void open_moving(const std::vector<std::string>& paths);

    InputSet still_;  // empty if the set moves
    std::vector<MovingPart> moving_;
    std::uint64_t objects_ = 0;
    io::FrameCount frames_;
    bool wide_ = false;
};

}  // namespace octopair::cli
