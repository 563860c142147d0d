// An MPI program that uses an installed octopair on its ranks.
#include <octopair/mpi.hpp>

#include <cstdio>

int main(int argc, char** argv) {
    int level = 0;
    MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &level);
    int rank = 0, ranks = 0;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &ranks);
    std::uint64_t pairs = 0;
    {
        // A row of boxes, each of which touches the next.
        std::vector<octopair::Box3f> own;
        for (int i = 0; i < 1000; ++i) {
            const float at = float(rank * 1000 + i);
            own.push_back({{at, 0, 0}, {at + 1, 1, 1}});
        }
        const auto engine = octopair::make_mpi_engine(MPI_COMM_WORLD);
        octopair::PairList piece;
        const octopair::Objects objects{std::span<const octopair::Box3f>(own)};
        pairs = engine->find_pairs(objects, piece).pairs;
        if (rank == 0) std::printf("%llu pairs\n", static_cast<unsigned long long>(pairs));
    }
    MPI_Finalize();
    return pairs == std::uint64_t(ranks) * 1000 - 1 ? 0 : 1;
}
