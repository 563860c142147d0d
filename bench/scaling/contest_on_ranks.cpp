// Holds a contest on the ranks: all setups take turns.
#include "scaling/contest.hpp"

#include <algorithm>
#include <chrono>
#include <exception>
#include <list>
#include <map>
#include <memory>
#include <span>
#include <thread>

#include "cluster/scene_slice.hpp"
#include "octopair/error.hpp"
#include "octopair/mpi.hpp"
#include "samples/scenes.hpp"

namespace octopair::scaling {

namespace {

int rank_of(MPI_Comm comm) {
    int rank = 0;
    MPI_Comm_rank(comm, &rank);
    return rank;
}

/// Slices of scenes that this rank provides. A slice shares the memory of an earlier slice of the same scene that has
/// the same begin and is at least as long.
class Slices {
public:
    explicit Slices(std::string scene) : scene_(std::move(scene)) {}

    /// Returns objects [begin, end) of a scene with `objects` objects. Valid during the lifetime of this object.
    std::span<const Box3f> slice(std::uint64_t objects, std::uint64_t begin, std::uint64_t end) {
        const auto length = std::size_t(end - begin);
        auto found = std::ranges::find_if(made_, [&](const Made& made) {
            return made.objects == objects && made.begin == begin && made.boxes.size() >= length;
        });
        if (found == made_.end())
            found = made_.insert(found, {objects, begin, cluster::make_slice({scene_, objects}, begin, end)});
        return std::span<const Box3f>(found->boxes).first(length);
    }

private:
    std::string scene_;
    struct Made {
        std::uint64_t objects, begin;
        std::vector<Box3f> boxes;
    };
    std::list<Made> made_;  // a list, because spans refer to its elements
};

/// Waits for all ranks without using a core. MPI's own waits poll continuously.
void rest(MPI_Comm comm) {
    MPI_Request request = MPI_REQUEST_NULL;
    MPI_Ibarrier(comm, &request);
    for (int done = 0; MPI_Test(&request, &done, MPI_STATUS_IGNORE), done == 0;)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

/// One setup, on ranks that take part and on ranks that do not.
class Contender {
public:
    Contender(MPI_Comm all, Entrant entrant) : entrant_(std::move(entrant)) {
        const int part = rank_of(all) < int(entrant_.setup.processes()) ? 0 : MPI_UNDEFINED;
        MPI_Comm_split(all, part, rank_of(all), &comm_);
    }
    Contender(const Contender&) = delete;
    Contender& operator=(const Contender&) = delete;
    ~Contender() {
        engine_.reset();
        if (comm_ != MPI_COMM_NULL) MPI_Comm_free(&comm_);
    }

    const Entrant& entrant() const { return entrant_; }

    void prepare(Slices& slices) {
        if (comm_ == MPI_COMM_NULL) return;
        const std::uint64_t rank = std::uint64_t(rank_of(comm_)), ranks = entrant_.setup.processes();
        own_ = slices.slice(entrant_.objects, entrant_.objects * rank / ranks, entrant_.objects * (rank + 1) / ranks);
    }
    /// Collective over the ranks that take part.
    void make_engine() {
        if (comm_ == MPI_COMM_NULL) return;
        engine_ = entrant_.setup.local() ? make_local_engine(entrant_.setup.threads)
                                         : make_mpi_engine(comm_, {.threads = entrant_.setup.threads});
    }
    /// Collective over the ranks that take part.
    void call(bool counts, const std::stop_token& stop) {
        if (comm_ == MPI_COMM_NULL) return;
        Options options;
        options.order = Order::octal;
        MPI_Barrier(comm_);
        const auto begin = std::chrono::steady_clock::now();
        entrant_.pairs = engine_->find_pairs({own_, {}}, pairs_, options, stop).pairs;
        MPI_Barrier(comm_);
        const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
        if (counts) entrant_.seconds.push_back(took.count());
    }

private:
    Entrant entrant_;
    MPI_Comm comm_ = MPI_COMM_NULL;
    std::span<const Box3f> own_;
    std::unique_ptr<Engine> engine_;
    PairList pairs_;
};

/// Runs `part` on this rank. Ranks without a part, or that end early, sleep until all ranks have ended.
void in_turn(MPI_Comm comm, const std::function<void()>& part) {
    std::exception_ptr failure;
    try {
        part();
    } catch (...) {
        failure = std::current_exception();
    }
    rest(comm);
    if (failure) std::rethrow_exception(failure);
}

void check_ranks(MPI_Comm comm, const std::vector<Setup>& setups) {
    int ranks = 0;
    MPI_Comm_size(comm, &ranks);
    for (const Setup& setup : setups) {
        if (setup.processes() <= unsigned(ranks)) continue;
        throw Error(ErrorCode::usage, setup_text(setup) + " cannot be measured on " + setup_text({unsigned(ranks)}));
    }
}

void check_pairs(const std::vector<Entrant>& entrants) {
    std::map<std::uint64_t, const Entrant*> of_objects;
    for (const Entrant& entrant : entrants) {
        const Entrant& first = *of_objects.try_emplace(entrant.objects, &entrant).first->second;
        if (entrant.pairs == first.pairs) continue;
        throw Error(ErrorCode::engine_failed, setup_text(entrant.setup) + " found " + std::to_string(entrant.pairs) +
                                                  " pairs, " + setup_text(first.setup) + ' ' +
                                                  std::to_string(first.pairs));
    }
}

}  // namespace

// NOLINTNEXTLINE(readability-function-size): the five parameters are independent of each other.
Contest hold_on_ranks(MPI_Comm comm, Contest contest, const Turns& turns, const Together& together,
                      const std::stop_token& stop) {
    together([&] { check_ranks(comm, turns.setups); });
    Slices slices(contest.scene);
    std::vector<std::unique_ptr<Contender>> contenders;
    contenders.reserve(turns.setups.size());
    for (const Setup& setup : turns.setups) {
        contenders.push_back(
            std::make_unique<Contender>(comm, Entrant{setup, contest.objects_of(setup), 0, std::vector<double>()}));
    }
    together([&] {
        for (const auto& contender : contenders) contender->prepare(slices);
    });
    for (const auto& contender : contenders) {
        together([&] { in_turn(comm, [&] { contender->make_engine(); }); });
    }
    for (unsigned round = 0; round <= turns.rounds; ++round) {
        for (const auto& contender : contenders) {
            together([&] { in_turn(comm, [&] { contender->call(round > 0, stop); }); });
        }
    }
    for (const auto& contender : contenders) contest.entrants.push_back(contender->entrant());
    together([&] {
        if (rank_of(comm) == 0) check_pairs(contest.entrants);
    });
    return contest;
}

}  // namespace octopair::scaling
