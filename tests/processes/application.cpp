// Test application that ends without destroying its engine. Makes an engine, prints the ids of the workers, and acts on
// its first argument. `exit`: exits. `busy`: makes calls until a signal kills it. `fork`: starts a child that keeps the
// sockets open, and waits for a signal. Otherwise: waits for a signal.
#include <signal.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <string>

#include "processes/asked.hpp"
#include "processes/leftovers.hpp"

namespace octopair::test {
namespace {

void print_workers() {
    for (const pid_t worker : children_of(::getpid())) std::printf("%d\n", int(worker));
    std::printf("done\n");
    (void)std::fflush(stdout);
}

[[noreturn]] void live(const std::string& how) {
    const Scene scene("clustered", how == "busy" ? 200'000 : 10, 1);
    // The engine is never destroyed, so workers must detect the end of the application.
    Engine* const engine = make_process_engine(3).release();
    (void)ask(*engine, scene, {});
    print_workers();
    if (how == "exit") std::exit(0);
    if (how == "fork" && ::fork() == 0) {
        // The child keeps the sockets open for longer than the application lives. The child must close the output that
        // tests read.
        (void)::close(1);
        (void)::close(2);
        (void)::sleep(20);
        ::_exit(0);
    }
    for (;;) {
        if (how == "busy") {
            (void)ask(*engine, scene, {});
        } else {
            (void)::pause();
        }
    }
}

}  // namespace
}  // namespace octopair::test

int main(int count, char** arguments) { octopair::test::live(count > 1 ? arguments[1] : ""); }
