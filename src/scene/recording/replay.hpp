// Replay: makes the calls of a recording again, to a scene of its own.
#pragma once

#include <cstdint>
#include <functional>
#include <stop_token>
#include <vector>

#include "scene/recording/recording_reader.hpp"

namespace octopair {

struct ReplayOptions {
    unsigned threads = 0;  ///< as in SceneOptions
    bool check = false;    ///< hold every step's result against the recorded one
    /// Called after each step, if it is there.
    std::function<void(const StepResult&)> on_step = {};
};

struct ReplayReport {
    std::uint64_t calls = 0;  ///< beside steps
    std::uint64_t steps = 0;
    std::uint64_t full_steps = 0;  ///< in which all objects were searched
    std::uint64_t began = 0, ended = 0;
    std::uint64_t objects = 0, pairs = 0;  ///< at the end
    std::vector<double> seconds;           ///< of each step
    bool cut = false;                      ///< the recording ends within a call
    bool unfinished = false;               ///< it ends within a step, which was made here
};

/// Makes a recorded call on a scene, except steps and results, which change no object. `ids`: memory for the ids of an
/// addition, kept from call to call.
/// Throws: what the scene throws.
void change_scene(Scene& scene, const RecordedCall& call, std::vector<ObjectId>& ids);

/// Calls that failed are not in a recording; of a step that failed there is the beginning, and it is passed over, unless
/// nothing comes after it: then it may be what ended the recorded process, and is made.
///
/// Throws Error{bad_input} for what is not a recording, or has a call that the scene refuses; with `check`,
/// Error{engine_failed} with the first step that found something else than it did then; Error{cancelled} within 200 ms of
/// a stop request.
ReplayReport replay(RecordingReader& reader, const ReplayOptions& options, const std::stop_token& stop = {});

}  // namespace octopair
