// Engines as Python objects. The modules for MPI and servers make engines of their own kinds with wrap().
#pragma once

#include <atomic>
#include <memory>

#include "call.hpp"
#include "octopair/engine.hpp"
#include "octopair/error.hpp"

namespace octopair::python {

/// An engine, and a list that keeps its memory from call to call. Python threads take turns.
class PythonEngine {
public:
    /// `waits`: calls may wait for other processes.
    explicit PythonEngine(std::unique_ptr<Engine> engine, bool waits = false)
        : engine_(engine.release(), ReleasedDelete()), waits_(waits) {}

    /// Returns the engine. Requires: the turn, or the GIL during the whole use. Throws: Error{usage} if the engine is closed.
    Engine& engine() {
        check_open();
        return *engine_;
    }
    /// Returns the engine for a use without the turn and the GIL. Requires: the GIL. Throws: Error{usage} if the engine is closed.
    std::shared_ptr<Engine> shared() {
        check_open();
        return engine_;
    }
    /// Waits for the call that runs, cancels all jobs, and ends the engine: its threads, processes or connection.
    void close() {
        if (is_forked()) return;
        const Turn::Holder turn(turn_);
        engine_.reset();
        list_ = PairList();
    }
    PairList& list() { return list_; }
    Turn& turn() { return turn_; }
    /// Notes that the engine has jobs, for which calls wait.
    void note_job() { waits_ = true; }
    /// Returns the size of a call for CallMode.
    std::uint64_t size_of(std::uint64_t objects) const { return waits_ ? ~std::uint64_t(0) : objects; }

private:
    void check_open() const {
        if (!engine_) throw Error(ErrorCode::usage, "the engine is closed");
    }

    std::shared_ptr<Engine> engine_;  // null: closed
    PairList list_;
    Turn turn_;
    std::atomic<bool> waits_;
};

/// Returns an engine that `make` makes without the GIL. Throws: exceptions of `make`; Error{usage} after a fork.
template <typename Make>
std::shared_ptr<PythonEngine> wrap(Make make, bool waits = true) {
    check_not_forked();
    const Unlocked unlocked;
    return std::make_shared<PythonEngine>(make(), waits);
}

/// Returns a summary as a tuple for octopair/_results.py.
py::tuple summary_tuple(const Summary& summary);

/// Returns the name of a state for Python.
const char* state_name(JobState state);

/// Returns `options` with a progress function that sets `value`, if `progress` is not None.
Options with_progress(Options options, const py::object& progress, ProgressValue& value);

}  // namespace octopair::python
