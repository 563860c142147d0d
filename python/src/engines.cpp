// Engine, Options and Input, and the calls that need no engine.
#include "engines.hpp"

#include "arrays.hpp"
#include "bindings.hpp"
#include "octopair/processes.hpp"

namespace octopair::python {

namespace {

std::shared_ptr<PythonEngine> local_engine(unsigned threads) {
    return wrap([&] { return make_local_engine(threads); }, false);
}

std::shared_ptr<PythonEngine> process_engine(unsigned workers, const std::string& worker_program) {
    return wrap([&] { return make_process_engine(ProcessOptions{workers, worker_program}); });
}

/// Returns (pairs, summary).
py::tuple find_pairs(PythonEngine& engine, const ArrayInput& input, const Options& options,
                     const py::object& progress) {
    const Turn::Holder turn(engine.turn());
    Summary summary;
    call({engine.size_of(input.size()), progress}, [&](const std::stop_token& stop, ProgressValue& value) {
        summary =
            engine.engine().find_pairs(input.input(), engine.list(), with_progress(options, progress, value), stop);
    });
    return py::make_tuple(pairs_array(engine.list()), summary_tuple(summary));
}

/// Returns the summary of a call that only counts.
py::tuple count_pairs(PythonEngine& engine, const ArrayInput& input, const Options& options,
                      const py::object& progress) {
    const Turn::Holder turn(engine.turn());
    Summary summary;
    call({engine.size_of(input.size()), progress}, [&](const std::stop_token& stop, ProgressValue& value) {
        summary = engine.engine().stream_pairs(input.input(), {}, with_progress(options, progress, value), stop);
    });
    return summary_tuple(summary);
}

template <typename Element>
py::array own_boxes(BoxArray<Element>&& boxes) {
    using Real = std::remove_extent_t<decltype(Element::min)>;
    const std::vector<py::ssize_t> shape = {py::ssize_t(boxes.size()), 6};
    auto* const owned = new BoxArray<Element>(std::move(boxes));
    const py::capsule owner(owned, [](void* memory) { delete static_cast<BoxArray<Element>*>(memory); });
    return py::array_t<Real>(shape, reinterpret_cast<Real*>(owned->boxes().data()), owner);
}

py::array allocate_boxes(PythonEngine& engine, std::uint64_t count, bool float64) {
    check_not_forked();
    if (float64) return own_boxes(engine.engine().allocate_boxes<Box3d>(count));
    return own_boxes(engine.engine().allocate_boxes<Box3f>(count));
}

/// Returns (ended, stopped, counts by the step of the share).
py::tuple faults_of(PythonEngine& engine) {
    const WorkerFaults faults = worker_faults(engine.engine());
    return py::make_tuple(faults.ended, faults.stopped, py::tuple(py::cast(faults.in_share)));
}

}  // namespace

void bind_engines(py::module_& module) {
    py::class_<Options>(module, "Options")
        .def(py::init<>())
        .def_property(
            "octal", [](const Options& options) { return options.order == Order::octal; },
            [](Options& options, bool octal) { options.order = octal ? Order::octal : Order::ascending; })
        .def_readwrite("margin", &Options::margin)
        .def_readwrite("limit", &Options::limit)
        .def_readwrite("buffer_bytes", &Options::buffer_bytes)
        .def_readwrite("verify", &Options::verify);
    py::class_<ArrayInput>(module, "Input")
        .def(py::init<py::array, py::object, py::object, py::object>(), py::arg("boxes"),
             py::arg("padding") = py::none(), py::arg("against") = py::none(), py::arg("against_padding") = py::none())
        .def("__len__", &ArrayInput::size);
    py::class_<PythonEngine, std::shared_ptr<PythonEngine>>(module, "Engine")
        .def_static("local", &local_engine, py::arg("threads") = 0)
        .def_static("processes", &process_engine, py::arg("workers") = 0, py::arg("worker_program") = "")
        .def("find_pairs", &find_pairs, py::arg("input"), py::arg("options"), py::arg("progress") = py::none())
        .def("count_pairs", &count_pairs, py::arg("input"), py::arg("options"), py::arg("progress") = py::none())
        .def("allocate_boxes", &allocate_boxes, py::arg("count"), py::arg("float64") = false)
        .def("worker_faults", &faults_of)
        .def("close", &PythonEngine::close);
}

}  // namespace octopair::python
