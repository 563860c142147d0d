// A program that finds the pairs of three boxes with the functions of CGAL's interface.
#include <octopair/cgal/box_intersection_d.hpp>

int main() {
    using Box = octopair::cgal::Box_intersection_d::Box_d<double, 3>;
    const double corners[4][3] = {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}};
    const std::vector<Box> boxes = {{corners[0], corners[1]}, {corners[1], corners[2]}, {corners[3], corners[3]}};
    int pairs = 0;
    octopair::cgal::box_self_intersection_d(boxes.begin(), boxes.end(), [&](const Box&, const Box&) { ++pairs; });
    return pairs == 1 ? 0 : 1;
}
