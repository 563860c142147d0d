// Boxes of spheres.
#include "octopair/spheres.hpp"

#include <stop_token>
#include <string>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "call.hpp"
#include "octopair/error.hpp"

namespace octopair::python {

namespace {

template <typename Real>
py::array boxes_of_spheres(const py::array& array) {
    const auto spheres = rows_of<SphereRow<Real>, Real>(array);
    std::vector<Box<Real>> boxes(spheres.size());
    call({spheres.size()}, [&](const std::stop_token& stop, auto&&...) { octopair::boxes_of(spheres, boxes, stop); });
    return array_of<Real>(std::move(boxes), {6});
}

/// Returns boxes (n, 6) of spheres (n, 4), of the same dtype. `set`: number of the set that errors name, 0 or 1.
py::array sphere_boxes(const py::array& spheres, unsigned set) {
    try {
        return py::isinstance<py::array_t<float>>(spheres) ? boxes_of_spheres<float>(spheres)
                                                           : boxes_of_spheres<double>(spheres);
    } catch (const PlacedError& error) {
        if (set == 0) throw;
        throw PlacedError(error.code(), std::string("second set: ") + error.what(),
                          {.index = error.where().index, .set = set});
    }
}

}  // namespace

void bind_spheres(py::module_& module) {
    module.def("sphere_boxes", &sphere_boxes, py::arg("spheres"), py::arg("set"));
}

}  // namespace octopair::python
