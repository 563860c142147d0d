#include "cluster/on_ranks.hpp"

#include <algorithm>
#include <chrono>
#include <thread>

#include "engine/mpi/comm/message_tape.hpp"
#include "samples/scenes.hpp"

namespace octopair::cluster {

namespace {

/// Returns objects [begin, end) of the scene.
std::vector<Box3f> make_slice(const Setup& setup, std::uint64_t begin, std::uint64_t end) {
    std::vector<Box3f> own;
    if (begin == end) return own;
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

namespace {

/// One rank with its slice of a scene.
class Measuring {
public:
    Measuring(MPI_Comm comm, const Setup& setup, unsigned rounds, const std::stop_token& stop)
        : comm_(comm),
          rounds_(rounds),
          stop_(stop),
          engine_(
              make_mpi_engine(comm, {.arrangement = setup.arrangement, .ranks_per_machine = setup.ranks_per_machine})) {
        MPI_Comm_rank(comm, &rank_);
        MPI_Comm_size(comm, &ranks_);
        const auto part = [&](int number) {
            if (setup.arrangement == Arrangement::paper) return number == 0 ? 0 : setup.objects;
            return setup.objects * std::uint64_t(number) / std::uint64_t(ranks_);
        };
        own_ = make_slice(setup, part(rank_), part(rank_ + 1));
        measured_.setup = setup;
        measured_.setup.ranks = unsigned(ranks_);
    }

    Measured run() {
        measure_together();
        measure_alone();
        return measured_;
    }

private:
    void measure_together() {
        std::vector<RankCosts> costs;
        std::vector<Summary> summaries;
        for (unsigned round = 0; round <= rounds_; ++round) {
            MPI_Barrier(comm_);
            const Summary summary = call();
            if (round == 0) continue;
            summaries.push_back(summary);
            costs.push_back(last_costs(*engine_));
        }
        measured_.pairs = summaries.back().pairs;
        measured_.entries = summaries.back().entries;
        measured_.wall_seconds = median(summaries, &Summary::seconds);
        measured_.together = gather(median(costs));
    }

    void measure_alone() {
        MessageTape tape;
        use_tape(*engine_, &tape);
        tape.record();
        (void)call();
        // With a single turn per rank, a short disturbance of the machine would affect all calls of one rank.
        constexpr unsigned turns = 3;
        std::vector<RankCosts> costs;
        for (unsigned turn = 0; turn < turns * unsigned(ranks_); ++turn) {
            wait_for_all();
            const bool own = turn % unsigned(ranks_) == unsigned(rank_);
            for (unsigned round = 0; own && round <= (rounds_ + turns - 1) / turns; ++round) {
                tape.replay();
                (void)call();
                if (round > 0) costs.push_back(last_costs(*engine_));
            }
        }
        use_tape(*engine_, nullptr);
        measured_.alone = gather(median(costs));
    }

    Summary call() {
        Options options;
        options.order = Order::octal;
        return engine_->find_pairs({std::span(own_), {}}, pairs_, options, stop_);
    }

    /// Waits for all ranks. Unlike MPI's barrier, takes no processor time from ranks that are still computing.
    void wait_for_all() {
        constexpr auto nap = std::chrono::milliseconds(10);
        MPI_Request request = MPI_REQUEST_NULL;
        MPI_Ibarrier(comm_, &request);
        for (int done = 0; MPI_Test(&request, &done, MPI_STATUS_IGNORE), done == 0;) std::this_thread::sleep_for(nap);
    }

    std::vector<RankCosts> gather(const RankCosts& mine) {
        std::vector<RankCosts> all(std::size_t(ranks_), RankCosts{});
        MPI_Gather(&mine, int(sizeof mine), MPI_BYTE, all.data(), int(sizeof mine), MPI_BYTE, 0, comm_);
        return all;
    }

    MPI_Comm comm_;
    unsigned rounds_;
    std::stop_token stop_;
    std::unique_ptr<Engine> engine_;
    int rank_ = 0, ranks_ = 1;
    std::vector<Box3f> own_;
    PairList pairs_;
    Measured measured_;
};

}  // namespace

Measured measure_on_ranks(MPI_Comm comm, const Setup& setup, unsigned rounds, const std::stop_token& stop) {
    return Measuring(comm, setup, rounds, stop).run();
}

}  // namespace octopair::cluster
