// Minimal use: three boxes, two of which touch.
#include <octopair/octopair.hpp>

#include <cstdio>
#include <vector>

int main() {
    const std::vector<octopair::Box3f> boxes = {
        {{0, 0, 0}, {1, 1, 1}},  // 0
        {{5, 5, 5}, {6, 6, 6}},  // 1
        {{1, 0, 0}, {2, 1, 1}},  // 2: touches 0
    };
    for (const auto [a, b] : octopair::find_pairs(boxes)) std::printf("%u and %u\n", a, b);  // 0 and 2
}
