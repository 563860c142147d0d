#include "io/boxes/spheres.hpp"

#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "geometry/rounding.hpp"
#include "io/files/failure.hpp"

namespace octopair::io {

namespace {

float upper_end(float centre, float radius) { return rounding::float_above(double(centre) + double(radius)); }
double upper_end(double centre, double radius) { return rounding::sum_above(centre, radius); }

bool is_finite(const auto& sphere) {
    return std::isfinite(sphere.centre[0]) && std::isfinite(sphere.centre[1]) && std::isfinite(sphere.centre[2]) &&
           std::isfinite(sphere.radius);
}

bool is_finite_box(const auto& box) {
    for (int axis = 0; axis < 3; ++axis) {
        if (!std::isfinite(box.min[axis]) || !std::isfinite(box.max[axis])) return false;
    }
    return true;
}

template <typename Real>
[[noreturn]] void refuse_sphere(const Sphere<Real>& sphere, std::uint64_t object, std::string_view file) {
    for (int axis = 0; axis < 3; ++axis) {
        if (std::isfinite(sphere.centre[axis])) continue;
        refuse(file, fmt::format("object {}: centre {} is {}, not a finite number", object, "xyz"[axis],
                                 number_text(sphere.centre[axis])));
    }
    if (sphere.radius >= 0 && std::isfinite(sphere.radius)) {
        refuse(file, fmt::format("object {}: its box is outside the range of the file's number type", object));
    }
    refuse(file, fmt::format("object {}: radius is {}, not a finite number >= 0", object, number_text(sphere.radius)));
}

}  // namespace

template <typename Real>
Box<Real> box_of_sphere(const Sphere<Real>& sphere) {
    Box<Real> box;
    for (int axis = 0; axis < 3; ++axis) {
        box.min[axis] = -upper_end(-sphere.centre[axis], sphere.radius);
        box.max[axis] = upper_end(sphere.centre[axis], sphere.radius);
    }
    return box;
}

template <typename Real>
void boxes_of_spheres(std::span<const Sphere<Real>> spheres, std::span<Box<Real>> boxes, const SpherePlace& place) {
    for (std::size_t i = 0; i < spheres.size(); ++i) {
        if (i % 65536 == 0 && place.stop.stop_requested()) cancel();
        if (!is_finite(spheres[i]) || !(spheres[i].radius >= 0)) refuse_sphere(spheres[i], place.begin + i, place.file);
        boxes[i] = box_of_sphere(spheres[i]);
        if (!is_finite_box(boxes[i])) refuse_sphere(spheres[i], place.begin + i, place.file);
    }
}

template Box3f box_of_sphere(const Sphere<float>&);
template Box3d box_of_sphere(const Sphere<double>&);
template void boxes_of_spheres(std::span<const Sphere<float>>, std::span<Box3f>, const SpherePlace&);
template void boxes_of_spheres(std::span<const Sphere<double>>, std::span<Box3d>, const SpherePlace&);

}  // namespace octopair::io
