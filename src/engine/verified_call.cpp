#include "engine/verified_call.hpp"

#include <algorithm>

#include "engine/pair_list.hpp"

namespace octopair {

namespace {

/// Fraction of the progress for the engine's search. The check takes longer, and reports its own progress better.
constexpr double search_progress = 0.3;
/// Fraction for the search of an ascending stream: most of the stream is checked before its last pair is found.
constexpr double stream_progress = 0.9;

}  // namespace

ResultKind VerifiedCall::kind() const {
    if (output_.list == nullptr && output_.sink == nullptr) return ResultKind::count;
    return request_.options.order == Order::octal ? ResultKind::octal : ResultKind::ascending;
}

/// Returns a sink that maps the progress of a part of the work, 0 to 1, to [begin, end] of the caller's progress.
ProgressSink VerifiedCall::part(double begin, double end) const {
    if (!control_.progress) return {};
    return [&progress = control_.progress, begin, end, reported = 0.0](double done) mutable {
        reported = std::max(reported, done);  // a check that passes over the objects twice starts again at 0
        progress(begin + (end - begin) * reported);
    };
}

Summary VerifiedCall::run(unsigned threads, const Run& run) {
    const Options& options = request_.options;
    Verifier verifier(
        {{request_.first, request_.second, options.margin}, kind(), options.limit, threads, control_.stop});
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

Verification VerifiedCall::check_list(Verifier& verifier, const Summary& summary) {
    const auto chunks = output_.list->chunks();
    for (const auto chunk : chunks) verifier.take(chunk);
    return verifier.finish({summary.pairs, summary.truncated, chunks});
}

}  // namespace octopair
