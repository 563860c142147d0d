// octopair-worker: the program of worker processes. Only the process engine starts it.
#include <fcntl.h>
#include <unistd.h>

#include <charconv>
#include <cstdio>
#include <cstring>
#include <exception>

#include "engine/processes/worker/worker.hpp"

int main(int count, char** arguments) {
    unsigned slot = 0;
    const char* const text = count == 2 ? arguments[1] : "";
    const auto [end, error] = std::from_chars(text, text + std::strlen(text), slot);
    if (count != 2 || error != std::errc() || *end != 0 || ::fcntl(octopair::worker_socket, F_GETFD) < 0) {
        std::fputs("octopair-worker is started by programs that use octopair's process engine\n", stderr);
        return 2;
    }
    try {
        octopair::run_worker(octopair::Descriptor(octopair::worker_socket), slot, nullptr, [] { ::_exit(0); });
    } catch (const std::exception& failure) {
        std::fprintf(stderr, "octopair-worker: %s\n", failure.what());
        return 1;
    }
}
