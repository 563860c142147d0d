// Engine: the public calls. They check the request, and pass it to the engine that derives from Engine.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <new>
#include <string>
#include <utility>

#include "base/call_scope.hpp"
#include "base/floating_point_scope.hpp"
#include "base/memory.hpp"
#include "engine/job_queue.hpp"
#include "engine/job_task.hpp"
#include "engine/pair_list.hpp"
#include "engine/request.hpp"
#include "octopair/error.hpp"
#include "verification/verifier.hpp"

namespace octopair {

namespace {

constexpr std::uint64_t max_objects = std::numeric_limits<std::uint32_t>::max();

void check_set(const Objects& set, const char* name) {
    if (!set.padding.empty() && set.padding.size() != set.size()) {
        throw Error(ErrorCode::bad_input, std::string(name) + ": " + std::to_string(set.padding.size()) +
                                              " paddings for " + std::to_string(set.size()) + " objects");
    }
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

namespace {

/// A call with Options::verify. Checks the engine's result before the caller receives it, in the caller's process, with every engine.
/// A list is checked when it is complete. A stream is checked batch by batch, before the caller's sink receives the batch. When the
/// stream has ended, the verifier also checks that no pair is missing.
class VerifiedCall {
public:
    using Run = std::function<Summary(const detail::Request&, const detail::Output&, const detail::Control&)>;

    VerifiedCall(const detail::Request& request, const detail::Output& output, const detail::Control& control)
        : request_(request), output_(output), control_(control) {}

    /// Calls `run` once and checks its result on `threads` threads of this process; 0: one per core.
    /// Throws: what `run` throws; Error{engine_failed} if the result is wrong. The caller must then empty the list.
    Summary run(unsigned threads, const Run& run) {
        Verifier verifier({{request_.first, request_.second, request_.options.margin},
                           kind(),
                           request_.options.limit,
                           threads,
                           control_.stop});
        const PairSink checked = [&](std::span<const Pair> pairs) {
            verifier.take(pairs);
            (*output_.sink)(pairs);
        };
        const double half = is_stream() && kind() == ResultKind::ascending ? stream_progress : search_progress;
        const ProgressSink progress = part(0, half);
        detail::Output output = output_;
        if (is_stream()) output.sink = &checked;
        Summary summary = run(request_, output, {control_.stop, progress});
        summary.seconds = std::max(0.0, summary.seconds - verifier.seconds());
        verifier.set_progress(part(half, 1));
        if (output_.list != nullptr) {
            summary.verification = check_list(verifier, summary);
        } else {
            summary.verification = verifier.finish({summary.pairs, summary.truncated});
        }
        if (control_.progress) control_.progress(1);
        return summary;
    }

private:
    /// Progress of the call when the engine's search ends, as a fraction. The rest is for the check, which takes longer than the search.
    static constexpr double search_progress = 0.3;
    /// Progress of an ascending stream when the search ends. The fraction is larger, because most pairs are checked during the search.
    static constexpr double stream_progress = 0.9;

    bool is_stream() const { return output_.sink != nullptr; }
    ResultKind kind() const {
        if (output_.list == nullptr && output_.sink == nullptr) return ResultKind::count;
        return request_.options.order == Order::octal ? ResultKind::octal : ResultKind::ascending;
    }
    /// Returns a sink that maps the progress of a part of the work, 0 to 1, to [begin, end] of the caller's progress.
    ProgressSink part(double begin, double end) const {
        if (!control_.progress) return {};
        return [&progress = control_.progress, begin, end, reported = 0.0](double done) mutable {
            reported = std::max(reported, done);  // a check that passes over the objects twice starts again at 0
            progress(begin + (end - begin) * reported);
        };
    }
    Verification check_list(Verifier& verifier, const Summary& summary) {
        const auto chunks = output_.list->chunks();
        for (const auto chunk : chunks) verifier.take(chunk);
        return verifier.finish({summary.pairs, summary.truncated, chunks});
    }

    const detail::Request& request_;
    const detail::Output& output_;
    const detail::Control& control_;
};

}  // namespace

/// Runs one public call. Throws if a callback of this engine makes the call: the new call would wait for the running call, which waits for
/// the callback. Checks the request, and turns std::bad_alloc into Error{resource_limit}. Leaves the list empty on failure. The engine, the
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
        return VerifiedCall(request, output, control).run(verification_threads(), [this](const auto&... call) {
            return run(call...);
        });
    } catch (const std::bad_alloc&) {
        if (output.list != nullptr) detail::storage_of(*output.list).reset();
        throw Error(ErrorCode::resource_limit, "out of memory");
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

std::uint64_t Engine::count_pairs(const Input& input, const Options& options, std::stop_token stop) {
    return call(detail::request_of(input, options), {}, stop).pairs;
}

namespace {

[[noreturn]] void throw_out_of_memory() { throw Error(ErrorCode::resource_limit, "out of memory"); }

}  // namespace

template <typename Work>
Job Engine::submit_work(Work work) {
    const FloatingPointScope scope;
    check(detail::request_of(detail::view(work.input), work.options));
    try {
        const auto task = std::make_shared<detail::JobTask>(std::move(work));
        jobs().add(task);
        return detail::make_job(task);
    } catch (const std::bad_alloc&) {
        throw_out_of_memory();
    }
}

Job Engine::submit(JobInput input, Options options) {
    return submit_work(detail::JobTask::Work{std::move(input), {}, std::move(options)});
}

Job Engine::submit_stream(JobInput input, PairSink sink, Options options) {
    return submit_work(detail::JobTask::Work{std::move(input), std::move(sink), std::move(options)});
}

std::shared_ptr<void> Engine::allocate_array(std::uint64_t count, std::size_t element_bytes) {
    if (count > max_objects || count > std::numeric_limits<std::size_t>::max() / element_bytes) {
        throw Error(ErrorCode::resource_limit,
                    std::to_string(count) + " boxes; at most " + std::to_string(max_objects) + " can be allocated");
    }
    try {
        return allocate(std::size_t(count) * element_bytes);
    } catch (const std::bad_alloc&) {
        throw_out_of_memory();
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
