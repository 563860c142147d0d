// Does not compile: the boxes have the dimension and the number type that the build sets.
#include "octopair/cgal/box_intersection_d.hpp"

int main() {
    using Box = octopair::cgal::Box_intersection_d::Box_d<NUMBER, DIMENSIONS>;
    std::vector<Box> boxes(2);
    octopair::cgal::box_self_intersection_d(boxes.begin(), boxes.end(), [](const Box&, const Box&) {});
}
