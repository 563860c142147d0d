// CGAL's box_self_intersection_d and box_intersection_d beside those of the adapter, on one thread.
//
//     octopair_adapter_cgal [--quick]
//
// Boxes of random size at random places; about one pair for each box. A difference in the number of pairs ends the program with status 1.
#include <CGAL/Box_intersection_d/Box_d.h>
#include <CGAL/box_intersection_d.h>

#include <array>
#include <cmath>
#include <cstring>
#include <random>

#include "adapters/side_by_side.hpp"
#include "octopair/cgal/box_intersection_d.hpp"

namespace {

template <class Box>
std::vector<Box> random_boxes(std::size_t count, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> place(0, 1.3 * std::cbrt(double(count))), size(0.5, 1);
    std::vector<Box> boxes;
    for (std::size_t i = 0; i < count; ++i) {
        std::array<double, 3> lower{}, upper{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            lower[axis] = place(random);
            upper[axis] = lower[axis] + size(random);
        }
        boxes.emplace_back(lower.data(), upper.data());
    }
    return boxes;
}

/// `cutoff`: the fastest of CGAL's for so many boxes.
bool compare(std::size_t count, std::ptrdiff_t cutoff, unsigned rounds) {
    using HostBox = CGAL::Box_intersection_d::Box_d<double, 3>;
    using Box = octopair::cgal::Box_intersection_d::Box_d<double, 3>;
    auto host = random_boxes<HostBox>(count, 1), host_others = random_boxes<HostBox>(count, 2);
    const auto ours = random_boxes<Box>(count, 1), our_others = random_boxes<Box>(count, 2);
    const std::string name = std::to_string(count);
    std::size_t expected = 0, found = 0;
    octopair::bench::print_side_by_side(
        "box_self_intersection_d, " + name, rounds,
        [&] {
            expected = 0;
            CGAL::box_self_intersection_d(host.begin(), host.end(),
                                          [&](const HostBox&, const HostBox&) { ++expected; });
        },
        [&] {
            found = 0;
            octopair::cgal::box_self_intersection_d(ours.begin(), ours.end(), [&](const Box&, const Box&) { ++found; });
        });
    if (found != expected) return false;
    octopair::bench::print_side_by_side(
        "the same, cutoff " + std::to_string(cutoff), rounds,
        [&] {
            CGAL::box_self_intersection_d(
                host.begin(), host.end(), [&](const HostBox&, const HostBox&) { ++expected; }, cutoff);
        },
        [&] {
            octopair::cgal::box_self_intersection_d(
                ours.begin(), ours.end(), [&](const Box&, const Box&) { ++found; }, cutoff);
        });
    octopair::bench::print_side_by_side(
        "box_intersection_d, 2 times " + name, rounds,
        [&] {
            expected = 0;
            CGAL::box_intersection_d(host.begin(), host.end(), host_others.begin(), host_others.end(),
                                     [&](const HostBox&, const HostBox&) { ++expected; });
        },
        [&] {
            found = 0;
            octopair::cgal::box_intersection_d(ours.begin(), ours.end(), our_others.begin(), our_others.end(),
                                               [&](const Box&, const Box&) { ++found; });
        });
    return found == expected;
}

}  // namespace

int main(int count, char** arguments) {
    const bool quick = count > 1 && std::strcmp(arguments[1], "--quick") == 0;
    std::printf("%-44s %13s %13s\n", "boxes", "CGAL", "octopair");
    const bool same = quick ? compare(5000, 100, 1) : compare(100'000, 1000, 5) && compare(1'000'000, 10'000, 5);
    if (!same) std::printf("the numbers of pairs differ\n");
    return same ? 0 : 1;
}
