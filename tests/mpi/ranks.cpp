#include "mpi/ranks.hpp"

namespace octopair::test {

SliceBounds own_slice(std::size_t objects, Spread spread) {
    const std::size_t ranks = rank_count(), rank = own_rank();
    if (spread == Spread::even) return {objects * rank / ranks, objects * (rank + 1) / ranks};
    if (spread == Spread::all_on_last) return {rank + 1 == ranks ? 0 : objects, objects};
    // Half of the objects on rank 0, none on rank 1, and so on with the remaining objects.
    std::size_t begin = 0, end = 0;
    for (std::size_t r = 0; r <= rank; ++r) {
        begin = end;
        if (r % 2 == 0) end += (objects - end + 1) / 2;
    }
    return {begin, rank + 1 == ranks ? objects : end};
}

namespace {

OwnedObjects slice_of(const OwnedObjects& whole, Spread spread) {
    OwnedObjects own;
    if (const auto* const narrow = std::get_if<std::vector<Box3f>>(&whole.boxes)) own.boxes = slice(*narrow, spread);
    if (const auto* const wide = std::get_if<std::vector<Box3d>>(&whole.boxes)) own.boxes = slice(*wide, spread);
    own.padding = slice(whole.padding, spread);
    return own;
}

}  // namespace

Case slice(const Case& whole, Spread spread) {
    Case own = whole;
    own.first = slice_of(whole.first, spread);
    if (whole.second) own.second = slice_of(*whole.second, spread);
    return own;
}

std::vector<std::byte> all_bytes(std::span<const std::byte> own) {
    const int bytes = int(own.size());
    std::vector<int> sizes(rank_count()), places;
    MPI_Allgather(&bytes, 1, MPI_INT, sizes.data(), 1, MPI_INT, MPI_COMM_WORLD);
    int end = 0;
    for (const int size : sizes) {
        places.push_back(end);
        end += size;
    }
    std::vector<std::byte> all(static_cast<std::size_t>(end));
    MPI_Allgatherv(own.data(), bytes, MPI_BYTE, all.data(), sizes.data(), places.data(), MPI_BYTE, MPI_COMM_WORLD);
    return all;
}

bool on_all(bool own) {
    int good = own ? 1 : 0;
    MPI_Allreduce(MPI_IN_PLACE, &good, 1, MPI_INT, MPI_LAND, MPI_COMM_WORLD);
    return good != 0;
}

std::uint64_t largest(std::uint64_t own) {
    MPI_Allreduce(MPI_IN_PLACE, &own, 1, MPI_UINT64_T, MPI_MAX, MPI_COMM_WORLD);
    return own;
}

}  // namespace octopair::test
