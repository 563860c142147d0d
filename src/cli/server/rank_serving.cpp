#include "cli/server/rank_serving.hpp"

#include <mpi.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <stop_token>
#include <string>
#include <utility>

#include "base/error_codes.hpp"
#include "cli/command/failure.hpp"
#include "cli/command/interrupt.hpp"
#include "cli/ranks/cluster.hpp"
#include "cli/server/serving.hpp"
#include "engine/mpi/leading/leading.hpp"

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
        LeadingOptions leading = leading_options_of(request);
        leading.lost = [this](const std::string& what) { lose(what); };
        engine_ = make_leading_engine(MPI_COMM_WORLD, leading);
        options_.engine = [this](unsigned) { return std::move(engine_); };
        // Small jobs are served on threads of this process; so are scenes.
        options_.small_engine = [](unsigned threads) { return make_local_engine(threads); };
        options_.engine_widths.instant = options_.engine_widths.small;
    }

    /// Throws Error where there can be no server.
    void serve(const std::stop_token& stop) {
        serve_until_end(stop);
        if (lost_) Cluster::abort(exit_status(ErrorCode::engine_failed));
    }

private:
    void serve_until_end(const std::stop_token& stop) {
        const std::stop_callback asked(stop, [this] { end_.request_stop(); });
        service::Server server(options_, log_);
        // Which of the processes takes signals, nobody could see.
        tell_start(*log_, server, options_, {{"ranks", std::uint64_t(ranks_)}, {"pid", std::uint64_t(getpid())}});
        wait_for(end_.get_token());
        if (!lost_) drain(*log_, server);
        if (lost_) abandon(server);
    }

    void lose(const std::string& what) {
        service::log_text(*log_, service::LogLevel::error, what + ": the program ends");
        lost_ = true;
        end_.request_stop();
    }

    /// The client of the job that was under way is told how it ended; those that wait will ask the next server. The engine's
    /// end would wait for all ranks.
    [[noreturn]] static void abandon(service::Server& server) {
        constexpr std::chrono::seconds to_tell(2);
        server.drain(to_tell);
        Cluster::abort(exit_status(ErrorCode::engine_failed));
    }

    const std::shared_ptr<spdlog::logger> log_;
    service::ServerOptions options_;
    unsigned ranks_;
    std::atomic<bool> lost_ = false;
    std::stop_source end_;
    std::unique_ptr<Engine> engine_;  // until the server takes it
};

}  // namespace

int serve_on_ranks(const ServeRequest& request) {
    const Interrupt interrupt;
    Cluster cluster;
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
