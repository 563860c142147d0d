#include "service/server/calls/download.hpp"

#include <optional>
#include <string>
#include <utility>

#include "service/protocol/messages.hpp"
#include "service/protocol/status.hpp"

namespace octopair::service {

Download::Next Download::next() {
    try {
        return make_next();
    } catch (...) {
        return {Next::Kind::last, {}, status_of_exception()};
    }
}

Download::Next Download::make_next() {
    using Kind = Next::Kind;
    // Read the report before the pairs: if the state is done, ready() then counts all pairs.
    v1::JobReport report = job_->report();
    if (report.state() == v1::FAILED) return {Kind::last, {}, status_of(report.failure())};
    if (report.state() == v1::CANCELLED) return {Kind::last, {}, status_of(Error(ErrorCode::cancelled, "cancelled"))};
    if (report.state() != v1::RUNNING && report.state() != v1::DONE) return {};

    v1::Download message;
    const std::optional<grpc::Slice> piece = job_->pairs().piece(offset_);
    if (piece) offset_ += piece->size() / sizeof(Pair);
    const bool last = report.state() == v1::DONE && offset_ >= job_->pairs().ready();
    // The client of an attached job received `offset` pairs before it lost its connection. It finds the error by the summary.
    if (last && job_->detached() && offset_ > job_->pairs().ready()) {
        throw Error(ErrorCode::bad_input, "the result has " + std::to_string(job_->pairs().ready()) +
                                              " pairs; offset " + std::to_string(offset_) + " is beyond its end");
    }
    const bool has_progress = report.progress() >= progress_sent_ + 0.01;
    if (!piece && !last && !has_progress && head_sent_) return {};
    if (!std::exchange(head_sent_, true)) *message.mutable_head() = std::move(*report.mutable_head());
    if (has_progress) message.set_progress(progress_sent_ = report.progress());
    if (last) *message.mutable_summary() = std::move(*report.mutable_summary());
    return {last ? Kind::last : Kind::message, pack(message, piece.value_or(grpc::Slice())), grpc::Status::OK};
}

}  // namespace octopair::service
