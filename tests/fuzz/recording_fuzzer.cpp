// Feeds any bytes to the reader of recordings, and what it accepts to a scene. Random bytes have no right checksums: so the
// same bytes are tried as they are, and with their checksums put right, which leads on to the payloads.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>

#include "octopair/error.hpp"
#include "scene/replay.hpp"

namespace {

using namespace octopair;

void require(bool holds) {
    if (!holds) std::abort();
}

RecordingSource source_of(const std::string& bytes) {
    const auto read = [&bytes](std::uint64_t offset, std::span<std::byte> out) {
        require(offset <= bytes.size() && out.size() <= bytes.size() - offset);
        if (!out.empty()) std::memcpy(out.data(), bytes.data() + offset, out.size());
    };
    return {"f.rec", bytes.size(), read};
}

void try_replay(const std::string& bytes) {
    try {
        RecordingReader reader(source_of(bytes));
        const ReplayReport report = replay(reader, {1, true});
        require(report.steps == report.seconds.size() && report.full_steps <= report.steps);
        require(report.pairs == report.began - report.ended);
        require(!report.cut || report.calls + report.steps < bytes.size() / record_overhead);
    } catch (const Error& error) {
        require(error.code() == ErrorCode::bad_input || error.code() == ErrorCode::engine_failed);
        require(std::string_view(error.what()).starts_with("f.rec: "));
        require(std::string_view(error.what()).find('\n') == std::string_view::npos);
    }
}

template <typename Head>
Head head_at(const std::string& bytes, std::size_t at) {
    Head head;
    std::memcpy(&head, bytes.data() + at, sizeof head);
    return head;
}

/// With all checks and checksums as they should be.
std::string put_right(std::string bytes) {
    if (bytes.size() < sizeof(RecordingHead)) return bytes;
    auto first = head_at<RecordingHead>(bytes, 0);
    first.magic = RecordingHead::right_magic;
    first.checksum = first.right_checksum();
    std::memcpy(bytes.data(), &first, sizeof first);
    for (std::size_t at = sizeof first; bytes.size() - at >= record_overhead;) {
        auto head = head_at<RecordHead>(bytes, at);
        head.check = head.right_check();
        std::memcpy(bytes.data() + at, &head, sizeof head);
        if (head.length > bytes.size() - at - record_overhead) break;
        const std::size_t covered = sizeof head + std::size_t(head.length);
        Checksum sum;
        sum.add(std::as_bytes(std::span(bytes)).subspan(at, covered));
        const std::uint64_t checksum = sum.value();
        std::memcpy(bytes.data() + at + covered, &checksum, sizeof checksum);
        at += covered + sizeof checksum;
    }
    return bytes;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    const std::string file(reinterpret_cast<const char*>(bytes), size);
    try_replay(file);
    try_replay(put_right(file));
    return 0;
}
