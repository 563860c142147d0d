#include "cli/input/whole_inputs.hpp"

#include "cli/detect/pipeline_options.hpp"
#ifdef OCTOPAIR_WITH_PIPELINE
#include "cli/input/shaped_set.hpp"
#endif

namespace octopair::cli {

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
