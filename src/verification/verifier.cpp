#include "verification/verifier.hpp"

#include <string>

#include "base/timed.hpp"
#include "verification/row_pass.hpp"

namespace octopair {

namespace {

std::unique_ptr<ResultCheck> make_check(const Verifier::Setup& setup, const RowPass& pass) {
    switch (setup.kind) {
        case ResultKind::ascending:
            return make_ascending_check(pass);
        case ResultKind::octal:
            return make_set_check(pass, setup.limit);
        case ResultKind::count:
            break;
    }
    return make_count_check(pass);
}

}  // namespace

/// The second algorithm and its data. Created at the first pair, or at the end if there is no pair: by then the engine has accepted the
/// objects, so their boxes are valid.
struct Verifier::Parts {
    Parts(const Setup& setup, const ProgressSink& progress)
        : team(setup.threads),
          rows(setup.objects, team, setup.stop),
          pass(rows, team, setup.stop, progress),
          check(make_check(setup, pass)) {}

    Team team;
    RowSearch rows;
    RowPass pass;
    std::unique_ptr<ResultCheck> check;
};

ResultCheck& Verifier::check() {
    if (parts_ == nullptr) parts_ = std::make_shared<Parts>(setup_, progress_);
    return *parts_->check;
}

void Verifier::take(std::span<const Pair> pairs) {
    const Timed timed(seconds_);
    taken_ += pairs.size();
    check().take(pairs);
}

Verification Verifier::finish(const CallEnd& end) {
    Verification verification;
    {
        const Timed timed(seconds_);
        check().finish(end);
        check_numbers(end);
        verification.not_checked = check().not_checked(end);
        parts_.reset();
    }
    verification.done = true;
    verification.seconds = seconds_;
    return verification;
}

/// Compares the summary with the number of pairs that were given, and with the limit.
void Verifier::check_numbers(const CallEnd& end) const {
    const auto fail = [&](const std::string& words) {
        throw_verification_failed("the summary says " + std::to_string(end.pairs) + " pairs, but " + words);
    };
    if (setup_.kind != ResultKind::count && end.pairs != taken_) fail(std::to_string(taken_) + " were given");
    if (!setup_.limit && end.truncated) fail("it is truncated without a limit");
    if (!setup_.limit) return;
    if (end.pairs > *setup_.limit) fail("the limit is " + std::to_string(*setup_.limit));
    if (end.truncated && end.pairs < *setup_.limit) {
        fail("it is truncated below the limit of " + std::to_string(*setup_.limit));
    }
}

}  // namespace octopair
