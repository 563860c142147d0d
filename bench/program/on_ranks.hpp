// Study on MPI ranks: octopair-bench starts a second instance under mpirun with the hidden option --on-ranks FILE.
// Rank 0 of that instance writes the results to the file.
#pragma once

#include <functional>
#include <string>

#include "cli/ranks/cluster.hpp"
#include "io/files/atomic_file.hpp"
#include "octopair/error.hpp"

namespace octopair::bench {

/// Makes the text of a file. Called only on rank 0.
using MakeText = std::function<std::string()>;

/// Collective. Runs `measure` on all ranks; rank 0 writes the text of the result to `path`. Returns the exit status.
/// Throws: errors that occur on some ranks only.
inline int run_on_ranks(const std::string& path, const std::function<MakeText(cli::Cluster&)>& measure) {
    cli::Cluster ranks;
    try {
        const MakeText make_text = measure(ranks);
        ranks.together([&] {
            if (!ranks.first()) return;
            io::AtomicFile file(path);
            file.write(make_text());
            file.commit();
        });
        return 0;
    } catch (const Error& error) {
        if (!ranks.ends_alike()) throw;
        return ranks.fail_together(error);
    }
}

}  // namespace octopair::bench
