#include "engines/contenders.hpp"

#include <algorithm>

#include "octopair/processes.hpp"

namespace octopair::bench {

namespace {

PlacedBoxes where_they_are(Engine&, std::span<const Box3f> boxes) { return {boxes}; }

PlacedBoxes where_the_engine_says(Engine& engine, std::span<const Box3f> boxes) {
    const auto array = std::make_shared<BoxArray<Box3f>>(engine.allocate_boxes(boxes.size()));
    std::copy(boxes.begin(), boxes.end(), array->boxes().begin());
    return {array->boxes(), array};
}

std::unique_ptr<Engine> make_processes(unsigned workers) { return make_process_engine(workers); }

}  // namespace

std::vector<Contender> contenders() {
    return {{local_name, make_local_engine, where_they_are},
            {processes_name, make_processes, where_they_are},
            {processes_name + ", boxes allocated", make_processes, where_the_engine_says}};
}

}  // namespace octopair::bench
