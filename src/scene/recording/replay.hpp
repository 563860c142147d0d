// Replay: repeats the calls of a recording on a new scene.
#pragma once

#include <cstdint>
#include <functional>
#include <stop_token>
#include <vector>

#include "scene/recording/recording_reader.hpp"

namespace octopair {

struct ReplayOptions {
    unsigned threads = 0;  ///< as in SceneOptions
    bool check = false;    ///< compare every step's result with the recorded one
    /// Called after each step; may be empty.
    std::function<void(const StepResult&)> on_step = {};
    /// Called after each step with the scene, which must not be changed; may be empty.
    std::function<void(Scene&, const StepResult&)> on_scene_step = {};
};

struct ReplayReport {
    std::uint64_t calls = 0;  ///< number of calls, except steps
    std::uint64_t steps = 0;
    std::uint64_t full_steps = 0;          ///< number of steps that searched all objects
    std::uint64_t began = 0, ended = 0;    ///< numbers of pairs, summed over all steps
    std::uint64_t objects = 0, pairs = 0;  ///< numbers after the last call
    std::vector<double> seconds;           ///< time of each step
    bool cut = false;                      ///< the recording ends within a record
    bool unfinished = false;               ///< the recording ends within a step; the replay has run this step
};

/// Makes a recorded call on a scene, except steps and results, which change no object. `ids`: memory for the ids of an
/// addition, kept from call to call.
/// Throws: what the scene throws.
void change_scene(Scene& scene, const RecordedCall& call, std::vector<ObjectId>& ids);

/// Runs the calls of a recording, and returns statistics. Failed calls are not in a recording. A failed step has a record
/// without a result: it is skipped, unless it is the last record, because then the recorded process may have died in it.
///
/// Throws: Error{bad_input} for an invalid recording, or for a call that the scene refuses; with `check`,
/// Error{engine_failed} that names the first step with another result than recorded; Error{cancelled} within 200 ms of a
/// stop request.
ReplayReport replay(RecordingReader& reader, const ReplayOptions& options, const std::stop_token& stop = {});

}  // namespace octopair
