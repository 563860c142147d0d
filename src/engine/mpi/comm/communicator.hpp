// Communicator: typed wrapper of the MPI functions that the engine uses. Counts all traffic.
// CostMeter: measures the processor time of a rank outside MPI. Backoff: pauses a rank between two probes for messages.
//
// Calls      functions that send or receive are collective, unless their comment says otherwise: all ranks call them, in the
//            same order.
// Data       bytes of trivially copyable values, so all ranks must run on machines of one kind. Counts are 64 bit. A part that
//            is longer than `max_message_bytes` is sent as several messages.
// Errors     a failure of MPI throws Error{engine_failed}.
#pragma once

#include <mpi.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <ctime>
#include <functional>
#include <numeric>
#include <optional>
#include <span>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

#include "engine/mpi/comm/message_tape.hpp"

namespace octopair {

/// Bytes and messages that one rank has sent to other ranks. MPI does not tell how it implements its collective functions, so the counts
/// assume usual algorithms. Data for all ranks counts once for each other rank, in about log2(ranks) messages. A sum of n bytes counts as
/// 2 n (ranks - 1) / ranks bytes, in twice as many messages.
struct Traffic {
    std::uint64_t bytes = 0, messages = 0;
    double cpu_seconds = 0;  ///< processor time of the calling thread within MPI
};

/// Number of values that are sent to each rank, or received from each rank. Indexed by rank.
using RankCounts = std::vector<std::uint64_t>;

/// Number of values that a rank sends to each rank, and receives from each rank.
struct Exchange {
    RankCounts sent, received;

    std::size_t incoming() const {
        return std::size_t(std::accumulate(received.begin(), received.end(), std::uint64_t(0)));
    }
};

/// Values of all ranks, in rank order. The values of rank r begin at begins[r]; `begins` ends with the number of values.
template <typename T>
struct Gathered {
    std::vector<T> values;
    std::vector<std::size_t> begins;
};

class Communicator {
public:
    static constexpr std::size_t max_message_bytes = std::size_t(1) << 30;

    /// Works on a duplicate of `comm`, so its messages do not mix with those of the caller.
    /// Throws: Error{usage} before MPI_Init, after MPI_Finalize, and for MPI_COMM_NULL.
    explicit Communicator(MPI_Comm comm, std::size_t message_bytes = max_message_bytes);
    Communicator(const Communicator&) = delete;
    Communicator& operator=(const Communicator&) = delete;
    ~Communicator();

    unsigned rank() const { return rank_; }
    unsigned size() const { return size_; }
    /// Returns whether any thread may call MPI at any time (MPI_THREAD_MULTIPLE).
    bool any_thread() const { return any_thread_; }
    const Traffic& traffic() const { return traffic_; }

    /// Sets a function that is called repeatedly while another function waits for other ranks; may be empty.
    void set_wait_hook(std::function<void()> hook) { wait_hook_ = std::move(hook); }
    /// Sets the tape that records or replays results. Borrowed; null: none.
    void set_tape(MessageTape* tape) { tape_ = tape; }

    /// Returns one value of each rank.
    template <typename T>
    std::vector<T> all_gather(const T& own) {
        std::vector<T> all(size_);
        gather_equal(std::as_bytes(std::span(&own, 1)), std::as_writable_bytes(std::span(all)));
        return all;
    }
    /// Returns the values of all ranks. The ranks may pass different numbers of values.
    /// Throws: Error{resource_limit} for 2^31 values or more in total.
    template <typename T>
    Gathered<T> all_gather(std::span<const T> own) {
        Gathered<T> all;
        all.begins = {0};
        for (const std::uint64_t count : all_gather(std::uint64_t(own.size())))
            all.begins.push_back(all.begins.back() + std::size_t(count));
        all.values.resize(all.begins.back());
        const std::span<const std::byte> bytes = std::as_bytes(own);
        gather_parts({bytes.data(), sizeof(T)}, all.begins, all.values.data());
        return all;
    }
    /// Replaces each value by its sum over all ranks. Requires: the same number of values on all ranks.
    void add_up(std::span<std::uint64_t> values) { reduce(values, MPI_UINT64_T, MPI_SUM); }
    void add_up(std::span<std::uint32_t> values) { reduce(values, MPI_UINT32_T, MPI_SUM); }
    /// Replaces each value by its maximum over all ranks. Requires: the same number of values on all ranks.
    void take_largest(std::span<std::uint64_t> values) { reduce(values, MPI_UINT64_T, MPI_MAX); }
    std::uint64_t sum(std::uint64_t value) {
        add_up({&value, 1});
        return value;
    }
    /// Copies `values` of rank `from` to all ranks. Requires: the same number of values on all ranks.
    template <typename T>
    void broadcast(std::span<T> values, unsigned from) {
        broadcast_bytes(std::as_writable_bytes(values), from);
    }
    /// Returns the counts of an exchange in which this rank sends sent[r] values to each rank r.
    Exchange plan_exchange(RankCounts sent);
    /// Sends the first counts.sent[0] values of `out` to rank 0, the next counts.sent[1] to rank 1, and so on. Stores the
    /// received values in `in`, in rank order. Requires: `in` has room for counts.incoming() values.
    template <typename T>
    void exchange(const T* out, T* in, const Exchange& counts) {
        static_assert(std::is_trivially_copyable_v<T>);
        exchange_parts({out, sizeof(T)}, in, counts);
    }

    /// Not collective. Starts to send a message without content to all other ranks.
    void send_stop();
    /// Not collective. Waits until the messages of send_stop() are sent.
    void finish_stop();
    /// Not collective. Returns whether a stop message has arrived that is not yet received.
    bool stop_has_come();
    /// Not collective. Waits for the stop message of rank `from` and receives it.
    void receive_stop(unsigned from);

    /// Not collective. Starts to send a message without content to rank 0. Returns false, and sends nothing, while the previous
    /// heartbeat is in flight. Requires: this rank is not rank 0.
    bool send_heartbeat();
    /// Not collective. Receives one heartbeat and returns its sender; none if no heartbeat has arrived. Requires: rank 0.
    std::optional<unsigned> receive_heartbeat();

private:
    struct Values {
        const void* data;
        std::size_t item_bytes;
    };
    void gather_equal(std::span<const std::byte> own, std::span<std::byte> all);
    void gather_parts(const Values& own, std::span<const std::size_t> begins, void* all);
    template <typename T>
    void reduce(std::span<T> values, MPI_Datatype type, MPI_Op operation);
    void broadcast_bytes(std::span<std::byte> bytes, unsigned from);
    void exchange_parts(const Values& out, void* in, const Exchange& counts);
    void send_parts(const Values& out, void* in, const Exchange& counts);
    void count(std::uint64_t bytes, std::uint64_t messages);
    void count_broadcast(std::uint64_t bytes);
    void wait(std::span<MPI_Request> requests);
    /// Calls `run`, which fills `result`, and records the result on the tape. While the tape replays, reads `result` from it.
    template <typename Run>
    void taped(std::span<std::byte> result, const Run& run);
    bool replaying() const { return tape_ != nullptr && tape_->replaying(); }

    MPI_Comm comm_ = MPI_COMM_NULL;
    unsigned rank_ = 0, size_ = 1;
    bool any_thread_ = false;
    std::size_t message_bytes_;
    Traffic traffic_;
    std::function<void()> wait_hook_;
    std::vector<MPI_Request> stops_;
    MessageTape* tape_ = nullptr;
    MPI_Request heartbeat_ = MPI_REQUEST_NULL;
};

/// Returns the processor time of this thread.
inline double thread_seconds() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return double(now.tv_sec) + double(now.tv_nsec) * 1e-9;
}

/// Adds the processor time of its scope on this rank, without the time spent within MPI, to `seconds`; also if an exception leaves the
/// scope. Processor time is used, because wall-clock time is meaningless with fewer cores than ranks.
class CostMeter {
public:
    CostMeter(const Communicator& comm, double& seconds) : comm_(comm), seconds_(seconds) {}
    CostMeter(const CostMeter&) = delete;
    CostMeter& operator=(const CostMeter&) = delete;
    ~CostMeter() { seconds_ += outside_mpi() - begin_; }

private:
    double outside_mpi() const { return thread_seconds() - comm_.traffic().cpu_seconds; }

    const Communicator& comm_;
    double& seconds_;
    double begin_ = outside_mpi();
};

/// Pauses a rank that waits for messages and must probe for them. A pause grows with the time since the backoff was made, up to 5 ms, a
/// delay that a person does not notice. In the first millisecond it only yields the processor.
class Backoff {
public:
    void operator()() const {
        constexpr std::chrono::milliseconds awake(1), longest(5);
        const auto waited = std::chrono::steady_clock::now() - begun_;
        if (waited <= awake) return std::this_thread::yield();
        std::this_thread::sleep_for(std::min<std::chrono::nanoseconds>(waited / 8, longest));
    }

private:
    std::chrono::steady_clock::time_point begun_ = std::chrono::steady_clock::now();
};

}  // namespace octopair
