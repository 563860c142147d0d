// Fuzzes the server's reader of jobs. An accepted job is run, and its download must be complete and readable. The input
// is a sequence of messages, each after its length in two bytes.
#include <cstdint>
#include <string_view>

#include "fuzz/require.hpp"
#include "octopair/error.hpp"
#include "service/protocol/errors.hpp"
#include "service/protocol/job_spec.hpp"
#include "service/protocol/messages.hpp"
#include "service/protocol/octopair.pb.h"
#include "service/server/calls/job_messages.hpp"

namespace {

using namespace octopair;
using namespace octopair::service;
using fuzz::require;

struct Limits {
    Budget memory{"memory_bytes", "bytes of memory", std::uint64_t(64) << 20};
    Budget job_slots{"jobs", "job slots", 10, 10};
};

std::shared_ptr<ServerJob> begin(Limits& limits, const std::shared_ptr<Engine>& engine, v1::JobSpec spec) {
    check(spec);
    if (object_count(spec) > 500) throw LimitError("objects", 500, "a job of more than 500 objects");
    ServerJob::Parts parts;
    parts.slot = limits.job_slots.take(1, "local");
    parts.memory = limits.memory.take(input_bytes(spec));
    parts.input = std::make_unique<UploadedInput>(spec, engine);
    parts.pairs = std::make_unique<PairsInMemory>(limits.memory, 0);
    parts.spec = std::move(spec);
    return std::make_shared<ServerJob>(std::move(parts));
}

void read_back(const std::shared_ptr<ServerJob>& job) {
    std::uint64_t pairs = 0;
    for (Download download(job);;) {
        Download::Next next = download.next();
        require(next.kind != Download::Next::Kind::wait);
        const bool last = next.kind == Download::Next::Kind::last;
        if (last && !next.status.ok()) return;
        v1::Download small;
        const auto count = [&](std::span<const std::byte> piece) { pairs += piece.size() / sizeof(Pair); };
        require(unpack(next.message, small, count));
        require(small.has_summary() == last);
        if (!last) continue;
        require(job->spec().count_only() || small.summary().pairs() == pairs);
        return;
    }
}

void feed(std::string_view input, const std::shared_ptr<Engine>& engine) {
    Limits limits;
    {
        std::shared_ptr<ServerJob> job;
        Upload upload([&](v1::JobSpec spec) -> InputTarget& {
            job = begin(limits, engine, std::move(spec));
            return job->input();
        });
        while (input.size() >= 2) {
            const std::size_t length = std::size_t(std::uint8_t(input[0])) | std::size_t(std::uint8_t(input[1])) << 8;
            input.remove_prefix(2);
            const std::string_view bytes = input.substr(0, length);
            input.remove_prefix(bytes.size());
            const grpc::Slice slice(bytes.data(), bytes.size());
            grpc::ByteBuffer message(&slice, 1);
            upload.take(message);
        }
        upload.finish();
        job->queue();
        job->run(engine);
        require(job->ended());
        read_back(job);
    }
    require(limits.memory.taken() == 0 && limits.job_slots.taken() == 0);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    static const std::shared_ptr<Engine> engine = make_local_engine(1);
    fuzz::require_clear_errors({.codes = {ErrorCode::bad_input, ErrorCode::resource_limit}}, [&] {
        feed({reinterpret_cast<const char*>(bytes), size}, engine);
    });
    return 0;
}
