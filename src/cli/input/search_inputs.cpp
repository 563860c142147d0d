#include "cli/input/search_inputs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "cli/detect/pipeline_options.hpp"
#include "cli/input/placement.hpp"
#include "io/boxes/npy.hpp"
#include "io/files/failure.hpp"
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
    io::SceneContent content{.objects = request.mesh_objects,
                             .shapes = has_filters(request),
                             .progress = [&progress](double done) { progress.show("reading", done); },
                             .reader = reader_of(request)};
    first = read_input_set(request.inputs, content, stop);
    content.unit = first.scene.space.unit;
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

namespace {

/// Returns the largest extent of a set along an axis. 0 for an empty set.
double size_of(const InputSet& set) {
    const Box3d bounds = set.bounds();
    double size = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) size = std::max(size, bounds.max[axis] - bounds.min[axis]);
    return size;
}

/// Returns the distance between neighbouring numbers of float32 at `value`. Requires: `value` is finite and > 0.
double float32_step(double value) { return std::ldexp(1.0, std::max(std::ilogb(value), -126) - 23); }

std::string name_of(const InputSet& set) {
    return set.parts.size() == 1 ? set.parts.front().path : fmt::format("{} and others", set.parts.front().path);
}

/// Returns a warning if the coordinates of a set are coarse, or an empty text.
std::string coarseness_of(const DetectRequest& request, const InputSet& set) {
    constexpr double fine = 1e-6;  // maximum step of coordinates that are not coarse, as a fraction of the scene's size
    const double largest = set.scene.largest_rounded;
    if (!(largest > 0) || !std::isfinite(largest)) return {};
    const double step = float32_step(largest), size = size_of(set);
    const bool coarse = step > fine * size;
    const bool too_coarse = request.pipeline.tolerance && *request.pipeline.tolerance < step;
    if (!coarse && !too_coarse) return {};
    std::string text = fmt::format("{}: coordinates up to {:.6g} were rounded to float32, in steps of {:.2g}",
                                   name_of(set), largest, step);
    if (too_coarse) text += fmt::format(", more than the tolerance {:.3g}", *request.pipeline.tolerance);
    text += fmt::format("; the scene measures {:.3g}. Gaps and overlaps below a step are not reliable", size);
    if (coarse) text += "; move the model nearer to its origin, or use a format with float64";
    return text;
}

}  // namespace

std::vector<std::string> input_warnings(const DetectRequest& request, const SetPair& sets) {
    std::vector<std::string> warnings;
    for (const InputSet* set : {&sets.first, sets.second}) {
        if (set == nullptr || set->parts.empty()) continue;
        warnings.insert(warnings.end(), set->scene.warnings.begin(), set->scene.warnings.end());
        for (const Part& part : set->parts) {
            if (part.objects == 0) warnings.push_back(part.path + ": has no object");
        }
        const std::string text = coarseness_of(request, *set);
        if (!text.empty()) warnings.push_back(text);
    }
    const auto differ = [](io::UpAxis a, io::UpAxis b) {
        return a != b && a != io::UpAxis::unknown && b != io::UpAxis::unknown;
    };
    bool mixed = sets.first.mixed_axes;
    if (const InputSet* const second = sets.second)
        mixed |= second->mixed_axes || differ(sets.first.scene.space.up, second->scene.space.up);
    if (mixed)
        warnings.emplace_back("the formats of the inputs have different axes up; coordinates are used as they are");
    add_placement_warnings(sets, request.margin, warnings);
    return warnings;
}

void refuse_empty_parts(std::span<const Part> parts) {
    for (const Part& part : parts) {
        if (part.objects > 0) continue;
        io::refuse(part.path,
                   "has no object, so --fail-on-collision checks nothing in it; leave out the file or the option");
    }
}

}  // namespace octopair::cli
