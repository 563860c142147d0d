#include "engine/mpi/partition/object_exchange.hpp"

#include <cstring>
#include <numeric>

#include "base/test_hooks.hpp"

namespace octopair {

ObjectExchange::ObjectExchange(Communicator& comm, const JointCall& call, const Routing& routing, unsigned set)
    : comm_(comm), call_(call), routing_(routing), set_(set), counts_(comm.plan_exchange(routing.counts(set))) {
    if (call.indexed) return;
    const std::uint64_t position_bytes =
        routing.are_positions_near(set) ? sizeof(std::uint16_t) : sizeof(std::uint32_t);
    senders_ = comm.all_gather(Sender{call.begins[set], position_bytes});
}

void ObjectExchange::pack(Executor& executor, const Objects& objects, Memory& memory) const {
    const unsigned own = comm_.rank();
    for (ObjectArrays* arrays : {&memory.sent, &memory.received}) {
        arrays->wide = call_.wide[set_];
        arrays->padded = call_.padded[set_];
        arrays->indexed = call_.indexed;
    }
    if (!call_.indexed) {
        const bool near = senders_[own].position_bytes == sizeof(std::uint16_t);
        count_path(near ? Path::positions_near : Path::positions_far);
    }
    memory.sent.near = !call_.indexed && senders_[own].position_bytes == sizeof(std::uint16_t);
    memory.sent.resize(std::accumulate(counts_.sent.begin(), counts_.sent.end(), std::size_t(0)));
    memory.received.resize(counts_.incoming());
    const auto own_place = std::accumulate(counts_.received.begin(), counts_.received.begin() + own, std::size_t(0));
    routing_.pack(executor, set_, objects, {own, memory.sent, memory.received, own_place});
    if (call_.indexed) return;
    std::size_t bytes = 0;
    for (unsigned rank = 0; rank < comm_.size(); ++rank)
        bytes += counts_.received[rank] * senders_[rank].position_bytes;
    memory.positions.resize_discard(bytes);
}

void ObjectExchange::exchange(Memory& memory) const {
    Exchange others = counts_;
    others.sent[comm_.rank()] = 0;  // pack() copied these boxes to their place
    exchange_objects(comm_, memory.sent.view(), memory.received, others);
    if (call_.indexed) return comm_.exchange(memory.sent.indices.data(), memory.received.indices.data(), counts_);
    Exchange bytes = counts_;
    for (unsigned rank = 0; rank < comm_.size(); ++rank) {
        bytes.sent[rank] *= senders_[comm_.rank()].position_bytes;
        bytes.received[rank] *= senders_[rank].position_bytes;
    }
    const auto sent = memory.sent.near ? std::as_bytes(memory.sent.near_positions.span())
                                       : std::as_bytes(memory.sent.positions.span());
    comm_.exchange(sent.data(), memory.positions.data(), bytes);
    decode_positions(memory);
}

void ObjectExchange::decode_positions(Memory& memory) const {
    std::uint32_t* out = memory.received.positions.data();
    const std::byte* in = memory.positions.data();
    for (unsigned rank = 0; rank < comm_.size(); ++rank) {
        const auto count = std::size_t(counts_.received[rank]);
        if (senders_[rank].position_bytes == sizeof(std::uint16_t)) {
            auto position = std::uint32_t(senders_[rank].begin);
            for (std::size_t i = 0; i < count; ++i) {
                std::uint16_t low = 0;
                std::memcpy(&low, in + i * sizeof low, sizeof low);
                position = Routing::position_after(position, low);
                out[i] = position;
            }
        } else if (count > 0) {
            std::memcpy(out, in, count * sizeof *out);
        }
        out += count;
        in += count * senders_[rank].position_bytes;
    }
}

}  // namespace octopair
