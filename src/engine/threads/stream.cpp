// stream_pairs(): helper threads run shares ahead while the calling thread (the lead) delivers pairs in the order of shares.
//
// The head is the share whose pairs are delivered next. The lead delivers the ready pairs of the head. If there are none,
// the lead runs a share itself: straight to the receiver if that share is the head, else into a buffer.
//
// Invariants
//   No thread runs a share with a number of head + `ahead` or more.
//   A helper whose buffer is full waits until the lead has taken its ready pairs.
//   A lead whose buffer is full keeps delivering the pairs of earlier shares, so their helpers make progress: no deadlock.

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <utility>

#include "base/test_hooks.hpp"
#include "base/tuning.hpp"
#include "engine/output/outputs.hpp"
#include "engine/threads/team_output.hpp"
#include "octopair/error.hpp"

namespace octopair {

namespace {

using Body = std::function<void(std::size_t, ShareWriter&)>;

struct Abandoned {};

class OrderedStream {
public:
    OrderedStream(std::size_t count, const Body& body, std::size_t ahead, std::size_t buffer)
        : count_(count), body_(body), buffer_(buffer), slots_(ahead) {}

    void lead(const PairSink& deliver) {
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

    /// Writes a share that the calling thread runs.
    class LeadWriter final : public FullOutput {
    public:
        LeadWriter(OrderedStream& stream, const PairSink& deliver, std::size_t share)
            : stream_(stream), deliver_(deliver), share_(share), held_(stream.lead_held_) {}
        void write(std::span<const Pair> pairs) override {
            if (stream_.head_ == share_) {
                count_path(Path::stream_lead_wrote);
                return deliver_(pairs);
            }
            count_path(Path::stream_lead_held);
            const auto held = pairs.first(std::min(pairs.size(), stream_.buffer_ - held_.size()));
            held_.insert(held_.end(), held.begin(), held.end());
            if (held.size() == pairs.size()) return;
            count_path(Path::stream_lead_full);
            while (stream_.head_ < share_) stream_.hand_out(deliver_, true);
            deliver_(held_);
            held_.clear();
            deliver_(pairs.subspan(held.size()));
        }
        void finish() { stream_.hand_over(share_, held_, true); }

    private:
        OrderedStream& stream_;
        const PairSink& deliver_;
        std::size_t share_;
        std::vector<Pair>& held_;
    };

    class BufferedWriter final : public FullOutput {
    public:
        BufferedWriter(OrderedStream& stream, std::size_t share, std::vector<Pair>& held)
            : stream_(stream), share_(share), held_(held) {}
        void write(std::span<const Pair> pairs) override {
            const auto room = [&] {
                if (held_.size() == stream_.buffer_) {
                    count_path(Path::stream_helper_full);
                    stream_.hand_over(share_, held_, false);
                }
                return stream_.buffer_ - held_.size();
            };
            put_in_parts(pairs, room,
                         [&](std::span<const Pair> part) { held_.insert(held_.end(), part.begin(), part.end()); });
        }
        void finish() { stream_.hand_over(share_, held_, true); }

    private:
        OrderedStream& stream_;
        std::size_t share_;
        std::vector<Pair>& held_;
    };

    Slot& slot(std::size_t share) { return slots_[share % slots_.size()]; }

    /// Returns nothing if all shares that may run now have begun.
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

    /// Delivers the ready pairs of the head. Advances the head if its share is finished. Returns false if nothing is ready
    /// and `wait` is false.
    bool hand_out(const PairSink& deliver, bool wait) {
        {
            std::unique_lock lock(mutex_);
            Slot& head_slot = slot(head_);
            const auto is_ready = [&] { return head_slot.finished || !head_slot.ready.empty(); };
            if (wait) changed_.wait(lock, [&] { return failed_ || is_ready(); });
            if (failed_) throw Abandoned{};
            if (!is_ready()) return false;
            taken_.swap(head_slot.ready);
            if (std::exchange(head_slot.finished, false)) ++head_;
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
    std::vector<Pair> lead_held_, taken_;  // used only by the calling thread
    std::size_t next_ = 0;                 // first share that has not begun
    std::size_t head_ = 0;                 // share to deliver next; only the calling thread changes it
    bool failed_ = false;
    std::exception_ptr failure_;
};

class StreamExecutor final : public TeamExecutor {
public:
    StreamExecutor(Team& team, const StreamTo& to) : TeamExecutor(team), to_(to) {}
    void for_each_writing(std::size_t count, const Body& body) override {
        const std::size_t ahead = std::size_t(width()) * tuning().output.shares_ahead;
        // Each share that runs ahead has two buffers: one being filled, one ready. The calling thread has two more: that of its own share, and
        // the one that it delivers.
        const std::size_t buffer = std::max<std::size_t>(1, std::size_t(to_.buffer_pairs / (2 * ahead + 2)));
        OrderedStream stream(count, body, ahead, buffer);
        stream.on_failure = [&] { to_.abandon.request_stop(); };
        team().with_helpers([&] { stream.lead(to_.deliver); }, [&] { stream.help(); });
    }

private:
    StreamTo to_;
};

}  // namespace

void stream_pairs(Team& team, const StreamTo& to, const FindPairs& find) {
    StreamExecutor executor(team, to);
    find(executor);
}

}  // namespace octopair
