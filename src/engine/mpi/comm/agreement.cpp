#include "engine/mpi/comm/agreement.hpp"

#include <algorithm>
#include <compare>
#include <new>
#include <vector>

namespace octopair {

void StopRelay::pass_on() {
    if (beside_) beside_();
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
    known_ = true;  // what is sent from here on would find nobody
    const std::vector<char> sent = comm_.all_gather(char(sent_));
    for (unsigned r = 0; r < comm_.size(); ++r) {
        if (sent[r] != 0 && r != comm_.rank()) comm_.receive_stop(r);
    }
    comm_.finish_stop();
}

namespace {

/// In the order in which failures are told.
enum class Ending : std::uint8_t { bad_object, error, foreign, stopped, good };

/// What a rank tells of itself.
struct ToldEnding {
    Ending ending = Ending::good;
    ErrorCode code = ErrorCode::engine_failed;
    std::uint32_t length = 0;    // of the message
    std::uint64_t position = 0;  // of a bad object
};

bool before(const ToldEnding& a, const ToldEnding& b) {
    return a.ending != b.ending ? a.ending < b.ending : a.position < b.position;
}

}  // namespace

struct Agreement::Outcome {
    ToldEnding told;
    std::string message;
    std::exception_ptr failure = {};
};

Agreement::Outcome Agreement::outcome_of(const std::function<void()>& part) {
    try {
        part();
        return {};
    } catch (const BadObject& bad) {
        return {{Ending::bad_object, ErrorCode::bad_input, 0, bad.position}, bad.message};
    } catch (const Error& error) {
        const Ending ending = error.code() == ErrorCode::cancelled ? Ending::stopped : Ending::error;
        return {{ending, error.code()}, error.what()};
    } catch (const std::bad_alloc&) {
        return {{Ending::error, ErrorCode::resource_limit}, "out of memory"};
    } catch (...) {
        return {{Ending::foreign}, "the receiver of the pairs failed", std::current_exception()};
    }
}

void Agreement::together(const std::function<void()>& part) {
    Outcome own = outcome_of(part);
    own.told.length = std::uint32_t(own.message.size());
    const std::vector<ToldEnding> all = comm_.all_gather(own.told);
    const auto first = std::min_element(all.begin(), all.end(), before);
    if (first->ending == Ending::good) return;
    const unsigned rank = unsigned(first - all.begin());
    std::string message = own.message;
    message.resize(first->length);
    comm_.broadcast(std::span(message), rank);
    if (own.failure) std::rethrow_exception(own.failure);
    const bool of_many = comm_.size() > 1 && (first->ending == Ending::error || first->ending == Ending::foreign);
    throw Error(first->code, of_many ? "rank " + std::to_string(rank) + ": " + message : message);
}

}  // namespace octopair
