// What a job asks for: from a call of the library to a message, back, and what its data are.
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

/// Without an id. `pairs`: they are wanted, not their number alone.
v1::JobSpec spec_of(const detail::Request& request, bool pairs);

/// The options that a spec says, but for progress.
Options options_of(const v1::JobSpec& spec);

/// Throws Error{bad_input} for numbers that no spec may have, a LimitError for more objects than a call can have (2^32 - 1).
/// After that sizes do not overflow.
void check(const v1::JobSpec& spec);
/// Throws Error{bad_input} unless `id` is a UUID in its usual form, with small letters.
void check_id(const std::string& id);
/// A random one.
std::string new_id();

std::uint64_t object_count(const v1::JobSpec& spec);
/// Of a spec that was checked.
std::uint64_t input_bytes(const v1::JobSpec& spec);

/// The arrays that the data of a job are, one after the other; those that are not there are empty.
using InputArrays = std::array<std::span<const std::byte>, 4>;
InputArrays arrays_of(const detail::Request& request);

v1::Summary message_of(const Summary& summary);
Summary summary_of(const v1::Summary& message);

}  // namespace octopair::service
