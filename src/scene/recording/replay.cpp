#include "scene/recording/replay.hpp"

#include <cstddef>
#include <string>
#include <utility>

#include "base/stop.hpp"
#include "octopair/error.hpp"

namespace octopair {

namespace {

std::string counts_text(const RecordedResult& result) {
    return std::to_string(result.began) + " began, " + std::to_string(result.ended) + " ended, " +
           std::to_string(result.persisting) + " persisting";
}

/// Returns the message for two results that differ.
std::string difference_text(const RecordedResult& now, const RecordedResult& then) {
    const bool counts = now.began != then.began || now.ended != then.ended || now.persisting != then.persisting;
    if (!counts) return "the pairs differ from the recorded ones, their numbers do not: " + counts_text(now);
    return counts_text(now) + "; recorded: " + counts_text(then);
}

Scene scene_of(const RecordingReader& reader, unsigned threads) {
    SceneOptions options = reader.options();
    options.threads = threads;
    try {
        return Scene(options);
    } catch (const Error& error) {
        if (error.code() != ErrorCode::bad_input) throw;
        reader.refuse(offsetof(RecordingHead, margin), error.what());
    }
}

class Replay {
public:
    Replay(RecordingReader& reader, const ReplayOptions& options)
        : reader_(reader), options_(options), scene_(scene_of(reader, options.threads)) {}

    ReplayReport run(const std::stop_token& stop);

private:
    void make(const RecordedCall& call);
    void step(const RecordedResult* then, const std::stop_token& stop);

    RecordingReader& reader_;
    const ReplayOptions& options_;
    Scene scene_;
    std::vector<ObjectId> ids_;  // receives the ids of added objects, which are equal to those that recorded calls use
    ReplayReport report_;
};

ReplayReport Replay::run(const std::stop_token& stop) {
    RecordedCall call;
    bool stepping = false;  // the last record began a step whose result has not been read
    while (reader_.next(call)) {
        throw_if_stopped(stop);
        if (call.kind == RecordKind::result) {
            if (!stepping) reader_.refuse(call.offset, "a result without a step before it");
            step(&call.result, stop);
        } else if (call.kind != RecordKind::step) {
            make(call);
        }
        stepping = call.kind == RecordKind::step;
    }
    report_.cut = reader_.cut();
    report_.unfinished = stepping;
    if (stepping) step(nullptr, stop);
    report_.objects = scene_.size();
    return std::move(report_);
}

void Replay::make(const RecordedCall& call) {
    ++report_.calls;
    try {
        change_scene(scene_, call, ids_);
    } catch (const Error& error) {
        if (error.code() != ErrorCode::bad_input) throw;
        reader_.refuse(call.offset, error.what());
    }
}

void Replay::step(const RecordedResult* then, const std::stop_token& stop) {
    const StepResult& result = scene_.step(stop);
    ++report_.steps;
    report_.full_steps += result.full ? 1 : 0;
    report_.began += result.began.size();
    report_.ended += result.ended.size();
    report_.pairs = result.pairs();
    report_.seconds.push_back(result.seconds);
    if (options_.check && then != nullptr) {
        const RecordedResult now = recorded_result(result);
        if (now != *then) {
            throw Error(ErrorCode::engine_failed, reader_.name() + ": step " + std::to_string(report_.steps) + ": " +
                                                      difference_text(now, *then));
        }
    }
    if (options_.on_step) options_.on_step(result);
    if (options_.on_scene_step) options_.on_scene_step(scene_, result);
}

}  // namespace

void change_scene(Scene& scene, const RecordedCall& call, std::vector<ObjectId>& ids) {
    switch (call.kind) {
        case RecordKind::add:
            ids.resize(std::size_t(call.objects.size()));
            scene.add(call.objects, ids, call.traits);
            return;
        case RecordKind::move:
            return scene.move(call.ids, call.objects.boxes);
        case RecordKind::sweep:
            return scene.sweep(call.ids, call.objects.boxes);
        case RecordKind::remove:
            return scene.remove(call.ids);
        case RecordKind::set_traits:
            return scene.set_traits(call.ids, call.traits);
        case RecordKind::step:
        case RecordKind::result:
            return;
    }
}

ReplayReport replay(RecordingReader& reader, const ReplayOptions& options, const std::stop_token& stop) {
    return Replay(reader, options).run(stop);
}

}  // namespace octopair
