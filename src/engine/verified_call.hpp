// VerifiedCall: a call with Options::verify. The engine's result is checked on its way to the caller.
//
// A list is checked when it is complete. A stream is checked batch by batch, each before the caller's sink gets it, and
// at its end. The process of the caller does it, whatever engine finds the pairs.
#pragma once

#include <functional>

#include "engine/request.hpp"
#include "verification/verifier.hpp"

namespace octopair {

class VerifiedCall {
public:
    using Run = std::function<Summary(const detail::Request&, const detail::Output&, const detail::Control&)>;

    VerifiedCall(const detail::Request& request, const detail::Output& output, const detail::Control& control)
        : request_(request), output_(output), control_(control) {}

    /// Calls `run` once. `threads` of this process check; 0: one per core. Throws what `run` throws, and
    /// Error{engine_failed} for a result that is wrong; then the caller empties the list.
    Summary run(unsigned threads, const Run& run);

private:
    ResultKind kind() const;
    bool is_stream() const { return output_.sink != nullptr; }
    ProgressSink part(double begin, double end) const;
    Verification check_list(Verifier& verifier, const Summary& summary);

    const detail::Request& request_;
    const detail::Output& output_;
    const detail::Control& control_;
};

}  // namespace octopair
