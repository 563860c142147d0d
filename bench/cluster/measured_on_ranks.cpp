// Measures the costs of calls on the ranks.
#include "cluster/measured.hpp"

#include <algorithm>
#include <chrono>
#include <memory>
#include <span>
#include <thread>
#include <utility>

#include "cluster/paper_master.hpp"
#include "cluster/regions.hpp"
#include "cluster/scene_slice.hpp"
#include "engine/mpi/comm/message_tape.hpp"
#include "octopair/error.hpp"
#include "samples/scenes.hpp"

namespace octopair::cluster {

namespace {

template <typename Of, typename Number, typename Class>
Number median(const std::vector<Of>& runs, Number Class::*member) {
    std::vector<Number> numbers;
    numbers.reserve(runs.size());
    for (const Of& run : runs) numbers.push_back(run.*member);
    const auto middle = numbers.begin() + std::ptrdiff_t(numbers.size() / 2);
    std::nth_element(numbers.begin(), middle, numbers.end());
    return *middle;
}

Costs median(const std::vector<Costs>& runs) {
    Costs costs = runs.back();
    for (const Step& step : computing_steps) costs.*step.seconds = median(runs, step.seconds);
    costs.mpi = median(runs, &Costs::mpi);
    return costs;
}

/// Returns the costs of the call that took least.
Costs least(const std::vector<Costs>& runs) {
    return *std::ranges::min_element(runs, {}, [](const Costs& costs) { return computing(costs); });
}

/// Calls on a slice of a scene, and their repetition on one rank alone.
class Calls {
public:
    virtual ~Calls() = default;
    /// Collective. Finds the pairs of all ranks. `entries` and `pairs` of the summary are right on rank 0.
    virtual Summary call() = 0;
    /// Collective. Keeps what this rank receives in a call.
    virtual void begin_alone() = 0;
    /// Repeats this rank's part of that call.
    virtual void repeat_alone() = 0;
    virtual Costs costs() const = 0;
};

/// Each rank has an equal part of the objects and shares every step.
class SharedCalls final : public Calls {
public:
    SharedCalls(MPI_Comm comm, std::span<const Box3f> own, bool listed, std::stop_token stop)
        : engine_(make_mpi_engine(comm)), own_(own), listed_(listed), stop_(std::move(stop)) {}
    SharedCalls(const SharedCalls&) = delete;
    SharedCalls& operator=(const SharedCalls&) = delete;
    ~SharedCalls() override { use_tape(*engine_, nullptr); }

    Summary call() override {
        Options options;
        options.order = Order::octal;
        if (listed_) return engine_->find_pairs({own_, {}}, pairs_, options, stop_);
        Summary summary;
        summary.pairs = engine_->count_pairs({own_, {}}, options, stop_);
        return summary;
    }
    void begin_alone() override {
        use_tape(*engine_, &tape_);
        tape_.record();
        (void)call();
    }
    void repeat_alone() override {
        tape_.replay();
        (void)call();
    }
    Costs costs() const override { return {last_costs(*engine_)}; }

private:
    std::unique_ptr<Engine> engine_;
    std::span<const Box3f> own_;
    bool listed_;
    std::stop_token stop_;
    PairList pairs_;
    MessageTape tape_;
};

/// Rank 0 has all objects, deals them out, and merges and scans alone.
class PaperCalls final : public Calls {
public:
    PaperCalls(MPI_Comm comm, unsigned ranks_per_machine, std::span<const Box3f> own)
        : master_(comm, ranks_per_machine), own_(own) {}

    Summary call() override {
        const auto begin = std::chrono::steady_clock::now();
        master_.find_pairs(own_);
        Summary summary;
        summary.pairs = master_.pairs().size();
        summary.entries = master_.entries();
        summary.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
        return summary;
    }
    void begin_alone() override { master_.find_pairs(own_); }
    void repeat_alone() override { master_.repeat_alone(); }
    Costs costs() const override { return master_.costs(); }

private:
    PaperMaster master_;
    std::span<const Box3f> own_;
};

/// One rank with its slice of a scene.
class Measuring {
public:
    Measuring(MPI_Comm comm, const Setup& setup, unsigned rounds, const std::stop_token& stop)
        : comm_(comm), rounds_(rounds), stop_(stop) {
        MPI_Comm_rank(comm, &rank_);
        MPI_Comm_size(comm, &ranks_);
        const bool paper = setup.arrangement == Arrangement::paper;
        const auto part = [&](int number) {
            if (paper) return number == 0 ? 0 : setup.objects;
            return setup.objects * std::uint64_t(number) / std::uint64_t(ranks_);
        };
        own_ = make_slice({setup.scene, setup.objects}, part(rank_), part(rank_ + 1));
        if (paper) {
            calls_ = std::make_unique<PaperCalls>(comm, setup.ranks_per_machine, own_);
        } else {
            if (setup.arrangement == Arrangement::space) own_ = in_order_of_space(comm, std::move(own_));
            if (setup.arrangement == Arrangement::blocks) own_ = in_blocks(comm, std::move(own_));
            calls_ = std::make_unique<SharedCalls>(comm, own_, setup.arrangement == Arrangement::shared, stop);
        }
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
        std::vector<Costs> costs;
        std::vector<Summary> summaries;
        for (unsigned round = 0; round <= rounds_; ++round) {
            int stopped = stop_.stop_requested() ? 1 : 0;
            MPI_Allreduce(MPI_IN_PLACE, &stopped, 1, MPI_INT, MPI_MAX, comm_);
            if (stopped != 0) throw Error(ErrorCode::cancelled, "cancelled");
            const Summary summary = calls_->call();
            if (round == 0) continue;
            summaries.push_back(summary);
            costs.push_back(calls_->costs());
        }
        measured_.pairs = summaries.back().pairs;
        measured_.entries = summaries.back().entries;
        measured_.wall_seconds = median(summaries, &Summary::seconds);
        measured_.together = gather(median(costs));
    }

    void measure_alone() {
        calls_->begin_alone();
        // The slowest rank counts, so a disturbance of one rank would affect the result: hence several turns per rank, and the least time.
        constexpr unsigned turns = 3;
        std::vector<Costs> costs;
        for (unsigned turn = 0; turn < turns * unsigned(ranks_); ++turn) {
            wait_for_all();
            const bool own = turn % unsigned(ranks_) == unsigned(rank_);
            for (unsigned round = 0; own && round <= (rounds_ + turns - 1) / turns; ++round) {
                calls_->repeat_alone();
                if (round > 0) costs.push_back(calls_->costs());
            }
        }
        measured_.alone = gather(least(costs));
    }

    /// Waits for all ranks. Unlike MPI's barrier, takes no processor time from ranks that are still computing.
    /// Throws: Error{cancelled} on all ranks if one of them is to stop.
    void wait_for_all() {
        constexpr auto nap = std::chrono::milliseconds(10);
        int stopped = stop_.stop_requested() ? 1 : 0;
        MPI_Request request = MPI_REQUEST_NULL;
        MPI_Iallreduce(MPI_IN_PLACE, &stopped, 1, MPI_INT, MPI_MAX, comm_, &request);
        for (int done = 0; MPI_Test(&request, &done, MPI_STATUS_IGNORE), done == 0;) std::this_thread::sleep_for(nap);
        if (stopped != 0) throw Error(ErrorCode::cancelled, "cancelled");
    }

    std::vector<Costs> gather(const Costs& mine) {
        std::vector<Costs> all(std::size_t(ranks_), Costs{});
        MPI_Gather(&mine, int(sizeof mine), MPI_BYTE, all.data(), int(sizeof mine), MPI_BYTE, 0, comm_);
        return all;
    }

    MPI_Comm comm_;
    unsigned rounds_;
    std::stop_token stop_;
    int rank_ = 0, ranks_ = 1;
    std::vector<Box3f> own_;
    std::unique_ptr<Calls> calls_;
    Measured measured_;
};

}  // namespace

Measured measure_on_ranks(MPI_Comm comm, const Setup& setup, unsigned rounds, const std::stop_token& stop) {
    return Measuring(comm, setup, rounds, stop).run();
}

}  // namespace octopair::cluster
