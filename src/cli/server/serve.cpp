// octopair serve: runs a server that finds pairs for clients.
#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <memory>
#include <stop_token>

#include "cli/command/interrupt.hpp"
#include "cli/server/serving.hpp"
#include "cli/subcommands.hpp"

namespace octopair::cli {

namespace {

/// Makes malloc keep the freed memory of an upload for the next upload. The system would have to clear new memory, which takes as long
/// as all other work of the server on the uploaded bytes.
void keep_freed_memory() {
    mallopt(M_MMAP_THRESHOLD, 2 << 20);
    mallopt(M_TRIM_THRESHOLD, 64 << 20);
}

std::uint64_t resident_bytes() {
    std::uint64_t mapped = 0, resident = 0;
    std::ifstream("/proc/self/statm") >> mapped >> resident;
    return resident * std::uint64_t(::sysconf(_SC_PAGESIZE));
}

/// Gives memory that ended jobs have freed back to the system.
class FreedMemory {
public:
    /// Does nothing if the memory that no job uses has hardly grown since the last time.
    void give_back(const service::Server& server) {
        constexpr std::uint64_t much = std::uint64_t(64) << 20;
        if (unused_bytes(server) < kept_ + much) return;
        (void)malloc_trim(0);
        kept_ = unused_bytes(server);
    }

private:
    /// Estimates the memory that no job uses: resident memory minus twice the reserved memory, because jobs may use more than they reserve.
    static std::uint64_t unused_bytes(const service::Server& server) {
        const std::uint64_t resident = resident_bytes(), used = 2 * server.load().memory_bytes;
        return resident - std::min(resident, used);
    }

    std::uint64_t kept_ = resident_bytes();
};

int run_serve(const ServeRequest& request) {
    keep_freed_memory();
#ifdef OCTOPAIR_WITH_MPI
    if (request.engine.has_ranks()) return serve_on_ranks(request);
#endif
    block_hang_up();
    const Interrupt interrupt;
    std::stop_source end;
    const std::stop_callback asked(interrupt.token(), [&] { end.request_stop(); });
    const auto log = make_log(request);
    service::ServerOptions options = server_options_of(request);
    options.on_drain = [&] { end.request_stop(); };
    fit_descriptors(options.limits, *log);
    fit_memory(options.limits, *log);
    service::Server server(options, log);
    log_start(*log, server, options);
    const Reloader reloader(server, *log);
    const Supervisor supervisor(server);
    FreedMemory freed;
    wait_for_stop(end.get_token(), [&] { freed.give_back(server); });
    Supervisor::report_stopping();
    drain(*log, server);
    return 0;
}

}  // namespace

void add_serve(Command& program, Action& action) {
    Command command = program.add_subcommand("serve", "run a server that finds pairs for clients");
    const auto request = std::make_shared<ServeRequest>();
    add_serve_options(command, *request);
    command.set_examples({"octopair serve --listen unix:octopair/socket --state jobs"});
    command.callback([command, request, &action] {
        complete_serve_request(command, *request);
        action = [request] { return run_serve(*request); };
    });
}

}  // namespace octopair::cli
