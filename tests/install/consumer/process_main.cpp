// A program that links a library. The library uses octopair's worker processes.
#include <cstddef>
#include <cstdio>
#include <exception>

std::size_t pairs_among(unsigned objects);

int main() {
    try {
        return pairs_among(50'000) == 49'999 ? 0 : 1;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 2;
    }
}
