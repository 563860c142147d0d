// The MPI engine: runs the steps of the algorithm on ranks that each have a part of the objects.

#include <memory>
#include <mutex>
#include <new>
#include <utility>
#include <vector>

#include "base/call_scope.hpp"
#include "base/floating_point_scope.hpp"
#include "engine/job_queue.hpp"
#include "engine/mpi/comm/communicator.hpp"
#include "engine/mpi/rank_search.hpp"
#include "octopair/error.hpp"
#include "octopair/mpi.hpp"

namespace octopair {

namespace {

class MpiEngine final : public Engine {
public:
    MpiEngine(MPI_Comm comm, const MpiOptions& options) : comm_(comm), search_(comm_, options) {}

    void gather(PairList& pairs) {
        refuse_inside_call_of(this);
        const CallScope own(this);
        jobs_.wait_for_all();
        const std::lock_guard lock(calls_);
        PairList all;
        search_.gather(pairs, detail::storage_of(all));
        pairs = std::move(all);
    }

    Summary find(const detail::Request& request, const IndexedCall& indexed, std::stop_token stop) {
        refuse_inside_call_of(this);
        const CallScope own(this);
        const ProgressSink progress = detail::callback_of(own, request.options.progress);
        jobs_.wait_for_all();
        const std::lock_guard lock(calls_);
        return search_.run(request, indexed, {std::move(stop), progress});
    }

    const RankCosts& costs() const { return search_.costs(); }
    void use(MessageTape* tape) { comm_.set_tape(tape); }

private:
    /// Runs the call after all jobs that were submitted earlier, on all ranks.
    Summary run(const detail::Request& request, const detail::Output& output, const detail::Control& control) override {
        jobs_.wait_for_all();
        const std::lock_guard lock(calls_);
        return search_.run(request, output, control);
    }
    /// Does nothing: run() checks the request, so that all ranks throw the same Error.
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
    detail::JobQueue jobs_{*this, [this] { search_.skip(); }};  // last member, so that it is destroyed first
};

}  // namespace

std::unique_ptr<Engine> make_mpi_engine(MPI_Comm comm, const MpiOptions& options) {
    return std::make_unique<MpiEngine>(comm, options);
}

namespace {

template <typename AnyEngine>
AnyEngine& as_mpi_engine(AnyEngine* ranks) {
    if (ranks == nullptr) throw Error(ErrorCode::usage, "the engine was not made by make_mpi_engine");
    return *ranks;
}

}  // namespace

void gather_pairs(Engine& engine, PairList& pairs) { as_mpi_engine(dynamic_cast<MpiEngine*>(&engine)).gather(pairs); }

namespace {

/// Runs an indexed call. Leaves `indexed.pairs` empty after a failure. Throws: also Error{resource_limit} if memory runs out.
Summary find_indexed(Engine& engine, const detail::Request& request, const IndexedCall& indexed, std::stop_token stop) {
    const FloatingPointScope scope;
    MpiEngine& ranks = as_mpi_engine(dynamic_cast<MpiEngine*>(&engine));
    indexed.pairs.clear();
    try {
        return ranks.find(request, indexed, std::move(stop));
    } catch (const std::bad_alloc&) {
        indexed.pairs.clear();
        throw Error(ErrorCode::resource_limit, "out of memory");
    } catch (...) {
        indexed.pairs.clear();
        throw;
    }
}

}  // namespace

// NOLINTNEXTLINE(readability-function-size): an engine, and the parameters of Engine::find_pairs.
Summary find_pairs64(Engine& engine, const IndexedInput& input, std::vector<Pair64>& pairs, const Options& options,
                     std::stop_token stop) {
    const Objects* const second = input.second ? &input.second->objects : nullptr;
    const auto second_indices = input.second ? input.second->indices : std::span<const std::uint64_t>();
    return find_indexed(engine, {input.first.objects, second, options}, {{input.first.indices, second_indices}, pairs},
                        std::move(stop));
}

void use_tape(Engine& engine, MessageTape* tape) { as_mpi_engine(dynamic_cast<MpiEngine*>(&engine)).use(tape); }

RankCosts last_costs(const Engine& engine) { return as_mpi_engine(dynamic_cast<const MpiEngine*>(&engine)).costs(); }

}  // namespace octopair
