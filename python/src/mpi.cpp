// octopair._mpi: engines of MPI ranks. A module of its own, because it links the system's MPI.
#include <optional>

#include "arrays.hpp"
#include "bindings.hpp"
#include "call.hpp"
#include "engines.hpp"
#include "octopair/mpi.hpp"

namespace octopair::python {

namespace {

/// `communicator` is the address of an MPI_Comm.
std::shared_ptr<PythonEngine> mpi_engine(std::uintptr_t communicator, unsigned threads) {
    const MPI_Comm comm = *reinterpret_cast<MPI_Comm*>(communicator);
    return wrap([&] { return make_mpi_engine(comm, {.threads = threads}); });
}

/// Finds pairs, gathers them on rank 0, and returns (pairs of rank 0, summary).
py::tuple gather_pairs_of(PythonEngine& engine, const ArrayInput& input, const Options& options) {
    const Turn::Holder turn(engine.turn());
    Summary summary;
    {
        // On this thread: MPI may not allow calls from another one.
        check_not_forked();
        const Unlocked unlocked;
        summary = engine.engine().find_pairs(input.input(), engine.list(), options);
        gather_pairs(engine.engine(), engine.list());
    }
    return py::make_tuple(pairs_array(engine.list()), summary_tuple(summary));
}

/// Returns (pairs of this rank, summary).
py::tuple find_pairs_here(PythonEngine& engine, const ArrayInput& input, const Options& options) {
    const Turn::Holder turn(engine.turn());
    Summary summary;
    {
        check_not_forked();
        const Unlocked unlocked;
        summary = engine.engine().find_pairs(input.input(), engine.list(), options);
    }
    return py::make_tuple(pairs_array(engine.list()), summary_tuple(summary));
}

/// `indices` is uint64 of shape (n) or None for each set. Returns (pairs of uint64, summary).
py::tuple find_pairs64_here(PythonEngine& engine, const ArrayInput& input, const py::tuple& indices,
                            const Options& options) {
    const Turn::Holder turn(engine.turn());
    std::vector<Pair64> pairs;
    const Input& sets = input.input();
    const IndexedObjects first{sets.first, optional_rows_of<std::uint64_t>(indices[0])};
    std::optional<IndexedObjects> second;
    if (sets.second) second = IndexedObjects{*sets.second, optional_rows_of<std::uint64_t>(indices[1])};
    Summary summary;
    {
        check_not_forked();
        const Unlocked unlocked;
        summary = find_pairs64(engine.engine(), IndexedInput(first, second), pairs, options);
    }
    return py::make_tuple(array_of<std::uint64_t>(std::move(pairs), {2}), summary_tuple(summary));
}

py::dict costs_of(PythonEngine& engine) {
    const RankCosts costs = last_costs(engine.engine());
    py::dict row;
    row["join"] = costs.join;
    row["plan"] = costs.plan;
    row["route"] = costs.route;
    row["pack"] = costs.pack;
    row["build"] = costs.build;
    row["scan"] = costs.scan;
    row["order"] = costs.order;
    row["mpi"] = costs.mpi;
    row["bytes_sent"] = costs.bytes_sent;
    row["messages_sent"] = costs.messages_sent;
    row["objects"] = costs.objects;
    row["shared_objects"] = costs.shared_objects;
    row["objects_received"] = costs.objects_received;
    row["octants"] = costs.octants;
    return row;
}

}  // namespace

}  // namespace octopair::python

PYBIND11_MODULE(_mpi, module) {
    using namespace octopair::python;
    // This module has Engine, Options and Input. It must also notice a fork.
    py::module_::import("octopair._core").attr("mark_used")();
    register_errors();
    watch_end_of_interpreter();
    module.def("make_engine", &mpi_engine, py::arg("communicator"), py::arg("threads"));
    module.def("find_pairs", &find_pairs_here, py::arg("engine"), py::arg("input"), py::arg("options"));
    module.def("gather_pairs", &gather_pairs_of, py::arg("engine"), py::arg("input"), py::arg("options"));
    module.def("find_pairs64", &find_pairs64_here, py::arg("engine"), py::arg("input"), py::arg("indices"),
               py::arg("options"));
    module.def("last_costs", &costs_of, py::arg("engine"));
}
