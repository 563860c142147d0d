// Scene: objects that persist and move, and its queries.
#include "scenes.hpp"

#include <algorithm>
#include <cstring>
#include <string>
#include <variant>

#include "bindings.hpp"

namespace octopair::python {

namespace {

/// Returns the offsets of answers: those of query i are at offsets[i] to offsets[i + 1].
py::array_t<std::int64_t> offsets_of(const std::vector<std::size_t>& ends) {
    py::array_t<std::int64_t> offsets(py::ssize_t(ends.size() + 1));
    std::int64_t* const out = offsets.mutable_data();
    out[0] = 0;
    std::copy(ends.begin(), ends.end(), out + 1);
    return offsets;
}

/// Returns (indices, numbers, offsets) of answers that are an index and a number.
template <typename Answer>
py::tuple columns_of(const Answers<Answer>& answers, double Answer::*number) {
    py::array_t<std::uint32_t> indices(py::ssize_t(answers.all.size()));
    py::array_t<double> numbers(py::ssize_t(answers.all.size()));
    for (std::size_t i = 0; i < answers.all.size(); ++i) {
        indices.mutable_data()[i] = answers.all[i].index;
        numbers.mutable_data()[i] = answers.all[i].*number;
    }
    return py::make_tuple(indices, numbers, offsets_of(answers.ends));
}

class LocalScene : public PythonScene<Scene> {
public:
    using PythonScene::PythonScene;

    py::array enlarged_pairs() {
        return list([&] { return &scene().enlarged_pairs(); });
    }
    void verify() {
        run_until_stopped([&](const std::stop_token& stop) { (void)scene().verify(stop); });
    }
    /// Queries: boxes (n, 6), spheres (n, 4: centre and radius), rays (n, 7: origin, direction, longest), all float64.
    py::tuple overlaps(const py::array& queries, std::uint32_t groups) {
        const auto find = [&](auto rows) {
            return answers_of<std::uint32_t>(rows.size(), [&](const std::stop_token& stop, auto& answers) {
                scene().overlaps(rows, answers, groups, stop);
            });
        };
        Answers<std::uint32_t> answers =
            queries.shape(1) == 4 ? find(rows_of<Sphere, double>(queries)) : find(rows_of<Box3d, double>(queries));
        const py::array offsets = offsets_of(answers.ends);
        return py::make_tuple(array_of<std::uint32_t>(std::move(answers.all)), offsets);
    }
    py::tuple hits(const py::array& rays, bool all, std::uint32_t groups) {
        const auto rows = rows_of<Ray, double>(rays);
        const auto find = [&](const std::stop_token& stop, Answers<RayHit>& answers) {
            return all ? scene().all_hits(rows, answers, groups, stop)
                       : scene().first_hits(rows, answers, groups, stop);
        };
        return columns_of(answers_of<RayHit>(rows.size(), find), &RayHit::along);
    }
    py::tuple nearest(const py::array& places, const py::tuple& limits, std::uint32_t groups) {
        const auto rows = rows_of<Box3d, double>(places);
        const NearestLimits most{limits[0].cast<std::size_t>(), limits[1].cast<double>()};
        const auto find = [&](const std::stop_token& stop, Answers<Neighbor>& answers) {
            scene().nearest(rows, most, answers, groups, stop);
        };
        return columns_of(answers_of<Neighbor>(rows.size(), find), &Neighbor::distance);
    }

    /// Returns (boxes, exists): a copy of the boxes by index, and whether there is an object at each index.
    py::tuple boxes() {
        return get([&] {
            const auto count = py::ssize_t(scene().indices());
            py::array_t<bool> exists(count);
            for (std::uint32_t index = 0; index < count; ++index) exists.mutable_data()[index] = scene().exists(index);
            const py::array boxes = std::visit([](auto all) { return copied(all); }, scene().boxes());
            return py::make_tuple(boxes, exists);
        });
    }
    py::tuple octants() {
        Octants found;
        run_until_stopped([&](const std::stop_token& stop) { found = scene().octants(stop); });
        return octants_tuple(found);
    }

private:
    template <typename Real>
    static py::array copied(std::span<const Box<Real>> boxes) {
        py::array_t<Real> array({py::ssize_t(boxes.size()), py::ssize_t(6)});
        if (!boxes.empty()) std::memcpy(array.mutable_data(), boxes.data(), boxes.size_bytes());
        return array;
    }

    /// Calls find(stop, answers), which makes a number of queries, and returns the answers.
    template <typename Answer, typename Find>
    Answers<Answer> answers_of(std::size_t queries, Find find) {
        Answers<Answer> answers;
        run_until_stopped([&](const std::stop_token& stop) { find(stop, answers); }, queries);
        return answers;
    }
};

/// `options` is a dict of the members of SceneOptions.
std::unique_ptr<LocalScene> make_scene(const py::dict& options) {
    check_not_forked();
    SceneOptions scene;
    scene.threads = options["threads"].cast<unsigned>();
    scene.precision = options["float64"].cast<bool>() ? Precision::float64 : Precision::float32;
    scene.margin = options["margin"].cast<double>();
    scene.recording = options["recording"].cast<std::string>();
    scene.slack = options["slack"].cast<double>();
    const Unlocked unlocked;
    return std::make_unique<LocalScene>(Scene(scene));
}

}  // namespace

void bind_scenes(py::module_& module) {
    py::class_<PythonScene<Scene>>(module, "SceneBase");  // what other modules use
    py::class_<LocalScene, PythonScene<Scene>> scene(module, "Scene");
    scene.def(py::init(&make_scene), py::arg("options"))
        .def("enlarged_pairs", &LocalScene::enlarged_pairs)
        .def("verify", &LocalScene::verify)
        .def("boxes", &LocalScene::boxes)
        .def("octants", &LocalScene::octants)
        .def("overlaps", &LocalScene::overlaps, py::arg("queries"), py::arg("groups"))
        .def("hits", &LocalScene::hits, py::arg("rays"), py::arg("all"), py::arg("groups"))
        .def("nearest", &LocalScene::nearest, py::arg("places"), py::arg("limits"), py::arg("groups"));
    bind_scene_calls(scene);
}

}  // namespace octopair::python
