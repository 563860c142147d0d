// The MPI engine: the steps of the algorithm on ranks that each have a part of the objects.

#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "engine/job_queue.hpp"
#include "engine/mpi/communicator.hpp"
#include "engine/mpi/rank_search.hpp"
#include "octopair/error.hpp"
#include "octopair/mpi.hpp"

namespace octopair {

namespace {

/// What would be another search on another rank must be the same. Collective.
const MpiOptions& alike(Communicator& comm, const MpiOptions& options) {
    struct Told {
        Arrangement arrangement;
        unsigned ranks_per_machine;
    };
    const bool paper = options.arrangement == Arrangement::paper;
    const std::vector<Told> all = comm.all_gather(Told{options.arrangement, paper ? options.ranks_per_machine : 1});
    for (const Told& told : all) {
        if (told.ranks_per_machine == 0) throw Error(ErrorCode::usage, "machines of no ranks");
        if (told.arrangement != all[0].arrangement || told.ranks_per_machine != all[0].ranks_per_machine) {
            throw Error(ErrorCode::usage, "the arrangements of the ranks' engines differ");
        }
    }
    return options;
}

class MpiEngine final : public Engine {
public:
    MpiEngine(MPI_Comm comm, const MpiOptions& options) : comm_(comm), search_(comm_, alike(comm_, options)) {}

    void gather(PairList& pairs) {
        jobs_.wait_for_all();
        const std::lock_guard lock(calls_);
        PairList all;
        search_.gather(pairs, all.storage());
        pairs = std::move(all);
    }

    const RankCosts& costs() const { return search_.costs(); }
    void use(MessageTape* tape) { comm_.set_tape(tape); }

private:
    /// Jobs that were submitted before come first, on all ranks.
    Summary run(const Request& request, const Output& output, const Control& control) override {
        jobs_.wait_for_all();
        const std::lock_guard lock(calls_);
        return search_.run(request, output, control);
    }
    /// All ranks must hear of it: run() does that.
    void check(const Request&) const override {}
    JobQueue& jobs() override {
        if (!comm_.any_thread()) {
            throw Error(ErrorCode::usage, "jobs of an MPI engine need MPI_Init_thread with MPI_THREAD_MULTIPLE");
        }
        return jobs_;
    }

    Communicator comm_;
    RankSearch search_;
    std::mutex calls_;
    JobQueue jobs_{*this, [this] { search_.skip(); }};  // the last, so that it ends first
};

}  // namespace

std::unique_ptr<Engine> make_mpi_engine(MPI_Comm comm, const MpiOptions& options) {
    return std::make_unique<MpiEngine>(comm, options);
}

namespace {

template <typename AnyEngine>
AnyEngine& as_ranks(AnyEngine* ranks) {
    if (ranks == nullptr) throw Error(ErrorCode::usage, "not an MPI engine");
    return *ranks;
}

}  // namespace

void gather_pairs(Engine& engine, PairList& pairs) { as_ranks(dynamic_cast<MpiEngine*>(&engine)).gather(pairs); }

void use_tape(Engine& engine, MessageTape* tape) { as_ranks(dynamic_cast<MpiEngine*>(&engine)).use(tape); }

RankCosts last_costs(const Engine& engine) { return as_ranks(dynamic_cast<const MpiEngine*>(&engine)).costs(); }

}  // namespace octopair
