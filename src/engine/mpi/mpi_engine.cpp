// The MPI engine: the steps of the algorithm on ranks that each have a part of the objects.

#include <memory>
#include <mutex>
#include <new>
#include <utility>
#include <vector>

#include "base/floating_point.hpp"
#include "engine/job_queue.hpp"
#include "engine/mpi/comm/communicator.hpp"
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
        search_.gather(pairs, detail::storage_of(all));
        pairs = std::move(all);
    }

    // NOLINTNEXTLINE(readability-function-size): what, where to, until when.
    Summary find(const detail::Request& request, const IndexedCall& indexed, const detail::Control& control) {
        jobs_.wait_for_all();
        const std::lock_guard lock(calls_);
        return search_.run(request, indexed, control);
    }

    const RankCosts& costs() const { return search_.costs(); }
    void use(MessageTape* tape) { comm_.set_tape(tape); }

private:
    /// Jobs that were submitted before come first, on all ranks.
    Summary run(const detail::Request& request, const detail::Output& output, const detail::Control& control) override {
        jobs_.wait_for_all();
        const std::lock_guard lock(calls_);
        return search_.run(request, output, control);
    }
    /// All ranks must hear of it: run() does that.
    void check(const detail::Request&) const override {}
    detail::JobQueue& jobs() override {
        if (!comm_.any_thread()) {
            throw Error(ErrorCode::usage, "jobs of an MPI engine need MPI_Init_thread with MPI_THREAD_MULTIPLE");
        }
        return jobs_;
    }

    Communicator comm_;
    RankSearch search_;
    std::mutex calls_;
    detail::JobQueue jobs_{*this, [this] { search_.skip(); }};  // the last, so that it ends first
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

namespace {

/// With no half-filled list after a failure, and running out of memory an Error like any other.
Summary find_indexed(Engine& engine, const detail::Request& request, const IndexedCall& indexed, std::stop_token stop) {
    const FloatingPointScope scope;
    MpiEngine& ranks = as_ranks(dynamic_cast<MpiEngine*>(&engine));
    indexed.pairs.clear();
    try {
        return ranks.find(request, indexed, {std::move(stop), request.options.progress});
    } catch (const std::bad_alloc&) {
        indexed.pairs.clear();
        throw Error(ErrorCode::resource_limit, "out of memory");
    } catch (...) {
        indexed.pairs.clear();
        throw;
    }
}

}  // namespace

// NOLINTNEXTLINE(readability-function-size): as Engine::find_pairs, on an engine.
Summary find_pairs64(Engine& engine, const IndexedInput& input, std::vector<Pair64>& pairs, const Options& options,
                     std::stop_token stop) {
    const Objects* const second = input.second ? &input.second->objects : nullptr;
    const auto second_indices = input.second ? input.second->indices : std::span<const std::uint64_t>();
    return find_indexed(engine, {input.first.objects, second, options}, {{input.first.indices, second_indices}, pairs},
                        std::move(stop));
}

void use_tape(Engine& engine, MessageTape* tape) { as_ranks(dynamic_cast<MpiEngine*>(&engine)).use(tape); }

RankCosts last_costs(const Engine& engine) { return as_ranks(dynamic_cast<const MpiEngine*>(&engine)).costs(); }

}  // namespace octopair
