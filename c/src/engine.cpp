// Engines, lists of pairs, and direct calls.
#include <algorithm>
#include <memory>
#include <string>
#include <string_view>

#include "call.hpp"
#include "connection.hpp"
#include "engine_handle.hpp"
#ifdef OCTOPAIR_WITH_PROCESSES
#include "octopair/processes.hpp"
#endif

namespace octopair::c {

namespace {

std::unique_ptr<Engine> make_engine(std::string_view kind, const octopair_engine_options& options) {
    if (kind.find(':') != std::string_view::npos) return connect_through_module(std::string(kind), options);
    if (kind == "local") return make_local_engine(options.threads);
#ifdef OCTOPAIR_WITH_PROCESSES
    if (kind == "processes") {
        ProcessOptions processes;
        processes.workers = options.workers;
        if (options.worker_program != nullptr) processes.worker_program = options.worker_program;
        return make_process_engine(processes);
    }
#endif
    throw Error(ErrorCode::usage,
                "no engine '" + std::string(kind) + "'; there are local, processes, unix:PATH and HOST:PORT");
}

}  // namespace

}  // namespace octopair::c

using octopair::c::guarded;
using octopair::c::required;

octopair_status octopair_engine_create(const char* kind, const octopair_engine_options* options,
                                       octopair_engine** engine) {
    return guarded([&] {
        required(kind, "kind");
        octopair_engine*& out = required(engine, "engine");
        const auto values =
            octopair::c::read_struct(options, octopair_engine_options OCTOPAIR_ENGINE_OPTIONS_INIT, "options");
        out = new octopair_engine{octopair::c::make_engine(kind, values)};
    });
}
void octopair_engine_destroy(octopair_engine* engine) { delete engine; }

octopair_status octopair_pairs_create(octopair_pairs** pairs) {
    return guarded([&] {
        octopair_pairs*& out = required(pairs, "pairs");
        out = new octopair_pairs();
    });
}
void octopair_pairs_destroy(octopair_pairs* pairs) { delete pairs; }
uint64_t octopair_pairs_count(const octopair_pairs* pairs) { return pairs == nullptr ? 0 : pairs->list.size(); }

uint64_t octopair_pairs_copy(const octopair_pairs* pairs, uint64_t first, octopair_pair* buffer, uint64_t capacity) {
    if (pairs == nullptr || buffer == nullptr) return 0;
    std::uint64_t copied = 0;
    for (const auto chunk : pairs->list.chunks()) {
        if (first >= chunk.size()) {
            first -= chunk.size();
            continue;
        }
        const std::uint64_t some = std::min<std::uint64_t>(chunk.size() - first, capacity - copied);
        std::memcpy(buffer + copied, chunk.data() + first, std::size_t(some) * sizeof(octopair_pair));
        copied += some;
        first = 0;
        if (copied == capacity) break;
    }
    return copied;
}

octopair_status octopair_find_pairs(octopair_engine* engine, const octopair_objects* first,
                                    const octopair_objects* second, const octopair_options* options,
                                    octopair_pairs* pairs, octopair_summary* summary) {
    return guarded([&] {
        octopair::PairList& list = required(pairs, "pairs").list;
        octopair::c::check_output(summary, "summary");
        try {
            const auto call = octopair::c::options_of(options);
            const auto input = octopair::c::input_of(first, second);
            const auto found = required(engine, "engine").engine->find_pairs(input, list, call.options, call.stop);
            octopair::c::write_struct(summary, octopair::c::summary_of(found));
        } catch (...) {
            list = {};  // also if the arguments are refused
            throw;
        }
    });
}

octopair_status octopair_count_pairs(octopair_engine* engine, const octopair_objects* first,
                                     const octopair_objects* second, const octopair_options* options, uint64_t* count) {
    return guarded([&] {
        const auto call = octopair::c::options_of(options);
        std::uint64_t& out = required(count, "count");
        out = required(engine, "engine")
                  .engine->count_pairs(octopair::c::input_of(first, second), call.options, call.stop);
    });
}

octopair_status octopair_stream_pairs(octopair_engine* engine, const octopair_objects* first,
                                      const octopair_objects* second, const octopair_options* options,
                                      octopair_sink sink, void* data, octopair_summary* summary) {
    return guarded([&] {
        octopair::c::check_output(summary, "summary");
        const auto call = octopair::c::options_of(options);
        const auto found = required(engine, "engine")
                               .engine->stream_pairs(octopair::c::input_of(first, second),
                                                     octopair::c::sink_of(sink, data), call.options, call.stop);
        octopair::c::write_struct(summary, octopair::c::summary_of(found));
    });
}
