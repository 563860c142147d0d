// octopair._core: everything but servers and MPI, which are modules of their own. The package octopair wraps it.
#include "bindings.hpp"
#include "call.hpp"
#include "octopair/octal_code.hpp"
#include "octopair/version.hpp"

namespace octopair::python {

namespace {

void bind_octal_code(py::module_& module) {
    py::class_<OctalCode>(
        module, "OctalCode",
        "An octant: the path of digits 0 to 7 from the root of an octree.\n\nMade from digits, from a text such as "
        "'{3,1,4}', or from an integer such as 314; the last two have digits 1 to 8, as in the paper.")
        .def(py::init([](const py::object& form) {
                 if (py::isinstance<py::str>(form)) return OctalCode::from_text(form.cast<std::string>());
                 if (py::isinstance<py::int_>(form)) return OctalCode::from_integer(form.cast<std::uint64_t>());
                 return OctalCode::from_digits(form.cast<std::vector<std::uint8_t>>());
             }),
             py::arg("form") = py::tuple())
        .def_property_readonly("level", &OctalCode::level, "Number of digits.")
        .def_property_readonly("key", &OctalCode::key, "The digits as one number, left-aligned in 63 bits.")
        .def_property_readonly("parent", &OctalCode::parent, "The octant one level above.")
        .def_property_readonly(
            "digits",
            [](OctalCode code) {
                py::tuple digits(code.level());
                for (unsigned i = 0; i < code.level(); ++i) digits[i] = code.digit(i);
                return digits;
            },
            "The digits 0 to 7, root first.")
        .def("contains", &OctalCode::contains, py::arg("other"), "Returns True if `other` is this octant or below it.")
        .def("integer", &OctalCode::integer, py::arg("depth") = 0,
             "Returns the integer form, padded with zeros to `depth` digits.")
        .def("__str__", &OctalCode::text)
        .def("__repr__", [](OctalCode code) { return "OctalCode('" + code.text() + "')"; })
        .def(
            "__eq__", [](OctalCode a, OctalCode b) { return a == b; }, py::is_operator())
        .def(
            "__lt__", [](OctalCode a, OctalCode b) { return a < b; }, py::is_operator())
        .def(
            "__le__", [](OctalCode a, OctalCode b) { return a <= b; }, py::is_operator())
        .def("__hash__", [](OctalCode code) { return code.key() ^ code.level(); })
        .def("__reduce__", [](const py::object& code) {
            return py::make_tuple(py::type::of(code), py::make_tuple(code.attr("digits")));
        });
}

}  // namespace

}  // namespace octopair::python

PYBIND11_MODULE(_core, module) {
    using namespace octopair::python;
    register_errors();
    watch_end_of_interpreter();
    module.attr("__version__") = OCTOPAIR_VERSION;
    module.def("mark_used", &check_not_forked);
    bind_engines(module);
    bind_jobs(module);
    bind_scenes(module);
    bind_shapes(module);
    bind_spheres(module);
    bind_pipeline(module);
    bind_octal_code(module);
    bind_octants(module);
}
