// Finds the collisions of a bicycle's parts with a program that was written for CGAL's box_self_intersection_d. Only the include and
// the namespace have changed: #include <CGAL/box_intersection_d.h>, namespace CGAL.
#include <octopair/cgal/box_intersection_d.hpp>

#include <iostream>
#include <string>
#include <vector>

namespace boxes = octopair::cgal::Box_intersection_d;

struct Part {
    std::string name;
    double lower[3], upper[3];  // metres
};

// A box that refers to its part.
using Box = boxes::Box_with_handle_d<double, 3, const Part*>;

int main() {
    const std::vector<Part> parts = {{"frame", {0.2, -0.05, 0.2}, {1.1, 0.05, 0.9}},
                                     {"rear wheel", {-0.1, -0.02, 0}, {0.6, 0.02, 0.7}},
                                     {"front wheel", {0.9, -0.02, 0}, {1.6, 0.02, 0.7}},
                                     {"bell", {1, 0.2, 1}, {1.05, 0.25, 1.05}}};
    std::vector<Box> all;
    for (const Part& part : parts) all.emplace_back(part.lower, part.upper, &part);
    octopair::cgal::box_self_intersection_d(all.begin(), all.end(), [](const Box& a, const Box& b) {
        std::cout << a.handle()->name << " and " << b.handle()->name << "\n";
    });
}
