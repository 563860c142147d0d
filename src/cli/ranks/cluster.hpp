// Cluster: this process as one rank of an MPI program, from MPI_Init to MPI_Finalize.
//
// What may fail on one rank runs in together(), so that all ranks end alike; one that fails alone all the same ends the
// whole program, so that no other waits for it.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "engine/mpi/comm/agreement.hpp"
#include "engine/mpi/comm/communicator.hpp"
#include "octopair/objects.hpp"

namespace octopair::cli {

class Cluster {
public:
    Cluster() = default;
    Cluster(const Cluster&) = delete;
    Cluster& operator=(const Cluster&) = delete;
    ~Cluster() = default;

    Communicator& comm() { return comm_; }
    unsigned rank() const { return comm_.rank(); }
    unsigned ranks() const { return comm_.size(); }
    bool first() const { return rank() == 0; }
    /// Ends all ranks at once, whatever they do; mpirun ends with this status.
    [[noreturn]] static void abort(int status);

    /// Whether what was thrown last was thrown on all ranks.
    bool ends_alike() const { return run_.ends_alike; }

    /// Collective. Throws on all ranks, the same Error, if `part` throws on any.
    void together(const std::function<void()>& part);
    /// Collective: for a part that ends alike on all ranks by itself, as an engine's calls do.
    void joint(const std::function<void()>& part);
    /// Collective: the text of the first rank, on all.
    std::string told_by_first(const std::string& text);
    /// Collective: `take` gets all ranks' pairs on the first rank, in order, some at a time. What it throws is thrown on
    /// all.
    void relay(const PairList& piece, const std::function<void(std::span<const Pair>)>& take);

private:
    /// MPI's own begin and end.
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
