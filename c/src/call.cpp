// Errors, stops, and the conversions of call.hpp.
#include "call.hpp"

#include <new>
#include <optional>
#include <stdexcept>
#include <string>

#include "octopair/version.hpp"

namespace octopair::c {

namespace {

static_assert(sizeof(octopair_pair) == sizeof(Pair) && alignof(octopair_pair) == alignof(Pair));

// A fixed array: storing the message of a failed allocation must not allocate.
constexpr std::size_t longest_message = 1024;
thread_local char message[longest_message] = "";
thread_local std::optional<ErrorPlace> place;  // of the error with this message

octopair_status failed(ErrorCode code, const char* text, const std::optional<ErrorPlace>& where = {}) noexcept {
    std::strncpy(message, text, longest_message - 1);
    place = where;
    return octopair_status(int(code) + 1);
}

static_assert(OCTOPAIR_USAGE == int(ErrorCode::usage) + 1 && OCTOPAIR_CANCELLED == int(ErrorCode::cancelled) + 1);

}  // namespace

octopair_status status_of_exception() noexcept {
    try {
        throw;
    } catch (const Error& error) {
        return failed(error.code(), error.what(), error.place());
    } catch (const std::bad_alloc&) {
        return failed(ErrorCode::resource_limit, "out of memory");
    } catch (const std::length_error&) {
        return failed(ErrorCode::resource_limit, "more elements than memory can hold");
    } catch (const std::exception& error) {
        return failed(ErrorCode::engine_failed, error.what());
    } catch (...) {
        return failed(ErrorCode::engine_failed, "unknown error");
    }
}

Boxes boxes_of(std::int32_t precision, const void* boxes, std::uint64_t count) {
    if (count > 0) required(static_cast<const char*>(boxes), "boxes");
    if (count > 0xFFFFFFFF)
        throw Error(ErrorCode::resource_limit, std::to_string(count) + " boxes; at most 2^32 - 1 are possible");
    if (precision == OCTOPAIR_FLOAT32) return std::span(static_cast<const Box3f*>(boxes), std::size_t(count));
    if (precision == OCTOPAIR_FLOAT64) return std::span(static_cast<const Box3d*>(boxes), std::size_t(count));
    throw Error(ErrorCode::bad_input,
                "precision is " + std::to_string(precision) + ", neither OCTOPAIR_FLOAT32 nor OCTOPAIR_FLOAT64");
}

Objects objects_of(const octopair_objects* given, const char* name) {
    required(given, name);
    const octopair_objects objects = read_struct(given, octopair_objects OCTOPAIR_OBJECTS_INIT, name);
    const Boxes boxes = boxes_of(objects.precision, objects.boxes, objects.count);
    if (objects.padding == nullptr) return {boxes};
    return {boxes, std::span(objects.padding, std::size_t(objects.count))};
}

Input input_of(const octopair_objects* first, const octopair_objects* second) {
    std::optional<Objects> other;
    if (second != nullptr) other = objects_of(second, "second");
    return {objects_of(first, "first"), other};
}

CallOptions options_of(const octopair_options* given) {
    const octopair_options values = read_struct(given, octopair_options OCTOPAIR_OPTIONS_INIT, "options");
    CallOptions call;
    if (values.order != OCTOPAIR_ASCENDING && values.order != OCTOPAIR_OCTAL) {
        throw Error(ErrorCode::bad_input,
                    "order is " + std::to_string(values.order) + ", neither OCTOPAIR_ASCENDING nor OCTOPAIR_OCTAL");
    }
    call.options.order = values.order == OCTOPAIR_OCTAL ? Order::octal : Order::ascending;
    call.options.margin = values.margin;
    call.options.verify = values.verify != 0;
    call.options.buffer_bytes = values.buffer_bytes;
    if (values.limit != UINT64_MAX) call.options.limit = values.limit;
    if (values.progress != nullptr) {
        call.options.progress = [report = values.progress, data = values.progress_data](double fraction) {
            if (report(data, fraction) != 0) throw Error(ErrorCode::cancelled, "the progress function ended the call");
        };
    }
    if (values.stop != nullptr) call.stop = values.stop->source.get_token();
    return call;
}

PairSink sink_of(octopair_sink sink, void* data) {
    if (sink == nullptr) throw Error(ErrorCode::bad_input, "sink is NULL");
    return [sink, data](std::span<const Pair> pairs) {
        if (sink(data, reinterpret_cast<const octopair_pair*>(pairs.data()), pairs.size()) != 0) {
            throw Error(ErrorCode::cancelled, "the sink ended the call");
        }
    };
}

octopair_summary summary_of(const Summary& summary) {
    return {sizeof(octopair_summary),  summary.pairs,
            summary.entries,           summary.seconds,
            summary.truncated ? 1 : 0, summary.verification.done ? 1 : 0};
}

}  // namespace octopair::c

const char* octopair_error_message(void) { return octopair::c::message; }

int octopair_error_place(uint64_t* index, uint32_t* set) {
    const auto& place = octopair::c::place;
    if (!place) return 0;
    if (index != nullptr) *index = place->index;
    if (set != nullptr) *set = place->set;
    return 1;
}

const char* octopair_version(void) { return OCTOPAIR_VERSION; }

octopair_status octopair_stop_create(octopair_stop** stop) {
    return octopair::c::guarded([&] {
        octopair_stop*& out = octopair::c::required(stop, "stop");
        out = new octopair_stop();
    });
}
void octopair_stop_request(octopair_stop* stop) {
    if (stop != nullptr) stop->source.request_stop();
}
void octopair_stop_destroy(octopair_stop* stop) { delete stop; }
