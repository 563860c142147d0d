#include "engine/verified_call.hpp"

#include <algorithm>

#include "engine/pair_list.hpp"

namespace octopair {

namespace {

/// The part of the progress that the engine gets. The check takes longer, but is the better judge of its own progress.
constexpr double found = 0.3;
/// The part of an ascending stream, of which most is checked before the last pair is there.
constexpr double streamed = 0.9;

}  // namespace

ResultKind VerifiedCall::kind() const {
    if (output_.list == nullptr && output_.sink == nullptr) return ResultKind::count;
    return request_.options.order == Order::octal ? ResultKind::octal : ResultKind::ascending;
}

/// The caller's progress, of which a part of the work fills [begin, end].
ProgressSink VerifiedCall::part(double begin, double end) const {
    if (!control_.progress) return {};
    return [&progress = control_.progress, begin, end, told = 0.0](double done) mutable {
        told = std::max(told, done);  // where the check goes over the objects twice
        progress(begin + (end - begin) * told);
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
    const double half = is_stream() && kind() == ResultKind::ascending ? streamed : found;
    const ProgressSink progress = part(0, half);
    detail::Output output = output_;
    if (is_stream()) output.sink = &checked;
    Summary summary = run(request_, output, {control_.stop, progress});
    summary.seconds = std::max(0.0, summary.seconds - verifier.seconds());
    verifier.tell(part(half, 1));
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
