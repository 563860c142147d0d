// Helpers of all functions of octopair.h: errors, structs that begin with their size, and conversions of inputs.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <optional>
#include <stop_token>
#include <utility>

#include "octopair.h"
#include "octopair/engine.hpp"
#include "octopair/error.hpp"

struct octopair_stop {
    std::stop_source source;
};

struct octopair_pairs {
    octopair::PairList list;
};

namespace octopair::c {

/// Stores the current exception's message for octopair_error_message(), and returns its status. Call it in a catch block.
octopair_status status_of_exception() noexcept;

/// Runs the body of a function of octopair.h.
template <typename Body>
octopair_status guarded(Body body) noexcept {
    try {
        body();
        return OCTOPAIR_OK;
    } catch (...) {
        return status_of_exception();
    }
}

/// Throws: Error{bad_input} if a required pointer is null.
template <typename Pointee>
Pointee& required(Pointee* pointer, const char* name) {
    if (pointer == nullptr) throw Error(ErrorCode::bad_input, std::string(name) + " is NULL");
    return *pointer;
}

/// Returns a struct of the caller. A shorter one, of an older header, is completed from `defaults`.
/// Throws: Error{bad_input} if the size is not set, or is that of a newer header.
template <typename Struct>
Struct read_struct(const Struct* given, Struct defaults, const char* name) {
    if (given == nullptr) return defaults;
    if (given->size < sizeof(std::size_t) || given->size > sizeof(Struct)) {
        throw Error(ErrorCode::bad_input, std::string(name) + " has the size " + std::to_string(given->size) +
                                              ", not up to " + std::to_string(sizeof(Struct)) +
                                              "; initialise it with its macro");
    }
    std::memcpy(static_cast<void*>(&defaults), given, given->size);
    return defaults;
}

/// Checks a struct that a call will write, before the call does anything. Null: accepted.
/// Throws: Error{bad_input} if the size is not set.
template <typename Struct>
void check_output(const Struct* given, const char* name) {
    if (given != nullptr && given->size < sizeof(std::size_t))
        throw Error(ErrorCode::bad_input, std::string(name) + " has no size; initialise it with its macro");
}

/// Writes as much of `values` as the caller's struct has room for. Null: nothing. Requires: check_output().
template <typename Struct>
void write_struct(Struct* given, Struct values) noexcept {
    if (given == nullptr) return;
    const std::size_t size = std::min(given->size, sizeof(Struct));
    values.size = given->size;
    std::memcpy(static_cast<void*>(given), &values, size);
}

/// Throws: Error{bad_input}.
Boxes boxes_of(std::int32_t precision, const void* boxes, std::uint64_t count);
Objects objects_of(const octopair_objects* given, const char* name);
Input input_of(const octopair_objects* first, const octopair_objects* second);

/// The options of a call, and its stop token.
struct CallOptions {
    Options options;
    std::stop_token stop;
};
CallOptions options_of(const octopair_options* given);

/// Returns a sink that calls `sink`. Its result throws Error{cancelled} if that returns a number other than 0.
PairSink sink_of(octopair_sink sink, void* data);

octopair_summary summary_of(const Summary& summary);

}  // namespace octopair::c
