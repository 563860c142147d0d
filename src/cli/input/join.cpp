#include "cli/input/join.hpp"

#include <fmt/format.h>

#include "io/boxes/npy.hpp"
#include "octopair/error.hpp"

namespace octopair::cli {

io::FrameCount joint_frames(const io::FrameCount& inputs, const io::FrameCount& against, const DetectRequest& request) {
    if (inputs.moving && against.moving && inputs.frames != against.frames) {
        throw Error(ErrorCode::bad_input,
                    fmt::format("{}: has {} frames, but {} has {}; both must have the same number", request.against,
                                against.frames, request.inputs.front(), inputs.frames));
    }
    return inputs.moving ? inputs : against;
}

Paddings::Paddings(const DetectRequest& request, const SetSizes& sizes, const std::stop_token& stop) {
    if (request.padding.empty()) return;
    all_ = io::read_padding(request.padding, stop);
    if (all_.size() != sizes.inputs && all_.size() != sizes.inputs + sizes.against) {
        throw Error(ErrorCode::bad_input,
                    fmt::format("{}: {} paddings for {} objects", request.padding, all_.size(), sizes.inputs));
    }
    inputs_ = std::size_t(sizes.inputs);
}

}  // namespace octopair::cli
