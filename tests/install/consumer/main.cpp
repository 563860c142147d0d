// A program that uses an installed octopair: three boxes, two of which touch.
#include <octopair/octopair.hpp>

#include <vector>

int main() {
    const std::vector<octopair::Box3f> boxes = {{{0, 0, 0}, {1, 1, 1}}, {{5, 5, 5}, {6, 6, 6}}, {{1, 0, 0}, {2, 1, 1}}};
    const std::vector<octopair::Pair> expected = {{0, 2}};
    const bool short_form = octopair::find_pairs(boxes) == expected;

    octopair::PairList pairs;
    octopair::make_local_engine(2)->find_pairs({boxes}, pairs);
    return short_form && pairs.to_vector() == expected ? 0 : 1;
}
