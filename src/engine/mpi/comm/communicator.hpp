// Communicator: what the engine asks of MPI, typed, with failures as Errors and every byte counted.
//
// Every function but rank() and size() is collective: all ranks call it, in the same order. What is sent are the bytes of
// trivially copyable values, so all ranks run on machines of one kind. Counts are 64 bit; a part that is longer than
// `most_message_bytes` goes as several messages.
#pragma once

#include <mpi.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <numeric>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "engine/mpi/comm/message_tape.hpp"

namespace octopair {

/// What one rank has sent to others. How MPI sends what all ranks take part in is its own affair; counted is what its usual
/// ways come to: what a rank tells all, once for each other rank, in log2 as many messages; a sum, twice.
struct Traffic {
    std::uint64_t bytes = 0, messages = 0;
    double cpu_seconds = 0;  ///< of the thread, within MPI
};

/// How many values go to each rank, or come from each, one rank's after another's.
using RankCounts = std::vector<std::uint64_t>;

/// How many values a rank sends to each, and receives from each.
struct Exchange {
    RankCounts sent, received;

    std::size_t incoming() const {
        return std::size_t(std::accumulate(received.begin(), received.end(), std::uint64_t(0)));
    }
};

/// What all ranks told, rank after rank; `begins` has one more than there are ranks.
template <typename T>
struct Gathered {
    std::vector<T> values;
    std::vector<std::size_t> begins;
};

class Communicator {
public:
    static constexpr std::size_t most_message_bytes = std::size_t(1) << 30;

    /// A duplicate of `comm`, which keeps its own. Throws Error{usage} outside MPI_Init and MPI_Finalize,
    /// Error{engine_failed}, as all functions do where MPI fails.
    explicit Communicator(MPI_Comm comm, std::size_t message_bytes = most_message_bytes);
    Communicator(const Communicator&) = delete;
    Communicator& operator=(const Communicator&) = delete;
    ~Communicator();

    unsigned rank() const { return rank_; }
    unsigned size() const { return size_; }
    /// Whether any thread may call, beside others of the program.
    bool any_thread() const { return any_thread_; }
    const Traffic& traffic() const { return traffic_; }

    /// What is done again and again while a function waits for other ranks; may be empty.
    void set_meanwhile(std::function<void()> meanwhile) { meanwhile_ = std::move(meanwhile); }
    /// Borrowed; null: none.
    void set_tape(MessageTape* tape) { tape_ = tape; }

    /// One value of each rank.
    template <typename T>
    std::vector<T> all_gather(const T& own) {
        std::vector<T> all(size_);
        gather_equal(std::as_bytes(std::span(&own, 1)), std::as_writable_bytes(std::span(all)));
        return all;
    }
    /// As many as each has; in all less than 2^31.
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
    /// Each value becomes the sum of all ranks'.
    void add_up(std::span<std::uint64_t> values);
    std::uint64_t sum(std::uint64_t value) {
        add_up({&value, 1});
        return value;
    }
    /// `values` of rank `from` come to all; their number is known to all.
    template <typename T>
    void broadcast(std::span<T> values, unsigned from) {
        broadcast_bytes(std::as_writable_bytes(values), from);
    }
    /// With sent[r] values for each rank r, learns how many come from each.
    Exchange plan_exchange(RankCounts sent);
    /// The first counts.sent[0] values of `out` go to rank 0, and so on; `in` has room for what comes.
    template <typename T>
    void exchange(const T* out, T* in, const Exchange& counts) {
        static_assert(std::is_trivially_copyable_v<T>);
        exchange_parts({out, sizeof(T)}, in, counts);
    }

    /// Not collective: a message without content goes to all others. finish_stop() waits until it has gone.
    void send_stop();
    void finish_stop();
    /// Whether one has come and was not received yet.
    bool stop_has_come();
    /// Waits for that of a rank.
    void receive_stop(unsigned from);

    /// Not collective: a message without content goes to rank 0, which is another one. False where the last one is still on
    /// its way.
    bool send_heartbeat();
    /// The rank that one has come from, if one has; on rank 0.
    std::optional<unsigned> receive_heartbeat();

private:
    struct Values {
        const void* data;
        std::size_t item_bytes;
    };
    void gather_equal(std::span<const std::byte> own, std::span<std::byte> all);
    void gather_parts(const Values& own, std::span<const std::size_t> begins, void* all);
    void broadcast_bytes(std::span<std::byte> bytes, unsigned from);
    void exchange_parts(const Values& out, void* in, const Exchange& counts);
    void send_parts(const Values& out, void* in, const Exchange& counts);
    void count(std::uint64_t bytes, std::uint64_t messages);
    void count_told(std::uint64_t bytes);
    void wait(std::span<MPI_Request> requests);
    /// Has `run` make `result`, unless the tape has it.
    template <typename Run>
    void taped(std::span<std::byte> result, const Run& run);
    bool replaying() const { return tape_ != nullptr && tape_->replaying(); }

    MPI_Comm comm_ = MPI_COMM_NULL;
    unsigned rank_ = 0, size_ = 1;
    bool any_thread_ = false;
    std::size_t message_bytes_;
    Traffic traffic_;
    std::function<void()> meanwhile_;
    std::vector<MPI_Request> stops_;
    MessageTape* tape_ = nullptr;
    MPI_Request heartbeat_ = MPI_REQUEST_NULL;
};

}  // namespace octopair
