// Fuzzes the reader of recordings, and applies accepted calls to a scene. Random bytes have no valid checksums. The
// fuzzer tries the bytes unchanged and with corrected checksums, so that payloads are reached.
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "fuzz/require.hpp"
#include "fuzz/right_checksums.hpp"
#include "scene/recording/replay.hpp"

namespace {

using namespace octopair;
using fuzz::require;

RecordingSource source_of(const std::string& bytes) {
    const auto read = [&bytes](std::uint64_t offset, std::span<std::byte> out) {
        require(offset <= bytes.size() && out.size() <= bytes.size() - offset);
        if (!out.empty()) std::memcpy(out.data(), bytes.data() + offset, out.size());
    };
    return {"f.rec", bytes.size(), read};
}

void try_replay(const std::string& bytes) {
    fuzz::require_clear_errors({.begin = "f.rec: ", .codes = {ErrorCode::bad_input, ErrorCode::engine_failed}}, [&] {
        RecordingReader reader(source_of(bytes));
        const ReplayReport report = replay(reader, {1, true});
        require(report.steps == report.seconds.size() && report.full_steps <= report.steps);
        require(report.pairs == report.began - report.ended);
        require(!report.cut || report.calls + report.steps < bytes.size() / record_overhead);
    });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    const std::string file(reinterpret_cast<const char*>(bytes), size);
    try_replay(file);
    try_replay(fuzz::put_right(file));
    return 0;
}
