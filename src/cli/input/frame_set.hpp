// FrameSet: the input files of the command line as one set of objects, read frame by frame.
//
// - At most one frame of a moving scene is in memory.
// - Objects have the numbers that InputSet gives them, and reading throws the errors that InputSet throws.
#pragma once

#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "cli/input/input_set.hpp"

namespace octopair::cli {

class FrameSet {
public:
    /// Throws: what read_input_set() throws; Error{bad_input} for JSON scenes.
    FrameSet(const std::vector<std::string>& paths, const io::SceneContent& content, const std::stop_token& stop);

    /// Returns the number of objects in each frame.
    std::uint64_t objects() const { return objects_; }
    /// Returns the files and their numbers of objects.
    std::span<const Part> parts() const { return still_.parts; }
    /// Returns the unit of the coordinates; empty if unknown.
    const std::string& unit() const { return still_.scene.space.unit; }
    const io::FrameCount& frames() const { return frames_; }
    /// Returns whether at least one file is float64.
    bool wide() const { return wide_; }
    /// Returns the names of the objects: empty, or one name per object.
    const std::vector<std::string>& names() const { return still_.scene.names; }

    /// Reads the boxes of a frame.
    /// Requires: `boxes` has one element per object; Real is double if the set is wide.
    /// Throws: Error{bad_input} that names the file and the object, for an invalid box; Error{io_failed, cancelled}.
    template <typename Real>
    void read(std::uint64_t frame, std::span<Box<Real>> boxes, const std::stop_token& stop) const;

private:
    struct MovingPart {
        std::string path;
        io::NpyFrames file;
    };

    void open_moving(const std::vector<std::string>& paths);

    InputSet still_;  // the objects of a scene that does not move; for a moving scene only its parts
    std::vector<MovingPart> moving_;
    std::uint64_t objects_ = 0;
    io::FrameCount frames_;
    bool wide_ = false;
};

}  // namespace octopair::cli
