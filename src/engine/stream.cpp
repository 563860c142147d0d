// StreamExecutor: shares run ahead on helper threads while the calling thread hands out pairs in order.
//
// The calling thread goes through the shares in order. One that no helper has begun it runs itself, straight to the
// receiver; from one that a helper runs it takes over what is ready until the share ends. So the share whose turn it is
// always goes on, whatever the scheduler does, and a helper whose share's buffer is full may wait. Helpers run at most
// `ahead` shares ahead, each with a buffer of its part of the bound.

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <utility>

#include "engine/writers.hpp"
#include "octopair/error.hpp"

namespace octopair {

namespace {

using Body = std::function<void(std::size_t, PairWriter&)>;

struct Abandoned {};

class OrderedStream {
public:
    OrderedStream(std::size_t count, const Body& body, std::size_t ahead, std::size_t buffer)
        : count_(count), body_(body), buffer_(buffer), slots_(ahead) {}

    void lead(const StreamExecutor::Deliver& deliver) {
        try {
            for (std::size_t share = 0; share < count_; ++share) {
                if (claim_as_lead(share)) {
                    DirectWriter writer(deliver);
                    body_(share, writer);
                } else {
                    take_over(share, deliver);
                }
                const std::lock_guard lock(mutex_);
                head_ = share + 1;
                changed_.notify_all();
            }
        } catch (...) {
            fail(nullptr);
            throw;
        }
        const std::lock_guard lock(mutex_);
        changed_.notify_all();
    }

    void help() {
        try {
            for (std::size_t share = claim(); share < count_; share = claim()) {
                BufferedWriter writer(*this, share);
                body_(share, writer);
                writer.finish();
            }
        } catch (const Abandoned&) {
        } catch (...) {
            fail(std::current_exception());
        }
    }

    std::function<void()> on_failure;

private:
    struct Slot {
        std::vector<Pair> ready;
        bool finished = false;
    };

    class DirectWriter final : public FullWriter {
    public:
        explicit DirectWriter(const StreamExecutor::Deliver& deliver) : deliver_(deliver) {}
        void write(std::span<const Pair> pairs) override { deliver_(pairs); }

    private:
        const StreamExecutor::Deliver& deliver_;
    };

    class BufferedWriter final : public FullWriter {
    public:
        BufferedWriter(OrderedStream& stream, std::size_t share) : stream_(stream), share_(share) {}
        void write(std::span<const Pair> pairs) override {
            if (!held_.empty() && held_.size() + pairs.size() > stream_.buffer_)
                stream_.hand_over(share_, held_, false);
            held_.insert(held_.end(), pairs.begin(), pairs.end());
        }
        void finish() { stream_.hand_over(share_, held_, true); }

    private:
        OrderedStream& stream_;
        std::size_t share_;
        std::vector<Pair> held_;
    };

    Slot& slot(std::size_t share) { return slots_[share % slots_.size()]; }

    bool claim_as_lead(std::size_t share) {
        const std::lock_guard lock(mutex_);
        if (next_ != share) return false;
        ++next_;
        return true;
    }

    std::size_t claim() {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [&] { return failed_ || next_ >= count_ || next_ < head_ + slots_.size(); });
        if (failed_) throw Abandoned{};
        return next_ < count_ ? next_++ : count_;
    }

    void hand_over(std::size_t share, std::vector<Pair>& held, bool finished) {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [&] { return failed_ || slot(share).ready.empty(); });
        if (failed_) throw Abandoned{};
        slot(share).ready.swap(held);
        slot(share).finished = finished;
        held.clear();
        changed_.notify_all();
    }

    void take_over(std::size_t share, const StreamExecutor::Deliver& deliver) {
        std::vector<Pair> taken;
        for (bool finished = false; !finished;) {
            {
                std::unique_lock lock(mutex_);
                changed_.wait(lock, [&] { return failed_ || slot(share).finished || !slot(share).ready.empty(); });
                if (failed_) std::rethrow_exception(failure_);
                taken.swap(slot(share).ready);
                finished = std::exchange(slot(share).finished, false);
                changed_.notify_all();
            }
            if (!taken.empty()) deliver(taken);
            taken.clear();
        }
    }

    void fail(std::exception_ptr why) {
        const std::lock_guard lock(mutex_);
        if (!failed_) failure_ = why;
        failed_ = true;
        on_failure();
        changed_.notify_all();
    }

    const std::size_t count_;
    const Body& body_;
    const std::size_t buffer_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::vector<Slot> slots_;
    std::size_t next_ = 0;  // the first share that nobody has begun
    std::size_t head_ = 0;  // the first share that has not been handed out
    bool failed_ = false;
    std::exception_ptr failure_;
};

}  // namespace

StreamExecutor::StreamExecutor(Team& team, Deliver deliver, std::uint64_t buffer_pairs, std::stop_source abandon)
    : TeamExecutor(team), deliver_(std::move(deliver)), buffer_pairs_(buffer_pairs), abandon_(std::move(abandon)) {}

void StreamExecutor::for_each_writing(std::size_t count, const Body& body) {
    const std::size_t ahead = std::size_t(width()) * 4;
    // A share holds what it fills and what is ready; the calling thread has one such buffer in hand.
    const std::size_t buffer = std::max<std::size_t>(1, std::size_t(buffer_pairs_ / (2 * ahead + 1)));
    OrderedStream stream(count, body, ahead, buffer);
    stream.on_failure = [&] { abandon_.request_stop(); };
    team().with_helpers([&] { stream.lead(deliver_); }, [&] { stream.help(); });
}

}  // namespace octopair
