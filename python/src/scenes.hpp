// A scene as a Python object: Scene in the module octopair._core, RemoteScene in octopair._remote.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "call.hpp"
#include "octopair/error.hpp"
#include "octopair/scene.hpp"

namespace octopair::python {

static_assert(sizeof(ObjectId) == 2 * sizeof(std::uint32_t));

/// Returns the ids of a structured array (index, generation). Throws: TypeError.
inline std::span<const ObjectId> ids_of(const py::array& ids) {
    if (ids.itemsize() != sizeof(ObjectId) || (ids.flags() & py::array::c_style) == 0) {
        throw py::type_error("ids must be a contiguous array of octopair.id_dtype");
    }
    return {static_cast<const ObjectId*>(ids.data()), std::size_t(ids.size())};
}

/// Returns the traits of columns: groups and masks (uint32) and fixed (bool), each None or of the same length.
std::vector<Traits> traits_of(const py::object& groups, const py::object& masks, const py::object& fixed);

/// A scene of type `S`, Scene or RemoteScene. Python threads take turns.
template <typename S>
class PythonScene {
public:
    explicit PythonScene(S scene) : scene_(new S(std::move(scene))) {}

    /// Writes the ids of the new objects to `ids`. `traits` is (groups, masks, fixed).
    void add(const ArrayInput& objects, py::array ids, const py::tuple& traits) {
        const std::vector<Traits> rows = traits_of(traits[0], traits[1], traits[2]);
        auto* const data = static_cast<ObjectId*>(ids.mutable_data());
        const std::span<ObjectId> out(data, ids_of(ids).size());
        run([&] { scene().add(objects.input().first, out, rows); });
    }
    void move(const py::array& ids, const py::array& boxes) {
        const Boxes places = boxes_of(boxes);
        run([&] { scene().move(ids_of(ids), places); });
    }
    void sweep(const py::array& ids, const py::array& boxes) {
        const Boxes places = boxes_of(boxes);
        run([&] { scene().sweep(ids_of(ids), places); });
    }
    void remove(const py::array& ids) {
        run([&] { scene().remove(ids_of(ids)); });
    }
    void set_traits(const py::array& ids, const py::tuple& traits) {
        const std::vector<Traits> rows = traits_of(traits[0], traits[1], traits[2]);
        run([&] { scene().set_traits(ids_of(ids), rows); });
    }
    /// Ends the scene: its threads or connection, and its recording.
    void close() {
        if (is_forked()) return;
        const Turn::Holder turn(turn_);
        untaken_.reset();
        scene_.reset();
    }
    /// Returns (began, ended, persisting, full, seconds). If memory for the arrays is missing, the step has happened all the same. The next
    /// call of step() returns its result. Until then, calls that would invalidate the result throw.
    py::tuple step() {
        const Turn::Holder turn(turn_);
        if (!untaken_) {
            const StepResult* result = nullptr;
            call({scene().size()}, [&](const std::stop_token& stop, auto&&...) { result = &scene().step(stop); });
            untaken_ = *result;
        }
        py::tuple taken = py::make_tuple(pairs_array(untaken_->began), pairs_array(untaken_->ended),
                                         untaken_->persisting, untaken_->full, untaken_->seconds);
        untaken_.reset();
        return taken;
    }
    py::array pairs() {
        return list([&] { return &scene().pairs(); });
    }
    py::array persisting() {
        return list([&] { return &scene().persisting(); });
    }

    /// Calls use(scene) without the GIL, while no other thread of Python calls the scene.
    template <typename Use>
    void use(Use use_scene) {
        run([&] { use_scene(scene()); });
    }

    std::uint64_t size() {
        return get([&] { return scene().size(); });
    }
    std::uint64_t indices() {
        return get([&] { return scene().indices(); });
    }
    /// Returns a bool for each id.
    py::array_t<bool> contains(const py::array& ids) {
        const std::span<const ObjectId> all = ids_of(ids);
        py::array_t<bool> answers(py::ssize_t(all.size()));
        get([&] {
            for (std::size_t i = 0; i < all.size(); ++i) answers.mutable_data()[i] = scene().contains(all[i]);
            return 0;
        });
        return answers;
    }
    /// Returns for each index whether it has an object.
    py::array_t<bool> exist(const py::array& indices) {
        const auto all = rows_of<std::uint32_t>(indices);
        py::array_t<bool> answers(py::ssize_t(all.size()));
        get([&] {
            for (std::size_t i = 0; i < all.size(); ++i) answers.mutable_data()[i] = id_at(all[i]).has_value();
            return 0;
        });
        return answers;
    }
    /// Writes the ids of objects with these indices. Throws: Error{bad_input} with the position of an index without an object.
    void ids_at(const py::array& indices, py::array ids) {
        const auto all = rows_of<std::uint32_t>(indices);
        auto* out = static_cast<ObjectId*>(ids.mutable_data());
        get([&] {
            for (std::size_t i = 0; i < all.size(); ++i) {
                const std::optional<ObjectId> id = id_at(all[i]);
                if (!id) {
                    throw PlacedError(ErrorCode::bad_input, "no object has the index " + std::to_string(all[i]),
                                      {.index = i});
                }
                *out++ = *id;
            }
            return 0;
        });
    }

protected:
    /// Requires: the turn. Throws: Error{usage} if the scene is closed.
    S& scene() {
        if (!scene_) throw Error(ErrorCode::usage, "the scene is closed");
        return *scene_;
    }

    /// Runs a call that cannot be cancelled. Signal handlers run after it.
    template <typename Work>
    void run(Work work) {
        const Turn::Holder turn(turn_);
        check_not_forked();
        check_taken();
        const Unlocked unlocked;
        work();
    }
    /// Runs a call that can be cancelled and repeated. Signal handlers run meanwhile. `queries`: number of queries of the call.
    template <typename Work>
    void run_until_stopped(Work work, std::uint64_t queries = 0) {
        constexpr std::uint64_t objects_per_query = 64;  // whose search takes about as long as a query
        const Turn::Holder turn(turn_);
        check_taken();
        const std::uint64_t objects = std::max<std::uint64_t>(scene().size(), queries * objects_per_query);
        call({objects}, [&](const std::stop_token& stop, auto&&...) { work(stop); });
    }
    template <typename Get>
    py::array list(Get find) {
        const Turn::Holder turn(turn_);
        check_taken();
        const PairList* found = nullptr;
        call({scene().size()}, [&](auto&&...) { found = find(); });
        return pairs_array(*found);
    }
    template <typename Get>
    auto get(Get read) {
        const Turn::Holder turn(turn_);
        check_not_forked();
        return read();
    }

private:
    std::optional<ObjectId> id_at(std::uint32_t index) {
        if constexpr (requires(const S& s) { s.exists(index); }) {
            if (!scene().exists(index)) return {};
            return scene().id(index);
        }
        try {
            return scene().id(index);
        } catch (const Error& error) {
            if (error.code() != ErrorCode::bad_input) throw;
            return {};
        }
    }
    void check_taken() const {
        if (untaken_)
            throw Error(ErrorCode::usage,
                        "memory ran out before the result of the last step was returned: call step() again");
    }

    std::unique_ptr<S, ReleasedDelete> scene_;  ///< null: closed
    std::optional<StepResult> untaken_;         ///< result of the last step, until Python has it
    Turn turn_;
};

/// Adds the calls that both kinds of scenes have.
template <typename Class>
void bind_scene_calls(Class& scene) {
    using Type = typename Class::type;
    scene.def("add", &Type::add, py::arg("objects"), py::arg("ids"), py::arg("traits"))
        .def("move", &Type::move, py::arg("ids"), py::arg("boxes"))
        .def("sweep", &Type::sweep, py::arg("ids"), py::arg("boxes"))
        .def("remove", &Type::remove, py::arg("ids"))
        .def("set_traits", &Type::set_traits, py::arg("ids"), py::arg("traits"))
        .def("step", &Type::step)
        .def("pairs", &Type::pairs)
        .def("persisting", &Type::persisting)
        .def("size", &Type::size)
        .def("indices", &Type::indices)
        .def("contains", &Type::contains, py::arg("ids"))
        .def("exist", &Type::exist, py::arg("indices"))
        .def("ids_at", &Type::ids_at, py::arg("indices"), py::arg("ids"))
        .def("close", &Type::close);
}

}  // namespace octopair::python
