#include "program/on_ranks.hpp"

#include "cli/command/program_main.hpp"
#include "io/files/atomic_file.hpp"
#include "octopair/error.hpp"

namespace octopair::bench {

int run_on_ranks(const std::string& path, const std::function<MakeText(cli::Cluster&)>& measure) {
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
        if (ranks.first()) (void)cli::fail(error);
        ranks.together([] {});
        return exit_status(error.code());
    }
}

}  // namespace octopair::bench
