#include "engines/contenders.hpp"

#include "octopair/processes.hpp"

namespace octopair::bench {

namespace {

PlacedBoxes where_they_are(Engine&, std::span<const Box3f> boxes) { return {boxes}; }

std::unique_ptr<Engine> make_processes(unsigned workers) { return make_process_engine(workers); }

std::unique_ptr<Engine> make_paper(unsigned workers) {
    return make_process_engine({.workers = workers, .arrangement = Arrangement::paper});
}

}  // namespace

std::vector<Contender> contenders() {
    return {{local_name, make_local_engine, where_they_are},
            {processes_name, make_processes, where_they_are},
            {paper_name, make_paper, where_they_are}};
}

}  // namespace octopair::bench
