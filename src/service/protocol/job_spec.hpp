// Conversion between calls of the library and the message JobSpec, checks of JobSpec, and the arrays of a job's input.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "engine/request.hpp"
#include "octopair/engine.hpp"

namespace octopair::v1 {
class JobSpec;
class Summary;
}  // namespace octopair::v1

namespace octopair::service {

/// Returns the spec of a call, without an id. `pairs`: false if only the number of pairs is wanted.
v1::JobSpec spec_of(const detail::Request& request, bool pairs);

/// Returns the options of a spec. They have no progress sink.
Options options_of(const v1::JobSpec& spec);

/// Checks the numbers of a spec, so that later computations of sizes do not overflow.
/// Throws: Error{bad_input} if a number is invalid; LimitError for more than 2^32 - 1 objects.
void check(const v1::JobSpec& spec);
/// Throws: Error{bad_input} unless `id` is a UUID of 8-4-4-4-12 digits in lower case.
void check_id(const std::string& id);
/// Returns a random id. Throws: Error{io_failed} if the system has no random bytes.
std::string new_id();

/// Returns the number of objects in both sets.
std::uint64_t object_count(const v1::JobSpec& spec);
/// Returns the size of the input. Requires: check(spec) has passed.
std::uint64_t input_bytes(const v1::JobSpec& spec);

/// The input arrays of a job in the order of the upload: boxes and paddings of the first set, then of the second. Arrays that
/// a job does not have are empty.
using InputArrays = std::array<std::span<const std::byte>, 4>;
InputArrays arrays_of(const detail::Request& request);

v1::Summary message_of(const Summary& summary);
Summary summary_of(const v1::Summary& message);

}  // namespace octopair::service
