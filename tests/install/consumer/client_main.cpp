// A client of a server: detects the pairs of three boxes on the server at the given address.
#include <octopair/client.hpp>
#include <octopair/octopair.hpp>

#include <cstdio>

int main(int, char** words) {
    try {
        const std::vector<octopair::Box3f> boxes = {
            {{0, 0, 0}, {1, 1, 1}}, {{5, 5, 5}, {6, 6, 6}}, {{1, 0, 0}, {2, 1, 1}}};
        octopair::PairList pairs;
        octopair::connect(words[1])->find_pairs({boxes}, pairs);
        return pairs.to_vector() == std::vector<octopair::Pair>{{0, 2}} ? 0 : 1;
    } catch (const octopair::Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
