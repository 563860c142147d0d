#include "frames/memory.hpp"

#include <algorithm>

#include "frames/motion.hpp"
#include "measured_memory.hpp"
#include "octopair/scene.hpp"
#include "samples/scenes.hpp"

namespace octopair::bench {

namespace {

void step(octopair::Scene& scene, MemoryUse& use) {
    scene.step();
    use.pairs = scene.pairs().size();
}

MemoryUse measure_here(const MemoryCase& which) {
    Motion motion(samples::make_scene(which.kind, which.objects, 1), which.share);
    std::vector<ObjectId> ids(which.objects), moved(motion.movers());
    MemoryUse use;
    forget_peak();
    const double before = status_bytes("VmRSS");
    octopair::Scene scene({.threads = 1});
    scene.add(Objects{motion.boxes()}, ids);
    step(scene, use);
    use.first_peak = status_bytes("VmHWM") - before;
    forget_peak();
    for (unsigned i = 0; i < which.frames; ++i) {
        const Frame frame = motion.next();
        std::transform(frame.moved.begin(), frame.moved.end(), moved.begin(), [&](auto object) { return ids[object]; });
        scene.move(moved, frame.moved_boxes);
        step(scene, use);
    }
    use.peak = status_bytes("VmHWM") - before;
    use.steady = status_bytes("VmRSS") - before;
    return use;
}

}  // namespace

std::vector<MemoryCase> memory_cases() {
    constexpr std::uint64_t objects = 1'000'000;
    constexpr unsigned frames = 20;
    std::vector<MemoryCase> cases;
    for (const char* kind : {"uniform", "dense"}) {
        for (const double share : {0.01, 1.0}) cases.push_back({kind, objects, share, frames});
    }
    return cases;
}

MemoryUse measure_memory(const MemoryCase& which) {
    return measured_apart([&] { return measure_here(which); });
}

}  // namespace octopair::bench
