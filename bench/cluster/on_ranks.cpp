#include "cluster/on_ranks.hpp"

#include <algorithm>
#include <cstring>

#include "samples/scenes.hpp"

namespace octopair::cluster {

namespace {

/// Objects [begin, end) of the scene.
std::vector<Box3f> make_slice(const Setup& setup, std::uint64_t begin, std::uint64_t end) {
    std::vector<Box3f> own;
    own.reserve(std::size_t(end - begin));
    std::uint64_t at = 0;
    samples::generate_scene({setup.scene, setup.objects, 1}, [&](std::span<const Box3f> boxes) {
        const std::uint64_t first = std::clamp(begin, at, at + boxes.size());
        const std::uint64_t last = std::clamp(end, at, at + boxes.size());
        own.insert(own.end(), boxes.begin() + std::ptrdiff_t(first - at), boxes.begin() + std::ptrdiff_t(last - at));
        at += boxes.size();
    });
    return own;
}

template <typename Number, typename Of>
Number median(const std::vector<Of>& runs, Number Of::*member) {
    std::vector<Number> numbers;
    numbers.reserve(runs.size());
    for (const Of& run : runs) numbers.push_back(run.*member);
    const auto middle = numbers.begin() + std::ptrdiff_t(numbers.size() / 2);
    std::nth_element(numbers.begin(), middle, numbers.end());
    return *middle;
}

RankCosts median(const std::vector<RankCosts>& runs) {
    RankCosts costs = runs.back();
    for (const Step& step : computing_steps) costs.*step.seconds = median(runs, step.seconds);
    costs.mpi = median(runs, &RankCosts::mpi);
    return costs;
}

}  // namespace

// NOLINTNEXTLINE(readability-function-size): where, what, how often, until when.
Measured measure_on_ranks(MPI_Comm comm, const Setup& setup, unsigned rounds, const std::stop_token& stop) {
    int rank = 0, ranks = 0;
    MPI_Comm_rank(comm, &rank);
    MPI_Comm_size(comm, &ranks);
    const auto part = [&](int number) { return setup.objects * std::uint64_t(number) / std::uint64_t(ranks); };
    const std::vector<Box3f> own = make_slice(setup, part(rank), part(rank + 1));
    const auto engine = make_mpi_engine(comm);
    Options options;
    options.order = Order::octal;
    PairList pairs;
    std::vector<RankCosts> costs;
    std::vector<Summary> summaries;
    for (unsigned round = 0; round <= rounds; ++round) {
        MPI_Barrier(comm);
        const Summary summary = engine->find_pairs({std::span(own), {}}, pairs, options, stop);
        if (round == 0) continue;
        summaries.push_back(summary);
        costs.push_back(last_costs(*engine));
    }
    Measured measured{
        setup, summaries.back().pairs, summaries.back().entries, median(summaries, &Summary::seconds), {}};
    measured.setup.ranks = unsigned(ranks);
    measured.ranks.resize(std::size_t(ranks));
    const RankCosts mine = median(costs);
    MPI_Gather(&mine, int(sizeof mine), MPI_BYTE, measured.ranks.data(), int(sizeof mine), MPI_BYTE, 0, comm);
    return measured;
}

}  // namespace octopair::cluster
