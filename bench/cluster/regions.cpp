#include "cluster/regions.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <utility>

#include "octopair/octal_code.hpp"

namespace octopair::cluster {

namespace {

/// Sends each box to a rank. Boxes that a rank receives are in the order of the sending ranks.
std::vector<Box3f> distributed(MPI_Comm comm, const std::vector<Box3f>& own, const std::vector<int>& to_rank) {
    int ranks = 0;
    MPI_Comm_size(comm, &ranks);
    MPI_Datatype box = MPI_DATATYPE_NULL;
    MPI_Type_contiguous(int(sizeof(Box3f)), MPI_BYTE, &box);
    MPI_Type_commit(&box);
    std::vector<int> sent(std::size_t(ranks), 0), received(std::size_t(ranks), 0);
    for (const int rank : to_rank) ++sent[std::size_t(rank)];
    MPI_Alltoall(sent.data(), 1, MPI_INT, received.data(), 1, MPI_INT, comm);
    std::vector<int> sent_begins(std::size_t(ranks), 0), received_begins(std::size_t(ranks), 0);
    std::exclusive_scan(sent.begin(), sent.end(), sent_begins.begin(), 0);
    std::exclusive_scan(received.begin(), received.end(), received_begins.begin(), 0);
    std::vector<Box3f> ordered(own.size());
    std::vector<int> next = sent_begins;
    for (std::size_t i = 0; i < own.size(); ++i) ordered[std::size_t(next[std::size_t(to_rank[i])]++)] = own[i];
    std::vector<Box3f> in(std::size_t(std::accumulate(received.begin(), received.end(), 0)));
    MPI_Alltoallv(ordered.data(), sent.data(), sent_begins.data(), box, in.data(), received.data(),
                  received_begins.data(), box, comm);
    MPI_Type_free(&box);
    return in;
}

std::array<float, 3> middle(const Box3f& box) {
    std::array<float, 3> at;
    for (std::size_t axis = 0; axis < 3; ++axis) at[axis] = (box.min[axis] + box.max[axis]) / 2;
    return at;
}

/// Returns the key of the octal code of a box's middle, in an octree of cubes.
std::uint64_t key(const Box3f& box) {
    std::array<std::uint32_t, 3> cell;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        constexpr auto cells = float(1u << OctalCode::max_level);
        cell[axis] = std::uint32_t(std::clamp(middle(box)[axis] * cells, 0.0f, cells - 1));
    }
    return OctalCode::from_cell(cell, OctalCode::max_level).key();
}

struct Keyed {
    std::uint64_t key;
    Box3f box;
};

/// Sorts boxes by their keys. Returns the keys.
std::vector<std::uint64_t> sort_by_key(std::vector<Box3f>& boxes) {
    std::vector<Keyed> keyed;
    for (const Box3f& box : boxes) keyed.push_back({key(box), box});
    std::ranges::sort(keyed, {}, &Keyed::key);
    std::ranges::transform(keyed, boxes.begin(), &Keyed::box);
    std::vector<std::uint64_t> keys(keyed.size());
    std::ranges::transform(keyed, keys.begin(), &Keyed::key);
    return keys;
}

}  // namespace

std::vector<Box3f> in_order_of_space(MPI_Comm comm, std::vector<Box3f> own) {
    int ranks = 0;
    MPI_Comm_size(comm, &ranks);
    const std::vector<std::uint64_t> keys = sort_by_key(own);
    // Each rank offers equally many keys. Their quantiles divide the curve.
    constexpr int samples = 1024;
    std::vector<std::uint64_t> offered(samples, 0), all(std::size_t(samples) * std::size_t(ranks));
    for (std::size_t i = 0; i < offered.size() && !own.empty(); ++i) offered[i] = keys[i * own.size() / samples];
    MPI_Allgather(offered.data(), samples, MPI_UINT64_T, all.data(), samples, MPI_UINT64_T, comm);
    std::ranges::sort(all);
    std::vector<int> to_rank;
    for (const std::uint64_t own_key : keys) {
        const auto before = std::size_t(std::ranges::upper_bound(all, own_key) - all.begin());
        to_rank.push_back(int(std::min(before / samples, std::size_t(ranks) - 1)));
    }
    own = distributed(comm, own, to_rank);
    (void)sort_by_key(own);
    return own;
}

std::vector<Box3f> in_blocks(MPI_Comm comm, std::vector<Box3f> own) {
    int ranks = 0;
    MPI_Comm_size(comm, &ranks);
    std::array<int, 3> grid = {0, 0, 0};
    MPI_Dims_create(ranks, 3, grid.data());
    std::vector<int> to_rank;
    for (const Box3f& box : own) {
        int block = 0;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const int at = int(middle(box)[axis] * float(grid[axis]));
            block = block * grid[axis] + std::clamp(at, 0, grid[axis] - 1);
        }
        to_rank.push_back(block);
    }
    return distributed(comm, own, to_rank);
}

}  // namespace octopair::cluster
