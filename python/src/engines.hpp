// Engines as Python objects. The modules for MPI and servers make engines of their own kinds with wrap().
#pragma once

#include <memory>

#include "call.hpp"
#include "octopair/engine.hpp"

namespace octopair::python {

/// An engine, and a list that keeps its memory from call to call. Python threads take turns.
class PythonEngine {
public:
    explicit PythonEngine(std::unique_ptr<Engine> engine) : engine_(engine.release()) {}

    Engine& engine() { return *engine_; }
    PairList& list() { return list_; }
    Turn& turn() { return turn_; }

private:
    std::unique_ptr<Engine, ReleasedDelete> engine_;
    PairList list_;
    Turn turn_;
};

/// Returns an engine that `make` makes without the GIL. Throws: exceptions of `make`; Error{usage} after a fork.
template <typename Make>
std::shared_ptr<PythonEngine> wrap(Make make) {
    check_not_forked();
    const Unlocked unlocked;
    return std::make_shared<PythonEngine>(make());
}

/// Summary as a tuple for octopair/_results.py.
py::tuple summary_tuple(const Summary& summary);

/// Returns `options` with a progress function that sets `value`, if `progress` is not None.
Options with_progress(Options options, const py::object& progress, ProgressValue& value);

}  // namespace octopair::python
