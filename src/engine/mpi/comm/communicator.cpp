#include "engine/mpi/comm/communicator.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <string>
#include <thread>

#include "octopair/error.hpp"

namespace octopair {

namespace {

constexpr int exchange_tag = 1;
constexpr int stop_tag = 2;
constexpr int heartbeat_tag = 3;

void check(int code) {
    if (code == MPI_SUCCESS) return;
    char text[MPI_MAX_ERROR_STRING];
    int length = 0;
    MPI_Error_string(code, text, &length);
    throw Error(ErrorCode::engine_failed, "MPI: " + std::string(text, std::size_t(length)));
}

class MpiTimer {
public:
    explicit MpiTimer(Traffic& traffic) : traffic_(traffic) {}
    MpiTimer(const MpiTimer&) = delete;
    MpiTimer& operator=(const MpiTimer&) = delete;
    ~MpiTimer() { traffic_.cpu_seconds += thread_seconds() - begin_; }

private:
    Traffic& traffic_;
    double begin_ = thread_seconds();
};

bool is_running() {
    int begun = 0, ended = 0;
    MPI_Initialized(&begun);
    MPI_Finalized(&ended);
    return begun != 0 && ended == 0;
}

}  // namespace

Communicator::Communicator(MPI_Comm comm, std::size_t message_bytes) : message_bytes_(message_bytes) {
    if (!is_running()) throw Error(ErrorCode::usage, "an MPI engine is made after MPI_Init and before MPI_Finalize");
    if (comm == MPI_COMM_NULL) throw Error(ErrorCode::usage, "no engine can be made on MPI_COMM_NULL");
    check(MPI_Comm_dup(comm, &comm_));
    check(MPI_Comm_set_errhandler(comm_, MPI_ERRORS_RETURN));
    int rank = 0, size = 0, level = 0;
    check(MPI_Comm_rank(comm_, &rank));
    check(MPI_Comm_size(comm_, &size));
    check(MPI_Query_thread(&level));
    rank_ = unsigned(rank);
    size_ = unsigned(size);
    any_thread_ = level == MPI_THREAD_MULTIPLE;
}

Communicator::~Communicator() {
    if (is_running()) MPI_Comm_free(&comm_);
}

void Communicator::count(std::uint64_t bytes, std::uint64_t messages) {
    traffic_.bytes += bytes;
    traffic_.messages += messages;
}

/// Polls, because MPI_Waitall cannot call the wait hook.
void Communicator::wait(std::span<MPI_Request> requests) {
    int done = 0;
    while (check(MPI_Testall(int(requests.size()), requests.data(), &done, MPI_STATUSES_IGNORE)), done == 0) {
        if (wait_hook_) wait_hook_();
        std::this_thread::yield();
    }
}

template <typename Run>
void Communicator::taped(std::span<std::byte> result, const Run& run) {
    if (replaying()) return tape_->give(result);
    run();
    if (tape_ != nullptr) tape_->take(result);
}

void Communicator::count_broadcast(std::uint64_t bytes) { count(bytes * (size_ - 1), std::bit_width(size_ - 1)); }

void Communicator::gather_equal(std::span<const std::byte> own, std::span<std::byte> all) {
    const MpiTimer counted(traffic_);
    taped(all, [&] {
        MPI_Request request = MPI_REQUEST_NULL;
        check(MPI_Iallgather(own.data(), int(own.size()), MPI_BYTE, all.data(), int(own.size()), MPI_BYTE, comm_,
                             &request));
        wait({&request, 1});
    });
    count_broadcast(own.size());
}

void Communicator::gather_parts(const Values& own, std::span<const std::size_t> begins, void* all) {
    const MpiTimer counted(traffic_);
    if (begins.back() > std::size_t(INT32_MAX))
        throw Error(ErrorCode::resource_limit, "more than 2^31 - 1 values to gather on all ranks");
    std::vector<int> counts(size_);
    for (unsigned r = 0; r < size_; ++r) counts[r] = int(begins[r + 1] - begins[r]);
    const std::vector<int> places(begins.begin(), begins.end() - 1);
    taped({static_cast<std::byte*>(all), begins.back() * own.item_bytes}, [&] {
        MPI_Datatype item = MPI_DATATYPE_NULL;
        check(MPI_Type_contiguous(int(own.item_bytes), MPI_BYTE, &item));
        check(MPI_Type_commit(&item));
        MPI_Request request = MPI_REQUEST_NULL;
        check(MPI_Iallgatherv(own.data, counts[rank_], item, all, counts.data(), places.data(), item, comm_, &request));
        check(MPI_Type_free(&item));  // the pending request keeps the type alive
        wait({&request, 1});
    });
    count_broadcast(std::uint64_t(counts[rank_]) * own.item_bytes);
}

template <typename T>
void Communicator::reduce(std::span<T> values, MPI_Datatype type, MPI_Op operation) {
    const MpiTimer counted(traffic_);
    for (std::span<T> left = values; !left.empty();) {
        const auto some = left.first(std::min(left.size(), std::max<std::size_t>(1, message_bytes_ / sizeof(T))));
        taped(std::as_writable_bytes(some), [&] {
            MPI_Request request = MPI_REQUEST_NULL;
            check(MPI_Iallreduce(MPI_IN_PLACE, some.data(), int(some.size()), type, operation, comm_, &request));
            wait({&request, 1});
        });
        count(2 * some.size_bytes() * (size_ - 1) / size_, 2 * std::bit_width(size_ - 1));
        left = left.subspan(some.size());
    }
}

template void Communicator::reduce(std::span<std::uint32_t> values, MPI_Datatype type, MPI_Op operation);
template void Communicator::reduce(std::span<std::uint64_t> values, MPI_Datatype type, MPI_Op operation);

void Communicator::broadcast_bytes(std::span<std::byte> bytes, unsigned from) {
    const MpiTimer counted(traffic_);
    for (std::span<std::byte> left = bytes; !left.empty();) {
        const auto some = left.first(std::min(left.size(), message_bytes_));
        taped(some, [&] {
            MPI_Request request = MPI_REQUEST_NULL;
            check(MPI_Ibcast(some.data(), int(some.size()), MPI_BYTE, int(from), comm_, &request));
            wait({&request, 1});
        });
        if (rank_ == from) count_broadcast(some.size());
        left = left.subspan(some.size());
    }
}

Exchange Communicator::plan_exchange(RankCounts sent) {
    const MpiTimer counted(traffic_);
    Exchange exchange{std::move(sent), RankCounts(size_)};
    taped(std::as_writable_bytes(std::span(exchange.received)), [&] {
        MPI_Request request = MPI_REQUEST_NULL;
        check(MPI_Ialltoall(exchange.sent.data(), 1, MPI_UINT64_T, exchange.received.data(), 1, MPI_UINT64_T, comm_,
                            &request));
        wait({&request, 1});
    });
    count(sizeof(std::uint64_t) * (size_ - 1), size_ - 1);
    return exchange;
}

namespace {

/// Returns the begin of each rank's part, then the end of the last part. In bytes.
std::vector<std::uint64_t> begins_of(const RankCounts& counts, std::size_t item_bytes) {
    std::vector<std::uint64_t> begins = {0};
    for (const std::uint64_t values : counts) begins.push_back(begins.back() + values * item_bytes);
    return begins;
}

}  // namespace

void Communicator::exchange_parts(const Values& out, void* in, const Exchange& counts) {
    const MpiTimer counted(traffic_);
    taped({static_cast<std::byte*>(in), counts.incoming() * out.item_bytes}, [&] { send_parts(out, in, counts); });
}

void Communicator::send_parts(const Values& out, void* in, const Exchange& counts) {
    const auto* const from = static_cast<const std::byte*>(out.data);
    auto* const to = static_cast<std::byte*>(in);
    const auto from_begins = begins_of(counts.sent, out.item_bytes),
               to_begins = begins_of(counts.received, out.item_bytes);
    std::vector<MPI_Request> requests;
    const auto length = [&](std::uint64_t at, std::uint64_t end) {
        return int(std::min<std::uint64_t>(message_bytes_, end - at));
    };
    // Messages of one rank arrive in the order in which they were sent. Each rank sends first to the ranks after it, so that
    // the ranks do not all send to the same rank at first.
    for (unsigned i = 1; i < size_; ++i) {
        const unsigned r = (rank_ + size_ - i) % size_;
        for (std::uint64_t at = to_begins[r]; at < to_begins[r + 1]; at += message_bytes_) {
            check(MPI_Irecv(to + at, length(at, to_begins[r + 1]), MPI_BYTE, int(r), exchange_tag, comm_,
                            &requests.emplace_back()));
        }
    }
    for (unsigned i = 1; i < size_; ++i) {
        const unsigned r = (rank_ + i) % size_;
        for (std::uint64_t at = from_begins[r]; at < from_begins[r + 1]; at += message_bytes_) {
            const int bytes = length(at, from_begins[r + 1]);
            check(MPI_Isend(from + at, bytes, MPI_BYTE, int(r), exchange_tag, comm_, &requests.emplace_back()));
            count(std::uint64_t(bytes), 1);
        }
    }
    if (counts.sent[rank_] > 0) {
        std::memcpy(to + to_begins[rank_], from + from_begins[rank_], std::size_t(counts.sent[rank_]) * out.item_bytes);
    }
    wait(requests);
}

void Communicator::send_stop() {
    stops_.clear();
    stops_.reserve(size_);
    for (unsigned r = 0; r < size_; ++r) {
        if (r != rank_) check(MPI_Isend(nullptr, 0, MPI_BYTE, int(r), stop_tag, comm_, &stops_.emplace_back()));
    }
}

bool Communicator::stop_has_come() {
    if (replaying()) return false;
    int there = 0;
    check(MPI_Iprobe(MPI_ANY_SOURCE, stop_tag, comm_, &there, MPI_STATUS_IGNORE));
    return there != 0;
}

void Communicator::receive_stop(unsigned from) {
    check(MPI_Recv(nullptr, 0, MPI_BYTE, int(from), stop_tag, comm_, MPI_STATUS_IGNORE));
}

void Communicator::finish_stop() {
    wait(stops_);
    stops_.clear();
}

bool Communicator::send_heartbeat() {
    int gone = 0;
    check(MPI_Test(&heartbeat_, &gone, MPI_STATUS_IGNORE));
    if (gone == 0) return false;
    check(MPI_Isend(nullptr, 0, MPI_BYTE, 0, heartbeat_tag, comm_, &heartbeat_));
    return true;
}

std::optional<unsigned> Communicator::receive_heartbeat() {
    int there = 0;
    MPI_Status status{};
    check(MPI_Iprobe(MPI_ANY_SOURCE, heartbeat_tag, comm_, &there, &status));
    if (there == 0) return {};
    check(MPI_Recv(nullptr, 0, MPI_BYTE, status.MPI_SOURCE, heartbeat_tag, comm_, MPI_STATUS_IGNORE));
    return unsigned(status.MPI_SOURCE);
}

}  // namespace octopair
