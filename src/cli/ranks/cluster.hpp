// Cluster: this process as one rank of an MPI program, from MPI_Init to MPI_Finalize.
//
// Invariants
//   Code that may fail on one rank runs in together(), so that all ranks end with the same error.
//   A rank that fails outside of together() and joint() ends the whole program, because the other ranks would wait for it.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "cli/ranks/group.hpp"
#include "engine/mpi/comm/agreement.hpp"
#include "engine/mpi/comm/communicator.hpp"
#include "octopair/objects.hpp"

namespace octopair::cli {

/// A fact that all ranks of a command must have in common, such as an option or an input file. Ranks that differ would find pairs
/// that belong to no scene, or deadlock.
struct Fact {
    std::string what;        ///< for messages, such as "--margin"; unique on a rank
    std::string value;       ///< to be the same on all ranks
    std::string where = {};  ///< shown behind the value, such as the path of a file; may differ
};
using Facts = std::vector<Fact>;

class Cluster final : public Group {
public:
    unsigned rank() const override { return comm_.rank(); }
    unsigned ranks() const override { return comm_.size(); }
    /// Ends all ranks at once; mpirun ends with this status.
    [[noreturn]] static void abort(int status);

    /// Returns whether the last error was thrown on all ranks.
    bool ends_alike() const { return run_.ends_alike; }

    /// Collective. Prints, on the first rank, an error that all ranks have thrown. Returns the exit status.
    int fail_together(const Error& error);

    void together(const std::function<void()>& part) override;
    [[noreturn]] void refuse_object(std::uint64_t position, const std::string& message) override;
    /// Collective. Runs `part`. Requires: if `part` throws, it throws the same error on all ranks, like a call of an MPI engine.
    void joint(const std::function<void()>& part);

    /// Collective. Throws: Error{usage}, the same on all ranks, unless all ranks pass the same facts.
    void require_same(const Facts& own);

    /// Collective. Returns the text of the first rank.
    std::string broadcast_text(const std::string& text);
    /// Collective. Returns one value of each rank, by rank.
    template <typename Value>
    std::vector<Value> all_gather(const Value& own) {
        return comm_.all_gather(own);
    }
    /// Collective. Returns the values of all ranks, by rank.
    template <typename Value>
    std::vector<Value> all_gather(std::span<const Value> own) {
        return comm_.all_gather(own).values;
    }
    /// Collective. Copies `own` of rank `from` to `received` of the first rank, which has room for as many values.
    template <typename Value>
    void send_to_first(unsigned from, std::span<const Value> own, std::span<Value> received) {
        Exchange counts{RankCounts(ranks(), 0), RankCounts(ranks(), 0)};
        if (rank() == from) counts.sent[0] = own.size();
        if (first()) counts.received[from] = received.size();
        comm_.exchange(own.data(), received.data(), counts);
    }
    /// Collective. On the first rank, `take` gets the pairs of all ranks, in the order of the ranks, at most a million at a
    /// time.
    /// Throws: what `take` throws, on all ranks.
    void relay(const PairList& piece, const std::function<void(std::span<const Pair>)>& take);

private:
    /// Calls MPI_Init and MPI_Finalize.
    struct Run {
        Run();
        Run(const Run&) = delete;
        Run& operator=(const Run&) = delete;
        ~Run();
        bool ends_alike = false;
    };

    Run run_;
    Communicator comm_{MPI_COMM_WORLD};
};

}  // namespace octopair::cli
