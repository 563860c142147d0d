#include "engines/memory.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <thread>

#include "engines/contenders.hpp"
#include "measured_memory.hpp"
#include "samples/scenes.hpp"

namespace octopair::bench {

namespace {

constexpr unsigned calls = 5;

/// Returns the proportional set size of one process, or 0 if the size cannot be read.
double bytes_of(const std::string& process) {
    std::ifstream rollup("/proc/" + process + "/smaps_rollup");
    for (std::string line; std::getline(rollup, line);) {
        if (line.starts_with("Pss:")) return std::strtod(line.c_str() + 4, nullptr) * 1024;
    }
    return 0;
}

/// Returns the sum of the proportional set sizes of this process and its children.
double bytes_of_all() {
    double bytes = bytes_of("self");
    for (const auto& thread : std::filesystem::directory_iterator("/proc/self/task")) {
        std::ifstream children(thread.path() / "children");
        for (std::string child; children >> child;) bytes += bytes_of(child);
    }
    return bytes;
}

/// Samples the memory repeatedly on its own thread.
class Watch {
public:
    Watch() : thread_([this] { look(); }) {}
    Watch(const Watch&) = delete;
    Watch& operator=(const Watch&) = delete;
    ~Watch() {
        over_ = true;
        thread_.join();
    }
    double highest() const { return highest_; }

private:
    void look() {
        while (!over_) {
            highest_ = std::max(highest_.load(), bytes_of_all());
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
    }

    std::atomic<bool> over_ = false;
    std::atomic<double> highest_ = 0;
    std::thread thread_;
};

EngineMemoryUse measure_here(const EngineMemoryCase& which, unsigned width) {
    const std::vector<Contender> all = contenders();
    const auto found = std::find_if(all.begin(), all.end(), [&](const auto& one) { return one.name == which.engine; });
    if (found == all.end()) throw std::out_of_range("no engine " + which.engine);
    const std::vector<Box3f> boxes = samples::make_scene(which.kind, which.objects, 1);
    EngineMemoryUse use;
    const double before = bytes_of_all();
    const std::unique_ptr<Engine> engine = found->make(width);
    std::this_thread::sleep_for(std::chrono::milliseconds(200));  // waits until the workers have started
    use.idle = bytes_of_all() - before;
    const PlacedBoxes placed = found->place(*engine, boxes);
    PairList list;
    const auto call = [&] { engine->find_pairs({placed.boxes}, list, {.order = which.order}); };
    call();
    {
        Watch watch;
        for (unsigned i = 0; i < calls; ++i) call();
        use.highest = watch.highest() - before;
    }
    use.kept = bytes_of_all() - before;
    use.pairs = list.size();
    // Boxes in the engine's memory are input, because an application would have no other copy of them.
    const double input = placed.keeper != nullptr ? double(placed.boxes.size_bytes()) : 0;
    const double beside = input + double(use.pairs) * sizeof(Pair);
    use.kept -= beside;
    use.highest = std::max(use.highest - beside, use.kept);
    return use;
}

}  // namespace

std::vector<EngineMemoryCase> engine_memory_cases() {
    std::vector<EngineMemoryCase> cases;
    for (const char* kind : {"uniform", "dense"}) {
        for (const Order order : {Order::octal, Order::ascending}) {
            for (const Contender& contender : contenders()) cases.push_back({contender.name, kind, 1'000'000, order});
        }
    }
    return cases;
}

EngineMemoryUse measure_memory(const EngineMemoryCase& which, unsigned width) {
    return measured_apart([&] { return measure_here(which, width); });
}

}  // namespace octopair::bench
