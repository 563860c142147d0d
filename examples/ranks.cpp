// MPI program whose ranks each have some of the objects: `mpirun -n 3 ranks`.
#include <octopair/mpi.hpp>
#include <octopair/octopair.hpp>

#include <cstdio>
#include <span>
#include <vector>

namespace {

/// Returns three boxes in a row for each rank. Each box touches the next, also from rank to rank.
std::vector<octopair::Box3f> own_boxes(int rank) {
    std::vector<octopair::Box3f> boxes;
    for (int i = 3 * rank; i < 3 * rank + 3; ++i) boxes.push_back({{float(i), 0, 0}, {float(i) + 1, 1, 1}});
    return boxes;
}

void find_together(int rank) {
    const std::vector<octopair::Box3f> boxes = own_boxes(rank);
    const auto engine = octopair::make_mpi_engine(MPI_COMM_WORLD);  // call on all ranks; destroy before MPI_Finalize
    octopair::PairList pairs;
    const octopair::Summary summary = engine->find_pairs({std::span(boxes)}, pairs);
    // Each rank has a part of the pairs. Most programs continue with the parts, without gather_pairs().
    octopair::gather_pairs(*engine, pairs);
    if (rank != 0) return;
    std::printf("%llu pairs:", static_cast<unsigned long long>(summary.pairs));
    for (const auto [a, b] : pairs.to_vector()) std::printf(" %u and %u", a, b);
    std::printf("\n");
}

}  // namespace

int main(int argc, char** argv) {
    int threads = 0, rank = 0, status = 0;
    MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &threads);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    try {
        find_together(rank);
    } catch (const octopair::Error& error) {  // all ranks get the same error
        if (rank == 0) std::fprintf(stderr, "%s\n", error.what());
        status = 1;
    }
    MPI_Finalize();
    return status;
}
