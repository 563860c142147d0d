#include "service/protocol/job_spec.hpp"

#include <unistd.h>

#include <array>
#include <cerrno>
#include <cmath>
#include <limits>
#include <string_view>

#include "base/descriptor.hpp"
#include "service/protocol/errors.hpp"
#include "service/protocol/octopair.pb.h"

namespace octopair::service {

namespace {

constexpr std::uint64_t max_objects = std::numeric_limits<std::uint32_t>::max();

v1::ObjectSet set_of(const Objects& objects) {
    v1::ObjectSet set;
    set.set_objects(objects.size());
    set.set_precision(std::holds_alternative<std::span<const Box3d>>(objects.boxes) ? v1::FLOAT64 : v1::FLOAT32);
    set.set_padded(!objects.padding.empty());
    return set;
}

std::uint64_t bytes_of(const v1::ObjectSet& set) {
    const std::uint64_t box = set.precision() == v1::FLOAT64 ? sizeof(Box3d) : sizeof(Box3f);
    return set.objects() * (box + (set.padded() ? sizeof(double) : 0));
}

void check_precision(const v1::ObjectSet& set) {
    if (!v1::Precision_IsValid(set.precision())) {
        throw Error(ErrorCode::bad_input, "unknown precision " + std::to_string(int(set.precision())));
    }
}

}  // namespace

v1::JobSpec spec_of(const detail::Request& request, bool pairs) {
    v1::JobSpec spec;
    *spec.mutable_first() = set_of(request.first);
    if (request.second != nullptr) *spec.mutable_second() = set_of(*request.second);
    spec.set_order(request.options.order == Order::octal ? v1::OCTAL : v1::ASCENDING);
    spec.set_margin(request.options.margin);
    if (request.options.limit) spec.set_limit(*request.options.limit);
    spec.set_count_only(!pairs);
    return spec;
}

Options options_of(const v1::JobSpec& spec) {
    Options options;
    options.order = spec.order() == v1::OCTAL ? Order::octal : Order::ascending;
    options.margin = spec.margin();
    if (spec.has_limit()) options.limit = spec.limit();
    return options;
}

void check(const v1::JobSpec& spec) {
    check_precision(spec.first());
    check_precision(spec.second());
    if (!v1::Order_IsValid(spec.order())) {
        throw Error(ErrorCode::bad_input, "unknown order " + std::to_string(int(spec.order())));
    }
    if (!(spec.margin() >= 0 && std::isfinite(spec.margin()))) {
        throw Error(ErrorCode::bad_input, "margin is " + std::to_string(spec.margin()) + ", not a finite number >= 0");
    }
    const std::uint64_t first = spec.first().objects(), second = spec.second().objects();
    if (first > max_objects || second > max_objects - first) {
        throw LimitError("objects", max_objects,
                         "more than " + std::to_string(max_objects) + " objects do not fit into one job");
    }
}

void check_id(const std::string& id) {
    constexpr std::string_view shape = "xxxxxxxx-xxxx-xxxx-xxxx-xxxxxxxxxxxx";
    bool right = id.size() == shape.size();
    for (std::size_t i = 0; right && i < shape.size(); ++i) {
        const bool digit = (id[i] >= '0' && id[i] <= '9') || (id[i] >= 'a' && id[i] <= 'f');
        right = shape[i] == 'x' ? digit : id[i] == '-';
    }
    if (!right) throw Error(ErrorCode::bad_input, "a job's id must be a UUID of 8-4-4-4-12 digits in lower case");
}

std::string new_id() {
    std::array<unsigned char, 16> random{};
    if (::getentropy(random.data(), random.size()) != 0) fail_io("a job's id", "no random bytes", errno);
    constexpr std::string_view digits = "0123456789abcdef";
    std::string id = "xxxxxxxx-xxxx-4xxx-8xxx-xxxxxxxxxxxx";  // version 4, of RFC 4122
    std::size_t half = 0;
    for (char& c : id) {
        if (c != 'x') continue;
        c = digits[random[half / 2] >> 4 * (half % 2) & 15];
        ++half;
    }
    return id;
}

std::uint64_t object_count(const v1::JobSpec& spec) { return spec.first().objects() + spec.second().objects(); }

std::uint64_t input_bytes(const v1::JobSpec& spec) { return bytes_of(spec.first()) + bytes_of(spec.second()); }

namespace {

std::span<const std::byte> bytes_of(const Boxes& boxes) {
    return std::visit([](auto span) { return std::as_bytes(span); }, boxes);
}

}  // namespace

InputArrays arrays_of(const detail::Request& request) {
    InputArrays arrays = {bytes_of(request.first.boxes), std::as_bytes(request.first.padding)};
    if (request.second != nullptr) {
        arrays[2] = bytes_of(request.second->boxes);
        arrays[3] = std::as_bytes(request.second->padding);
    }
    return arrays;
}

v1::Summary message_of(const Summary& summary) {
    v1::Summary message;
    message.set_pairs(summary.pairs);
    message.set_truncated(summary.truncated);
    message.set_entries(summary.entries);
    message.set_seconds(summary.seconds);
    message.set_encode_seconds(summary.steps.encode);
    message.set_scatter_seconds(summary.steps.scatter);
    message.set_count_seconds(summary.steps.count);
    message.set_scan_seconds(summary.steps.scan);
    return message;
}

Summary summary_of(const v1::Summary& message) {
    Summary summary;
    summary.pairs = message.pairs();
    summary.truncated = message.truncated();
    summary.entries = message.entries();
    summary.seconds = message.seconds();
    summary.steps = {message.encode_seconds(), message.count_seconds(), message.scatter_seconds(),
                     message.scan_seconds()};
    return summary;
}

}  // namespace octopair::service
