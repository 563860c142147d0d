#include "engine/verified_call.hpp"

#include <algorithm>
#include <span>

#include "verification/verifier.hpp"

namespace octopair::detail {

namespace {

/// Progress of the call when the engine's search ends, as a fraction. The rest is for the check, which takes longer than the search.
constexpr double search_progress = 0.3;
/// Progress of an ascending stream when the search ends. The fraction is larger, because most pairs are checked during the search.
constexpr double stream_progress = 0.9;

ResultKind kind_of(const VerifiedCall& call) {
    if (call.output.list == nullptr && call.output.sink == nullptr) return ResultKind::count;
    return call.request.options.order == Order::octal ? ResultKind::octal : ResultKind::ascending;
}

/// Returns a sink that maps the progress of a part of the work, 0 to 1, to [begin, end] of `progress`. Empty if `progress` is empty.
ProgressSink part(const ProgressSink& progress, double begin, double end) {
    if (!progress) return {};
    return [&progress, begin, end, reported = 0.0](double done) mutable {
        reported = std::max(reported, done);  // a check that passes over the objects twice starts again at 0
        progress(begin + (end - begin) * reported);
    };
}

}  // namespace

Summary VerifiedCall::run(unsigned threads, const RunSearch& search) const {
    const ResultKind kind = kind_of(*this);
    const bool is_stream = output.sink != nullptr;
    Verifier verifier(
        {{request.first, request.second, request.options.margin}, kind, request.options.limit, threads, control.stop});
    const PairSink checked = [&](std::span<const Pair> pairs) {
        verifier.take(pairs);
        (*output.sink)(pairs);
    };
    const double half = is_stream && kind == ResultKind::ascending ? stream_progress : search_progress;
    const ProgressSink progress = part(control.progress, 0, half);
    Output checked_output = output;
    if (is_stream) checked_output.sink = &checked;
    Summary summary = search(request, checked_output, {control.stop, progress});
    summary.seconds = std::max(0.0, summary.seconds - verifier.seconds());
    verifier.set_progress(part(control.progress, half, 1));
    if (output.list != nullptr) {
        const auto chunks = output.list->chunks();
        for (const auto chunk : chunks) verifier.take(chunk);
        summary.verification = verifier.finish({summary.pairs, summary.truncated, chunks});
    } else {
        summary.verification = verifier.finish({summary.pairs, summary.truncated});
    }
    if (control.progress) control.progress(1);
    return summary;
}

}  // namespace octopair::detail
