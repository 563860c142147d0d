#include "service/gate.hpp"

#include <chrono>

#include "base/stop.hpp"
#include "engine/job_queue.hpp"
#include "engine/request.hpp"

namespace octopair::test {

namespace {

/// Supports streams and counts only. Servers make no other calls.
class GatedEngine final : public Engine {
public:
    GatedEngine(Gate& gate, std::size_t free_below) : gate_(gate), free_below_(free_below) {}

private:
    Summary run(const detail::Request& request, const detail::Output& output, const detail::Control& control) override {
        if (request.first.size() >= free_below_) gate_.pass(control.stop);
        const PairSink sink = output.sink != nullptr ? *output.sink : PairSink();
        const Input input(request.first, request.second != nullptr ? std::optional(*request.second) : std::nullopt);
        return inner_->stream_pairs(input, sink, request.options, control.stop);
    }
    detail::JobQueue& jobs() override { return jobs_; }

    Gate& gate_;
    const std::size_t free_below_;
    std::unique_ptr<Engine> inner_ = make_local_engine(1);
    detail::JobQueue jobs_{*this};
};

}  // namespace

void Gate::open() {
    const std::lock_guard lock(mutex_);
    open_ = true;
    changed_.notify_all();
}

void Gate::close() {
    const std::lock_guard lock(mutex_);
    open_ = false;
}

void Gate::fail(const std::string& message) {
    const std::lock_guard lock(mutex_);
    failure_ = message;
}

void Gate::pass(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    if (!failure_.empty()) throw Error(ErrorCode::engine_failed, failure_);
    ++waiting_;
    changed_.notify_all();
    (void)changed_.wait(lock, stop, [&] { return open_; });
    --waiting_;
    throw_if_stopped(stop);
}

bool Gate::wait_for(unsigned waiting) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::minutes(1), [&] { return waiting_ >= waiting; });
}

service::EngineMaker gated_engines(Gate& gate, std::size_t free_below) {
    return [&gate, free_below](unsigned) { return std::make_unique<GatedEngine>(gate, free_below); };
}

}  // namespace octopair::test
