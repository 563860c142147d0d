// CallScope: the calls that the current thread runs, so that a callback cannot wait for the call that it belongs to.
//
// Owners    An owner is an object whose calls run one at a time, for example an engine. Each call of an owner has a CallScope.
// Callbacks If a callback runs on another thread than its call, it gets a CallbackScope on this thread. So any thread that runs a callback
//           has the scopes of the callback's call.
// Cost      Two accesses to a thread-local variable.
#pragma once

#include "base/private_export.hpp"

namespace octopair {

class OCTOPAIR_PRIVATE_EXPORT CallScope {
public:
    /// Adds a call of `owner` to the calls of this thread, until the scope ends.
    explicit CallScope(const void* owner) noexcept : CallScope(owner, innermost()) {}
    /// Replaces the calls of this thread by a call of `owner` within `outer`, until the scope ends. `outer` must outlive this scope.
    CallScope(const void* owner, const CallScope* outer) noexcept;
    ~CallScope();
    CallScope(const CallScope&) = delete;
    CallScope& operator=(const CallScope&) = delete;

    /// Returns the innermost call of this thread, or null.
    static const CallScope* innermost() noexcept;
    /// Returns true if this thread is in a call of `owner`, or in a callback of such a call.
    static bool is_inside(const void* owner) noexcept;

private:
    const void* owner_;
    const CallScope* outer_;
    const CallScope* previous_;  // innermost call of this thread before this scope; restored at its end
};

/// Replaces the calls of this thread by the call that runs a callback and the calls around it, until the scope ends.
class OCTOPAIR_PRIVATE_EXPORT CallbackScope {
public:
    /// `call` must outlive this scope.
    explicit CallbackScope(const CallScope& call) noexcept;
    ~CallbackScope();
    CallbackScope(const CallbackScope&) = delete;
    CallbackScope& operator=(const CallbackScope&) = delete;

private:
    const CallScope* previous_;
};

/// Throws: Error{usage} if this thread is in a call of the engine `engine`, or in a callback of such a call.
OCTOPAIR_PRIVATE_EXPORT void refuse_inside_call_of(const void* engine);

}  // namespace octopair
