// Helpers for the tests of the MPI engine. Each test runs on all ranks, and each rank has a slice of the same scene.
#pragma once

#include <gtest/gtest.h>
#include <mpi.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "octopair/mpi.hpp"
#include "support/cases.hpp"
#include "support/errors.hpp"

namespace octopair::test {

inline unsigned own_rank() {
    int rank = 0;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    return unsigned(rank);
}
inline unsigned rank_count() {
    int size = 0;
    MPI_Comm_size(MPI_COMM_WORLD, &size);
    return unsigned(size);
}

/// Distribution of objects over ranks.
enum class Spread : std::uint8_t { even, all_on_last, lopsided };
inline constexpr Spread spreads[] = {Spread::even, Spread::all_on_last, Spread::lopsided};
inline std::string name_of(Spread spread) {
    return spread == Spread::even ? "even" : spread == Spread::lopsided ? "lopsided" : "all on the last rank";
}

/// This rank owns the objects [begin, end).
struct SliceBounds {
    std::size_t begin, end;
};
SliceBounds own_slice(std::size_t objects, Spread spread);

template <typename Element>
std::vector<Element> slice(const std::vector<Element>& all, Spread spread) {
    if (all.empty()) return {};
    const SliceBounds own = own_slice(all.size(), spread);
    return {all.begin() + std::ptrdiff_t(own.begin), all.begin() + std::ptrdiff_t(own.end)};
}
/// Returns this rank's part of a case.
Case slice(const Case& whole, Spread spread);

std::vector<std::byte> all_bytes(std::span<const std::byte> own);
/// Returns the results of all ranks, in the order of ranks, on every rank.
template <typename AnyPair>
std::vector<AnyPair> all_pieces(const std::vector<AnyPair>& own) {
    const std::vector<std::byte> bytes = all_bytes(std::as_bytes(std::span(own)));
    std::vector<AnyPair> all(bytes.size() / sizeof(AnyPair));
    std::copy(bytes.begin(), bytes.end(), std::as_writable_bytes(std::span(all)).begin());
    return all;
}

/// Returns true on all ranks if `own` is true on all ranks.
bool on_all(bool own);
/// Returns the largest value of all ranks.
std::uint64_t largest(std::uint64_t own);

}  // namespace octopair::test
