// octopair._view: View, a running scene in a browser. A module of its own, because only builds with the viewer have it.
#include "octopair/view.hpp"

#include <string>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "call.hpp"
#include "octopair/error.hpp"
#include "scenes.hpp"

namespace octopair::python {

namespace {

/// `settings` is a dict of members of ViewOptions.
ViewOptions options_of(const py::dict& settings) {
    ViewOptions options;
    const auto set = [&](const char* name, auto& member) {
        if (settings.contains(name)) member = settings[name].cast<std::decay_t<decltype(member)>>();
    };
    set("title", options.title);
    set("names", options.names);
    set("up", options.up);
    set("unit", options.unit);
    set("margin", options.margin);
    set("host", options.host);
    set("port", options.port);
    set("token", options.token);
    set("frames_per_second", options.frames_per_second);
    return options;
}

/// A view and its scene, which Python keeps alive.
class PythonView {
public:
    PythonView(PythonScene<Scene>& scene, const py::dict& settings) : scene_(scene) {
        const ViewOptions options = options_of(settings);
        scene_.use([&](Scene& shown) { view_.reset(new View(shown, options)); });
    }

    std::string address() const { return view().address(); }
    unsigned pages() const { return view_ == nullptr ? 0 : view_->pages(); }

    /// Shows the scene after a step: the pairs that began and ended, how many persist, and the seconds.
    void show(const std::pair<py::array, py::array>& events, std::uint64_t persisting, double seconds, bool at_once) {
        StepResult step;
        step.began = rows_of<Pair, std::uint32_t>(events.first);
        step.ended = rows_of<Pair, std::uint32_t>(events.second);
        step.persisting = persisting;
        step.seconds = seconds;
        View& shown = view();
        scene_.use([&](Scene&) { shown.show(step, at_once); });
    }
    void close() { view_.reset(); }

private:
    View& view() const {
        if (view_ == nullptr) throw Error(ErrorCode::usage, "the view is closed");
        return *view_;
    }

    PythonScene<Scene>& scene_;
    std::unique_ptr<View, ReleasedDelete> view_;
};

}  // namespace

}  // namespace octopair::python

PYBIND11_MODULE(_view, module) {
    using namespace octopair::python;
    // This module has the type of scenes. It must also notice a fork.
    py::module_::import("octopair._core").attr("mark_used")();
    register_errors();
    watch_end_of_interpreter();
    py::class_<PythonView>(module, "View")
        .def(py::init<PythonScene<octopair::Scene>&, const py::dict&>(), py::arg("scene"), py::arg("settings"),
             py::keep_alive<1, 2>())
        .def("address", &PythonView::address)
        .def("pages", &PythonView::pages)
        .def("show", &PythonView::show, py::arg("events"), py::arg("persisting"), py::arg("seconds"),
             py::arg("at_once"))
        .def("close", &PythonView::close);
}
