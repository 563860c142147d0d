#include "service/protocol/status.hpp"

#include <algorithm>
#include <exception>
#include <new>

#include "base/error_codes.hpp"
#include "service/protocol/errors.hpp"
#include "service/protocol/octopair.pb.h"

namespace octopair::service {

v1::Failure failure_of(const Error& error) {
    v1::Failure failure;
    failure.set_code(v1::ErrorCode(int(error.code())));
    failure.set_message(error.what());
    if (const auto* limit = dynamic_cast<const LimitError*>(&error)) {
        failure.set_limit(limit->name());
        failure.set_allowed(limit->allowed());
    }
    if (dynamic_cast<const NoJobError*>(&error) != nullptr) failure.set_detail(v1::NO_SUCH_JOB);
    if (const auto place = error.place()) {
        failure.mutable_place()->set_index(place->index);
        failure.mutable_place()->set_set(place->set);
    }
    return failure;
}

void throw_failure(const v1::Failure& failure) {
    if (!failure.limit().empty()) throw LimitError(failure.limit(), failure.allowed(), failure.message());
    if (failure.detail() == v1::NO_SUCH_JOB) throw NoJobError(failure.message());
    const bool known = failure.code() >= 0 && std::size_t(failure.code()) < error_code_table.size();
    const ErrorCode code = known ? ErrorCode(failure.code()) : ErrorCode::engine_failed;
    if (!failure.has_place()) throw Error(code, failure.message());
    const ErrorPlace place{.index = failure.place().index(), .set = failure.place().set(), .frame = {}};
    throw PlacedError(code, failure.message(), place);
}

grpc::Status status_of(const v1::Failure& failure) {
    const bool known = failure.code() >= 0 && std::size_t(failure.code()) < error_code_table.size();
    const int status = error_code_row(known ? ErrorCode(failure.code()) : ErrorCode::engine_failed).grpc_status;
    return {grpc::StatusCode(status), failure.message(), failure.SerializeAsString()};
}

grpc::Status status_of(const Error& error) { return status_of(failure_of(error)); }

void throw_status(const grpc::Status& status, const std::string& server) {
    v1::Failure failure;
    if (!status.error_details().empty() && failure.ParseFromString(status.error_details())) throw_failure(failure);
    const std::string words = server + ": " + status.error_message();
    switch (status.error_code()) {
        case grpc::StatusCode::CANCELLED:
            throw Error(ErrorCode::cancelled, "cancelled");
        case grpc::StatusCode::RESOURCE_EXHAUSTED:
            throw Error(ErrorCode::resource_limit, words);
        case grpc::StatusCode::DEADLINE_EXCEEDED:
            throw Error(ErrorCode::engine_failed, server + ": no server answers in time");
        case grpc::StatusCode::UNAUTHENTICATED:
        case grpc::StatusCode::PERMISSION_DENIED:
            throw Error(ErrorCode::usage, words);
        default:
            throw Error(ErrorCode::engine_failed, words);
    }
}

bool is_retryable(const grpc::Status& status) {
    if (status.error_code() == grpc::StatusCode::UNAVAILABLE) return true;
    // gRPC reports INTERNAL if the connection breaks within a message, CANCELLED if the server shuts down during the call.
    return status.error_details().empty() &&
           (status.error_code() == grpc::StatusCode::INTERNAL || status.error_code() == grpc::StatusCode::CANCELLED);
}

grpc::Status status_of_exception() {
    try {
        throw;
    } catch (const Error& error) {
        return status_of(error);
    } catch (const std::bad_alloc&) {
        return {grpc::StatusCode::RESOURCE_EXHAUSTED, "out of memory"};
    } catch (const std::exception& error) {
        return status_of(Error(ErrorCode::engine_failed, error.what()));
    } catch (...) {
        return status_of(Error(ErrorCode::engine_failed, "an exception that is no std::exception"));
    }
}

}  // namespace octopair::service
