#include "cluster/mpirun.hpp"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <thread>

#include "base/stop.hpp"
#include "octopair/error.hpp"

namespace octopair::cluster {

namespace {

/// Sets variables of Open MPI that other MPIs ignore. Keeps variables that the caller has set.
void allow_many_ranks() {
    constexpr int keep = 0;
    ::setenv("OMPI_MCA_rmaps_base_oversubscribe", "1", keep);
    ::setenv("OMPI_MCA_mpi_yield_when_idle", "1", keep);
    ::setenv("OMPI_MCA_hwloc_base_binding_policy", "none", keep);
    ::setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", keep);
    ::setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", keep);
}

/// Starts the command. The child receives signals that this process has blocked.
pid_t start(std::vector<char*>& words) {
    posix_spawnattr_t attributes;
    ::posix_spawnattr_init(&attributes);
    sigset_t none;
    sigemptyset(&none);
    ::posix_spawnattr_setsigmask(&attributes, &none);
    ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
    pid_t process = 0;
    const int error = ::posix_spawnp(&process, words[0], nullptr, &attributes, words.data(), environ);
    ::posix_spawnattr_destroy(&attributes);
    if (error != 0) {
        throw Error(ErrorCode::engine_failed, std::string("cannot run ") + words[0] + ": " + std::strerror(error));
    }
    return process;
}

}  // namespace

void run_under_mpirun(const MpirunCommand& command, const std::stop_token& stop) {
    allow_many_ranks();
    std::vector<std::string> texts;
    std::istringstream words(command.mpirun);
    for (std::string word; words >> word;) texts.push_back(word);
    texts.insert(texts.end(), {"-n", std::to_string(command.ranks)});
    texts.insert(texts.end(), command.command.begin(), command.command.end());
    std::vector<char*> arguments;
    arguments.reserve(texts.size() + 1);
    for (std::string& text : texts) arguments.push_back(text.data());
    arguments.push_back(nullptr);
    const pid_t process = start(arguments);
    int status = 0;
    bool told = false;
    for (pid_t ended = 0; ended == 0; ended = ::waitpid(process, &status, WNOHANG)) {
        if (stop.stop_requested() && !told) ::kill(process, SIGTERM);
        told = stop.stop_requested();
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    throw_if_stopped(stop);
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
        throw Error(ErrorCode::engine_failed,
                    command.mpirun + " -n " + std::to_string(command.ranks) + " failed; its messages are above");
    }
}

}  // namespace octopair::cluster
