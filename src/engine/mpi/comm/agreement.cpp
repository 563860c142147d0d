#include "engine/mpi/comm/agreement.hpp"

#include <algorithm>
#include <compare>
#include <new>
#include <vector>

namespace octopair {

void StopRelay::poll() {
    if (on_poll_) on_poll_();
    if (known_) return;
    if (stop_.stop_requested()) {
        known_ = sent_ = true;
        comm_.send_stop();
    } else if (comm_.stop_has_come()) {
        known_ = true;
        stop_.request_stop();
    }
}

void StopRelay::end() {
    known_ = true;  // no rank would receive a stop that is sent after the exchange below
    const std::vector<char> sent = comm_.all_gather(char(sent_));
    for (unsigned r = 0; r < comm_.size(); ++r) {
        if (sent[r] != 0 && r != comm_.rank()) comm_.receive_stop(r);
    }
    comm_.finish_stop();
}

namespace {

/// Kind of outcome of a part on one rank. If several ranks fail, the lowest value has priority.
/// `foreign`: an exception that is no Error.
enum class OutcomeKind : std::uint8_t { bad_object, error, foreign, stopped, good };

constexpr std::int32_t no_set = -1;

/// Outcome of a part on one rank, without its message. Sent to all ranks.
struct OutcomeHeader {
    OutcomeKind kind = OutcomeKind::good;
    ErrorCode code = ErrorCode::engine_failed;
    std::uint32_t length = 0;    // length of the message
    std::uint64_t position = 0;  // position of a bad object
    std::uint64_t index = 0;     // object index of the Error's place
    std::int32_t set = no_set;   // set of the Error's place; no_set: the Error has no place
};

bool precedes(const OutcomeHeader& a, const OutcomeHeader& b) {
    return a.kind != b.kind ? a.kind < b.kind : a.position < b.position;
}

}  // namespace

struct Agreement::Outcome {
    OutcomeHeader header;
    std::string message;
    std::exception_ptr failure = {};
};

Agreement::Outcome Agreement::outcome_of(const std::function<void()>& part) {
    try {
        part();
        return {};
    } catch (const BadObject& bad) {
        OutcomeHeader header{OutcomeKind::bad_object, ErrorCode::bad_input, 0, bad.position};
        if (bad.place) header.index = bad.place->index, header.set = std::int32_t(bad.place->set);
        return {header, bad.message};
    } catch (const Error& error) {
        const OutcomeKind kind = error.code() == ErrorCode::cancelled ? OutcomeKind::stopped : OutcomeKind::error;
        return {{kind, error.code()}, error.what()};
    } catch (const std::bad_alloc&) {
        return {{OutcomeKind::error, ErrorCode::resource_limit}, "out of memory"};
    } catch (...) {
        return {{OutcomeKind::foreign}, "the receiver of the pairs failed", std::current_exception()};
    }
}

void Agreement::together(const std::function<void()>& part) {
    Outcome own = outcome_of(part);
    if (comm_.sum(own.header.kind == OutcomeKind::good ? 0 : 1) == 0) return;
    own.header.length = std::uint32_t(own.message.size());
    const std::vector<OutcomeHeader> all = comm_.all_gather(own.header);
    const auto first = std::min_element(all.begin(), all.end(), precedes);
    const unsigned rank = unsigned(first - all.begin());
    std::string message = own.message;
    message.resize(first->length);
    comm_.broadcast(std::span(message), rank);
    if (own.failure) std::rethrow_exception(own.failure);
    if (first->set != no_set) {
        throw PlacedError(first->code, message, {.index = first->index, .set = unsigned(first->set), .frame = {}});
    }
    const bool of_many = comm_.size() > 1 && (first->kind == OutcomeKind::error || first->kind == OutcomeKind::foreign);
    throw Error(first->code, of_many ? "rank " + std::to_string(rank) + ": " + message : message);
}

}  // namespace octopair
