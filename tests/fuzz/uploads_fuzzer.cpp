// Fuzzes the server's reader of scene calls, with any bytes in any pieces, and applies accepted calls to a scene. The
// fuzzer tries the bytes unchanged and with corrected checksums. Each time the calls must equal those of a recording
// with the tried bytes.
#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "fuzz/require.hpp"
#include "fuzz/right_checksums.hpp"
#include "octopair/error.hpp"
#include "service/server/scenes/uploaded_calls.hpp"

namespace {

using namespace octopair;
using fuzz::require;

void make(Scene& scene, const RecordedCall& call) {
    std::vector<ObjectId> ids(std::size_t(call.objects.size()));
    switch (call.kind) {
        case RecordKind::add:
            return scene.add(call.objects, ids, call.traits);
        case RecordKind::move:
            return scene.move(call.ids, call.objects.boxes);
        case RecordKind::sweep:
            return scene.sweep(call.ids, call.objects.boxes);
        case RecordKind::remove:
            return scene.remove(call.ids);
        case RecordKind::set_traits:
            return scene.set_traits(call.ids, call.traits);
        case RecordKind::step:
            (void)scene.step();
            return;
        case RecordKind::result:
            return;
    }
}

/// The kinds of the calls, and the reason for the end of the calls.
struct Outcome {
    std::vector<RecordKind> kinds;
    std::string refusal;

    bool operator==(const Outcome&) const = default;
};

Outcome of_recording(const std::string& bytes) {
    Outcome outcome;
    try {
        if (bytes.size() < sizeof(RecordingHead)) return outcome;
        RecordingReader reader({"scene", bytes.size(), [&](std::uint64_t offset, std::span<std::byte> out) {
                                    if (!out.empty()) std::memcpy(out.data(), bytes.data() + offset, out.size());
                                }});
        for (RecordedCall call; reader.next(call);) outcome.kinds.push_back(call.kind);
    } catch (const Error& error) {
        outcome.refusal = error.what();
    }
    return outcome;
}

Outcome of_upload(const std::string& bytes, std::size_t piece) {
    Outcome outcome;
    service::UploadedCalls calls;
    std::optional<Scene> scene;
    try {
        for (std::size_t at = 0; at < bytes.size(); at += piece) {
            calls.append(std::as_bytes(std::span(bytes)).subspan(at, std::min(piece, bytes.size() - at)));
            for (RecordedCall call; calls.next(call);) {
                outcome.kinds.push_back(call.kind);
                try {
                    SceneOptions options = calls.options();
                    options.threads = 1;
                    if (!scene) scene.emplace(options);
                    make(*scene, call);
                } catch (const Error& error) {
                    require(error.code() == ErrorCode::bad_input);
                }
            }
        }
    } catch (const Error& error) {
        require(error.code() == ErrorCode::bad_input);
        require(std::string_view(error.what()).starts_with("scene: byte "));
        outcome.refusal = error.what();
    }
    return outcome;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    if (size == 0) return 0;
    const std::string calls(reinterpret_cast<const char*>(bytes) + 1, size - 1);
    for (const std::string& one : {calls, fuzz::put_right(calls)}) {
        require(of_upload(one, 1 + std::size_t(bytes[0])) == of_recording(one));
    }
    return 0;
}
