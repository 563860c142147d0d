#include "boxes/sphere_boxes.hpp"

#include <charconv>
#include <cmath>
#include <string>
#include <type_traits>

#include "base/floating_point_scope.hpp"
#include "base/stop.hpp"
#include "geometry/rounding.hpp"
#include "octopair/error.hpp"

namespace octopair {

namespace {

float upper_end(float centre, float radius) { return rounding::float_above(double(centre) + double(radius)); }
double upper_end(double centre, double radius) { return rounding::sum_above(centre, radius); }

template <typename Real>
bool is_finite(const Real (&numbers)[3]) {
    return std::isfinite(numbers[0]) && std::isfinite(numbers[1]) && std::isfinite(numbers[2]);
}

template <typename Real>
std::string shortest_text(Real number) {
    if (std::isnan(number)) return "nan";
    char text[32];
    return {text, std::to_chars(text, text + sizeof text, number).ptr};
}

template <typename Real>
[[noreturn]] void refuse_sphere(const SphereRow<Real>& sphere, std::uint64_t object) {
    std::string fault;
    for (int axis = 2; axis >= 0; --axis) {
        if (std::isfinite(sphere.centre[axis])) continue;
        fault = std::string("centre ") + "xyz"[axis] + " is " + shortest_text(sphere.centre[axis]) +
                ", not a finite number";
    }
    if (fault.empty() && (!(sphere.radius >= 0) || !std::isfinite(sphere.radius))) {
        fault = "radius is " + shortest_text(sphere.radius) + ", not a finite number >= 0";
    }
    if (fault.empty()) {
        fault = std::string("its box is outside the range of ") + (std::is_same_v<Real, float> ? "float32" : "float64");
    }
    throw PlacedError(ErrorCode::bad_input, "object " + std::to_string(object) + ": " + fault, {.index = object});
}

}  // namespace

template <typename Real>
Box<Real> box_of_sphere(const SphereRow<Real>& sphere) {
    Box<Real> box;
    for (int axis = 0; axis < 3; ++axis) {
        box.min[axis] = -upper_end(-sphere.centre[axis], sphere.radius);
        box.max[axis] = upper_end(sphere.centre[axis], sphere.radius);
    }
    return box;
}

template <typename Real>
void write_sphere_boxes(std::span<const SphereRow<Real>> spheres, std::span<Box<Real>> boxes, std::uint64_t begin,
                        const std::stop_token& stop) {
    const FloatingPointScope scope;
    for (std::size_t i = 0; i < spheres.size(); ++i) {
        if (i % 65536 == 0) throw_if_stopped(stop);
        const SphereRow<Real>& sphere = spheres[i];
        if (!is_finite(sphere.centre) || !std::isfinite(sphere.radius) || !(sphere.radius >= 0))
            refuse_sphere(sphere, begin + i);
        boxes[i] = box_of_sphere(sphere);
        if (!is_finite(boxes[i].min) || !is_finite(boxes[i].max)) refuse_sphere(sphere, begin + i);
    }
}

void boxes_of(std::span<const SphereRow<float>> spheres, std::span<Box3f> boxes, std::stop_token stop) {
    write_sphere_boxes(spheres, boxes, 0, stop);
}

void boxes_of(std::span<const SphereRow<double>> spheres, std::span<Box3d> boxes, std::stop_token stop) {
    write_sphere_boxes(spheres, boxes, 0, stop);
}

template Box3f box_of_sphere(const SphereRow<float>&);
template Box3d box_of_sphere(const SphereRow<double>&);
template void write_sphere_boxes(std::span<const SphereRow<float>>, std::span<Box3f>, std::uint64_t,
                                 const std::stop_token&);
template void write_sphere_boxes(std::span<const SphereRow<double>>, std::span<Box3d>, std::uint64_t,
                                 const std::stop_token&);

}  // namespace octopair
