#include "engine/mpi/order/index_order.hpp"

#include <algorithm>
#include <numeric>
#include <string>
#include <vector>

#include "engine/mpi/comm/agreement.hpp"
#include "engine/mpi/order/even_runs.hpp"
#include "octopair/error.hpp"

namespace octopair {

namespace {

/// Returns the permutation that sorts `indices`.
std::vector<std::uint32_t> order_of(std::span<const std::uint64_t> indices) {
    std::vector<std::uint32_t> order(indices.size());
    std::iota(order.begin(), order.end(), 0u);
    std::ranges::sort(order, {}, [&](std::uint32_t i) { return indices[i]; });
    return order;
}

/// Fills `to` with `objects` and their indices, permuted by `order`.
void arrange(const Objects& objects, std::span<const std::uint64_t> indices, std::span<const std::uint32_t> order,
             ObjectArrays& to) {
    to.resize(order.size());
    to.copying(objects, [&](const auto& copy) {
        for (std::size_t i = 0; i < order.size(); ++i) {
            copy(i, order[i]);
            to.indices[i] = indices[order[i]];
        }
    });
}

}  // namespace

/// Collective. Returns whether the ranks pass indices; the same on all ranks.
bool IndexOrder::are_given(const Objects& own, std::span<const std::uint64_t> indices) {
    Agreement(comm_).together([&] {
        if (!indices.empty() && indices.size() != own.size()) {
            throw Error(ErrorCode::bad_input,
                        std::to_string(indices.size()) + " indices for " + std::to_string(own.size()) + " objects");
        }
    });
    const bool given = comm_.sum(indices.size()) > 0;
    Agreement(comm_).together([&] {
        if (given && indices.size() != own.size()) {
            throw Error(ErrorCode::usage, "no indices are given, but other ranks give indices");
        }
    });
    return given;
}

void IndexOrder::take(const JointCall& call, unsigned set, const Objects& own, std::span<const std::uint64_t> indices) {
    ObjectArrays& arrays = arrays_[set];
    arrays = {.wide = call.wide[set], .padded = call.padded[set], .indexed = true};
    if (are_given(own, indices)) {
        exchange_and_sort(arrays, own, indices);
        objects_[set] = arrays.view();
        return;
    }
    Agreement(comm_).together([&] { arrays.indices.resize_discard(std::size_t(call.sizes[set])); });
    std::iota(arrays.indices.data(), arrays.indices.data() + arrays.indices.size(), call.begins[set]);
    objects_[set] = own;
}

void IndexOrder::exchange_and_sort(ObjectArrays& arrays, const Objects& own, std::span<const std::uint64_t> indices) {
    Agreement agreement(comm_);
    ObjectArrays sent{.wide = arrays.wide, .padded = arrays.padded, .indexed = true};
    ObjectArrays received{.wide = arrays.wide, .padded = arrays.padded, .indexed = true};
    agreement.together([&] { arrange(own, indices, order_of(indices), sent); });
    const Exchange counts = comm_.plan_exchange(even_runs(comm_, sent.indices.span()));
    agreement.together([&] { received.resize(counts.incoming()); });
    exchange_objects(comm_, sent.view(), received, counts);
    comm_.exchange(sent.indices.data(), received.indices.data(), counts);
    agreement.together([&] {
        arrange(received.view(), received.indices.span(), order_of(received.indices.span()), arrays);
        const auto all = arrays.indices.span();
        const auto twice = std::ranges::adjacent_find(all);
        if (twice != all.end()) {
            throw Error(ErrorCode::bad_input, "index " + std::to_string(*twice) + " is given to two objects");
        }
    });
}

}  // namespace octopair
