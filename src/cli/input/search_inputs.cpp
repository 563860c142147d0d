#include "cli/input/search_inputs.hpp"

#include <fmt/format.h>

#include "cli/detect/pipeline_options.hpp"
#include "io/boxes/npy.hpp"
#include "octopair/error.hpp"
#ifdef OCTOPAIR_WITH_PIPELINE
#include "cli/input/shaped_set.hpp"
#endif

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

void WholeInputs::read(const DetectRequest& request, ProgressLine& progress, const std::stop_token& stop) {
    const io::SceneContent content{request.mesh_objects, has_filters(request),
                                   [&progress](double done) { progress.show("reading", done); }};
    first = read_input_set(request.inputs, content, stop);
    if (!request.against.empty()) second = read_input_set({request.against}, content, stop);
#ifdef OCTOPAIR_WITH_PIPELINE
    progress.show("preparing shapes", 0);
    make_shaped(first, second, {local_threads(request.engine), request.pipeline.weld.value_or(0)}, stop);
#endif
    const io::LoadedScene &a = first.scene, &b = second.scene;
    frames = joint_frames({a.frames, a.moving}, {b.frames, b.moving}, request);
    padding.emplace(request, SetSizes{a.objects, b.objects}, stop);
    if (!request.padding.empty()) {
        first.padding = padding->inputs();
        second.padding = padding->against();
    }
}

}  // namespace octopair::cli
