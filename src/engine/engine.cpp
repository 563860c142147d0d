// Engine: the public calls. They check the request, and pass it to the engine that derives from Engine.
#include <cmath>
#include <limits>
#include <new>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "base/call_scope.hpp"
#include "base/floating_point_scope.hpp"
#include "base/free_memory.hpp"
#include "base/memory.hpp"
#include "engine/pair_list.hpp"
#include "engine/request.hpp"
#include "engine/verified_call.hpp"
#include "octopair/error.hpp"

namespace octopair {

namespace {

constexpr std::uint64_t max_objects = std::numeric_limits<std::uint32_t>::max();

void check_set(const Objects& set, const char* name) {
    if (!set.padding.empty() && set.padding.size() != set.size()) {
        throw Error(ErrorCode::bad_input, std::string(name) + ": " + std::to_string(set.padding.size()) +
                                              " paddings for " + std::to_string(set.size()) + " objects");
    }
}

/// Returns a sink that refuses more than `most` pairs: a bound that holds for every engine. Borrows `sink`.
PairSink bounded(const PairSink& sink, std::uint64_t most) {
    return [&sink, most, left = most](std::span<const Pair> pairs) mutable {
        if (pairs.size() > left)
            throw TooManyPairs("more than " + digit_groups(most) + " pairs, the largest number allowed", most, false);
        left -= pairs.size();
        sink(pairs);
    };
}

}  // namespace

ProgressSink detail::callback_of(const CallScope& call, const ProgressSink& progress) {
    if (!progress) return {};
    return [&](double done) {
        const CallbackScope scope(call);
        progress(done);
    };
}

void detail::check_request(const detail::Request& request) {
    const double margin = request.options.margin;
    if (!(margin >= 0 && std::isfinite(margin))) {
        throw Error(ErrorCode::bad_input, "margin is " + std::to_string(margin) + ", not a finite number >= 0");
    }
    check_set(request.first, request.second != nullptr ? "first set" : "objects");
    if (request.second != nullptr) check_set(*request.second, "second set");
    const std::uint64_t size = request.first.size() + (request.second != nullptr ? request.second->size() : 0);
    if (size > max_objects) {
        throw Error(ErrorCode::resource_limit,
                    std::to_string(size) + " objects; at most " + std::to_string(max_objects) + " fit into one call");
    }
}

void Engine::check(const detail::Request& request) const { detail::check_request(request); }

unsigned Engine::verification_threads() const { return 0; }

/// Runs one public call. Throws if a callback of this engine makes the call: the new call would wait for the running call, which waits for
/// the callback. Checks the request, and turns std::bad_alloc into Error{resource_limit}. Leaves the list empty on failure, except if it refuses a call within a callback. The engine, the
/// sinks and the progress callbacks run in the default floating-point state.
Summary Engine::call(const detail::Request& request, const detail::Output& output, std::stop_token stop) {
    refuse_inside_call_of(this);
    const FloatingPointScope scope;
    const CallScope own(this);
    if (output.list != nullptr) detail::storage_of(*output.list).reset();
    check(request);
    try {
        const ProgressSink progress = detail::callback_of(own, request.options.progress);
        const detail::Control control{stop, progress};
        if (!request.options.verify) return run(request, output, control);
        return detail::VerifiedCall{request, output, control}.run(verification_threads(),
                                                                  [this](const auto&... call) { return run(call...); });
    } catch (const std::bad_alloc&) {
        if (output.list != nullptr) detail::storage_of(*output.list).release();
        throw Error(ErrorCode::resource_limit, "out of memory");
    } catch (const TooManyPairs&) {
        if (output.list != nullptr) detail::storage_of(*output.list).release();
        throw;
    } catch (...) {
        if (output.list != nullptr) detail::storage_of(*output.list).reset();
        throw;
    }
}

Summary Engine::find_pairs(const Input& input, PairList& pairs, const Options& options, std::stop_token stop) {
    return call(detail::request_of(input, options), {.list = &pairs}, stop);
}

Summary Engine::stream_pairs(const Input& input, const PairSink& sink, const Options& options, std::stop_token stop) {
    return call(detail::request_of(input, options), {.sink = sink ? &sink : nullptr}, stop);
}

// NOLINTNEXTLINE(readability-function-size): the parameters of stream_pairs(), and the bound.
Summary Engine::stream_at_most(std::uint64_t max_pairs, const Input& input, const PairSink& sink,
                               const Options& options, std::stop_token stop) {
    if (!sink) return stream_pairs(input, sink, options, stop);
    const PairSink most = bounded(sink, max_pairs);
    return call(detail::request_of(input, options), {.sink = &most, .max_pairs = max_pairs}, stop);
}

std::uint64_t Engine::count_pairs(const Input& input, const Options& options, std::stop_token stop) {
    return call(detail::request_of(input, options), {}, stop).pairs;
}

std::shared_ptr<void> Engine::allocate_array(std::uint64_t count, std::size_t element_bytes) {
    if (count > max_objects || count > std::numeric_limits<std::size_t>::max() / element_bytes) {
        throw Error(ErrorCode::resource_limit,
                    std::to_string(count) + " boxes; at most " + std::to_string(max_objects) + " can be allocated");
    }
    try {
        return allocate(std::size_t(count) * element_bytes);
    } catch (const std::bad_alloc&) {
        throw Error(ErrorCode::resource_limit, "out of memory");
    }
}

std::shared_ptr<void> Engine::allocate(std::size_t bytes) {
    return {allocate_pages(bytes), [bytes](void* memory) { free_pages(memory, bytes); }};
}

namespace {

template <typename Real>
std::vector<Pair> find_pairs_once(std::span<const Box<Real>> boxes, const Options& options) {
    PairList pairs;
    (void)make_local_engine()->find_pairs(Objects{boxes, {}}, pairs, options);
    return pairs.to_vector();
}

}  // namespace

std::vector<Pair> find_pairs(std::span<const Box3f> boxes, const Options& options) {
    return find_pairs_once(boxes, options);
}

std::vector<Pair> find_pairs(std::span<const Box3d> boxes, const Options& options) {
    return find_pairs_once(boxes, options);
}

}  // namespace octopair
