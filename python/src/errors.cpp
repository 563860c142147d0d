// Errors of the library as exceptions of Python.
#include "call.hpp"

#include <exception>
#include <new>
#include <optional>
#include <system_error>

#include "octopair/error.hpp"

namespace octopair::python {

namespace py = pybind11;

namespace {

/// Sets the current exception of Python. `octopair._errors.make` chooses the class by the code.
void raise(ErrorCode code, const char* message, const std::optional<ErrorPlace>& place = {}) {
    const py::object index = place ? py::object(py::int_(place->index)) : py::none();
    const py::object set = place ? py::object(py::int_(place->set)) : py::none();
    const py::object error = py::module_::import("octopair._errors").attr("make")(int(code), message, index, set);
    PyErr_SetObject(reinterpret_cast<PyObject*>(Py_TYPE(error.ptr())), error.ptr());
}

}  // namespace

void register_errors() {
    py::register_local_exception_translator([](std::exception_ptr thrown) {
        try {
            if (thrown) std::rethrow_exception(thrown);
        } catch (const Error& error) {
            raise(error.code(), error.what(), error.place());
        } catch (const std::bad_alloc&) {
            raise(ErrorCode::resource_limit, "out of memory");
        } catch (const std::system_error& error) {
            raise(ErrorCode::resource_limit, error.what());  // no thread can be started
        } catch (const py::cast_error&) {
            const py::object error =
                py::module_::import("octopair._errors").attr("InputTypeError")("an argument has the wrong type");
            PyErr_SetObject(reinterpret_cast<PyObject*>(Py_TYPE(error.ptr())), error.ptr());
        }
    });
}

}  // namespace octopair::python
