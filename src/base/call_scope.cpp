#include "base/call_scope.hpp"

#include "octopair/error.hpp"

namespace octopair {

namespace {

thread_local const CallScope* innermost_call = nullptr;

}  // namespace

CallScope::CallScope(const void* owner, const CallScope* outer) noexcept
    : owner_(owner), outer_(outer), previous_(innermost_call) {
    innermost_call = this;
}

CallScope::~CallScope() { innermost_call = previous_; }

const CallScope* CallScope::innermost() noexcept { return innermost_call; }

bool CallScope::is_inside(const void* owner) noexcept {
    if (owner == nullptr) return false;
    for (const CallScope* call = innermost_call; call != nullptr; call = call->outer_) {
        if (call->owner_ == owner) return true;
    }
    return false;
}

CallbackScope::CallbackScope(const CallScope& call) noexcept : previous_(innermost_call) { innermost_call = &call; }

CallbackScope::~CallbackScope() { innermost_call = previous_; }

void refuse_inside_call_of(const void* engine) {
    if (!CallScope::is_inside(engine)) return;
    throw Error(ErrorCode::usage,
                "deadlock: a callback calls the engine that runs it; use another engine there, or submit a job and "
                "wait for it later");
}

}  // namespace octopair
