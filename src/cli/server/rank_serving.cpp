// octopair serve --engine mpi: serves clients on rank 0 with an engine of all ranks.
#include "cli/server/serving.hpp"

#include <mpi.h>
#include <unistd.h>

#include <csignal>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <stop_token>
#include <string>
#include <utility>

#include "base/error_codes.hpp"
#include "cli/command/interrupt.hpp"
#include "cli/command/program_main.hpp"
#include "cli/ranks/cluster.hpp"
#include "engine/mpi/leading/leading.hpp"
#include "octopair/version.hpp"

namespace octopair::cli {

namespace {

LeadingOptions leading_options_of(const ServeRequest& request) {
    LeadingOptions options;
    options.threads = describe_engine(request.engine).threads;
    if (request.rank_silence) options.silence = *request.rank_silence;
    return options;
}

class FirstRank {
public:
    FirstRank(const ServeRequest& request, unsigned ranks)
        : log_(make_log(request)), options_(server_options_of(request)), ranks_(ranks) {
        fit_descriptors(options_.limits, *log_);
        fit_memory(options_.limits, *log_);
        LeadingOptions leading = leading_options_of(request);
        leading.on_silent_rank = [this](const std::string& what) { lose(what); };
        engine_ = make_leading_engine(MPI_COMM_WORLD, leading);
        options_.engine = [this](unsigned) { return std::move(engine_); };
        // Small jobs and scenes run on threads of this process, without the other ranks.
        options_.small_engine = [](unsigned threads) { return make_local_engine(threads); };
        options_.engine_widths.instant = std::min(options_.engine_widths.large, threads_for_instant_jobs());
        options_.on_drain = [this] { end_.request_stop(); };
    }

    /// Runs the server until it stops. Throws: Error if the server cannot start.
    void serve(const std::stop_token& stop) {
        serve_until_end(stop);
        if (lost_) Cluster::abort(exit_status(ErrorCode::engine_failed));
    }

private:
    void serve_until_end(const std::stop_token& stop) {
        const std::stop_callback asked(stop, [this] { end_.request_stop(); });
        service::Server server(options_, log_);
        // The log has the process id, because only this process of all ranks handles signals.
        log_start(*log_, server, options_, {{"ranks", std::uint64_t(ranks_)}, {"pid", std::uint64_t(getpid())}});
        wait_for_stop(end_.get_token());
        if (!lost_) drain(*log_, server);
        if (lost_) abandon(server);
    }

    void lose(const std::string& what) {
        service::log_text(*log_, service::LogLevel::error, what + ": the program ends");
        lost_ = true;
        end_.request_stop();
    }

    /// Ends the program after the loss of a rank. Drains the server first, so that the client of the running job gets the
    /// error; waiting clients retry with the next server. Aborts, because the destructor of the engine would wait for all
    /// ranks.
    [[noreturn]] static void abandon(service::Server& server) {
        constexpr std::chrono::seconds drain_timeout(2);
        server.drain(drain_timeout);
        Cluster::abort(exit_status(ErrorCode::engine_failed));
    }

    const std::shared_ptr<spdlog::logger> log_;
    service::ServerOptions options_;
    unsigned ranks_;
    std::atomic<bool> lost_ = false;
    std::stop_source end_;
    std::unique_ptr<Engine> engine_;  // null after the server has taken the engine
};

}  // namespace

int serve_on_ranks(const ServeRequest& request) {
    std::signal(SIGHUP, SIG_IGN);  // the end of a terminal does not end the server
    const Interrupt interrupt;
    Cluster cluster;
    const std::string silence = std::to_string(leading_options_of(request).silence.count()) + " ms";
    try {
        cluster.require_same(
            {{"the program", "octopair " OCTOPAIR_VERSION}, {"the subcommand", "serve"}, {"--rank-timeout", silence}});
    } catch (const Error& error) {
        if (!cluster.ends_alike()) throw;
        return cluster.fail_together(error);
    }
    cluster.joint(check_leading_threads);
    if (!cluster.first()) {
        follow(MPI_COMM_WORLD, leading_options_of(request));
        return 0;
    }
    FirstRank first(request, cluster.ranks());
    try {
        first.serve(interrupt.token());
    } catch (const Error& error) {
        return fail(error);
    }
    return 0;
}

}  // namespace octopair::cli
