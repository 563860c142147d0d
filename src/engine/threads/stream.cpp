// StreamExecutor: shares run ahead on helper threads while the calling thread hands out pairs in order.
//
// The calling thread hands out what is ready of the share whose turn it is, and when nothing is, runs a share itself: straight
// to the receiver if it is that one's turn, else to a buffer. When its buffer is full it waits for the shares before, which
// helpers run and which go on because it takes what they have ready; so a helper whose buffer is full may wait. Nobody runs a
// share that is `ahead` or more after the one whose turn it is.

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <utility>

#include "base/test_hooks.hpp"
#include "base/tuning.hpp"
#include "engine/threads/writers.hpp"
#include "octopair/error.hpp"

namespace octopair {

namespace {

using Body = std::function<void(std::size_t, ShareWriter&)>;

struct Abandoned {};

class OrderedStream {
public:
    OrderedStream(std::size_t count, const Body& body, std::size_t ahead, std::size_t buffer)
        : count_(count), body_(body), buffer_(buffer), slots_(ahead) {}

    void lead(const StreamExecutor::Deliver& deliver) {
        try {
            while (head_ < count_) {
                if (hand_out(deliver, false)) continue;
                if (const auto share = claim_as_lead()) {
                    LeadWriter writer(*this, deliver, *share);
                    body_(*share, writer);
                    writer.finish();
                } else {
                    hand_out(deliver, true);
                }
            }
        } catch (...) {
            fail(std::current_exception());
            std::rethrow_exception(failure_);
        }
    }

    void help() {
        std::vector<Pair> held;
        try {
            for (std::size_t share = claim(); share < count_; share = claim()) {
                BufferedWriter writer(*this, share, held);
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

    /// The calling thread's. Its share is the next one that nobody has begun.
    class LeadWriter final : public FullWriter {
    public:
        LeadWriter(OrderedStream& stream, const StreamExecutor::Deliver& deliver, std::size_t share)
            : stream_(stream), deliver_(deliver), share_(share), held_(stream.lead_held_) {}
        void write(std::span<const Pair> pairs) override {
            if (stream_.head_ == share_) {
                count_path(Path::stream_lead_wrote);
                return deliver_(pairs);
            }
            count_path(Path::stream_lead_held);
            if (!held_.empty() && held_.size() + pairs.size() > stream_.buffer_) {
                count_path(Path::stream_lead_full);
                while (stream_.head_ < share_) stream_.hand_out(deliver_, true);
                deliver_(held_);
                held_.clear();
                return deliver_(pairs);
            }
            held_.insert(held_.end(), pairs.begin(), pairs.end());
        }
        void finish() { stream_.hand_over(share_, held_, true); }

    private:
        OrderedStream& stream_;
        const StreamExecutor::Deliver& deliver_;
        std::size_t share_;
        std::vector<Pair>& held_;
    };

    class BufferedWriter final : public FullWriter {
    public:
        BufferedWriter(OrderedStream& stream, std::size_t share, std::vector<Pair>& held)
            : stream_(stream), share_(share), held_(held) {}
        void write(std::span<const Pair> pairs) override {
            if (!held_.empty() && held_.size() + pairs.size() > stream_.buffer_) {
                count_path(Path::stream_helper_full);
                stream_.hand_over(share_, held_, false);
            }
            held_.insert(held_.end(), pairs.begin(), pairs.end());
        }
        void finish() { stream_.hand_over(share_, held_, true); }

    private:
        OrderedStream& stream_;
        std::size_t share_;
        std::vector<Pair>& held_;
    };

    Slot& slot(std::size_t share) { return slots_[share % slots_.size()]; }

    /// None where all are begun, or all that may be.
    std::optional<std::size_t> claim_as_lead() {
        const std::lock_guard lock(mutex_);
        if (failed_) throw Abandoned{};
        if (next_ >= count_ || next_ >= head_ + slots_.size()) return {};
        return next_++;
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

    /// What is ready of the share whose turn it is, and the turn to the next one if that was all. False if nothing is, and
    /// it need not wait.
    bool hand_out(const StreamExecutor::Deliver& deliver, bool wait) {
        {
            std::unique_lock lock(mutex_);
            Slot& turn = slot(head_);
            const auto is_ready = [&] { return turn.finished || !turn.ready.empty(); };
            if (wait) changed_.wait(lock, [&] { return failed_ || is_ready(); });
            if (failed_) throw Abandoned{};
            if (!is_ready()) return false;
            taken_.swap(turn.ready);
            if (std::exchange(turn.finished, false)) ++head_;
            changed_.notify_all();
        }
        if (!taken_.empty()) deliver(taken_);
        taken_.clear();
        return true;
    }

    void fail(std::exception_ptr why) {
        const std::lock_guard lock(mutex_);
        if (!failed_) failure_ = std::move(why);
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
    std::vector<Pair> lead_held_, taken_;  // the calling thread's
    std::size_t next_ = 0;                 // the first share that nobody has begun
    std::size_t head_ = 0;                 // the share whose turn it is; the calling thread's to change
    bool failed_ = false;
    std::exception_ptr failure_;
};

}  // namespace

StreamExecutor::StreamExecutor(Team& team, Deliver deliver, std::uint64_t buffer_pairs, std::stop_source abandon)
    : TeamExecutor(team), deliver_(std::move(deliver)), buffer_pairs_(buffer_pairs), abandon_(std::move(abandon)) {}

void StreamExecutor::for_each_writing(std::size_t count, const Body& body) {
    const std::size_t ahead = std::size_t(width()) * tuning().output.shares_ahead;
    // A share holds what it fills and what is ready; the calling thread has one such buffer in hand beside.
    const std::size_t buffer = std::max<std::size_t>(1, std::size_t(buffer_pairs_ / (2 * ahead + 1)));
    OrderedStream stream(count, body, ahead, buffer);
    stream.on_failure = [&] { abandon_.request_stop(); };
    team().with_helpers([&] { stream.lead(deliver_); }, [&] { stream.help(); });
}

}  // namespace octopair
