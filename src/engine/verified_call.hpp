// VerifiedCall: a call with Options::verify. Checks the engine's result before the caller receives it.
//
// List     checked when it is complete.
// Stream   each batch is checked before the caller's sink receives it; the whole stream is checked at its end.
// Process  the check runs in the caller's process, with every engine.
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

    /// Calls `run` once and checks its result on `threads` threads of this process; 0: one per core.
    /// Throws: what `run` throws; Error{engine_failed} if the result is wrong. The caller must then empty the list.
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
