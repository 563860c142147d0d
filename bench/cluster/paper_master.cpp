#include "cluster/paper_master.hpp"

#include <algorithm>
#include <ctime>
#include <numeric>
#include <type_traits>
#include <utility>

#include "baselines/paper_steps.hpp"

namespace octopair::cluster {

namespace {

using baselines::PaperEntry;
using baselines::PaperList;

double thread_seconds() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return double(now.tv_sec) + double(now.tv_nsec) * 1e-9;
}

/// Adds the processor time of its scope to `seconds`.
class Timer {
public:
    explicit Timer(double& seconds) : seconds_(seconds) {}
    Timer(const Timer&) = delete;
    Timer& operator=(const Timer&) = delete;
    ~Timer() { seconds_ += thread_seconds() - begin_; }

private:
    double& seconds_;
    double begin_ = thread_seconds();
};

/// A type of MPI for values of type T.
template <typename T>
class Datatype {
public:
    static_assert(std::is_trivially_copyable_v<T>);
    Datatype() {
        MPI_Type_contiguous(int(sizeof(T)), MPI_BYTE, &type_);
        MPI_Type_commit(&type_);
    }
    Datatype(const Datatype&) = delete;
    Datatype& operator=(const Datatype&) = delete;
    ~Datatype() { MPI_Type_free(&type_); }
    MPI_Datatype get() const { return type_; }

private:
    MPI_Datatype type_ = MPI_DATATYPE_NULL;
};

std::vector<int> begins_of(const std::vector<int>& lengths) {
    std::vector<int> begins(lengths.size(), 0);
    std::partial_sum(lengths.begin(), lengths.end() - 1, begins.begin() + 1);
    return begins;
}

/// Collective over `comm`. Returns the lists of all ranks on its first rank, and none elsewhere.
std::vector<PaperList> gather_lists(MPI_Comm comm, const PaperList& own) {
    int rank = 0, size = 1;
    MPI_Comm_rank(comm, &rank);
    MPI_Comm_size(comm, &size);
    const int count = int(own.size());
    std::vector<int> lengths(std::size_t(size), 0);
    MPI_Gather(&count, 1, MPI_INT, lengths.data(), 1, MPI_INT, 0, comm);
    PaperList all(std::size_t(std::accumulate(lengths.begin(), lengths.end(), 0)));
    const std::vector<int> begins = begins_of(lengths);
    const Datatype<PaperEntry> type;
    MPI_Gatherv(own.data(), count, type.get(), all.data(), lengths.data(), begins.data(), type.get(), 0, comm);
    std::vector<PaperList> lists;
    for (std::size_t i = 0; rank == 0 && i < lengths.size(); ++i) {
        const auto first = all.begin() + begins[i];
        lists.emplace_back(first, first + lengths[i]);
    }
    return lists;
}

}  // namespace

PaperMaster::PaperMaster(MPI_Comm comm, unsigned ranks_per_machine) : comm_(comm) {
    MPI_Comm_rank(comm, &rank_);
    MPI_Comm_size(comm, &size_);
    const int machine = rank_ / int(ranks_per_machine);
    MPI_Comm_split(comm, machine, rank_, &machine_);
    const bool leads = rank_ % int(ranks_per_machine) == 0;
    MPI_Comm_split(comm, leads ? 0 : MPI_UNDEFINED, rank_, &leaders_);
}

PaperMaster::~PaperMaster() {
    MPI_Comm_free(&machine_);
    if (leaders_ != MPI_COMM_NULL) MPI_Comm_free(&leaders_);
}

void PaperMaster::find_pairs(std::span<const Box3f> boxes) {
    costs_ = {};
    boxes_ = boxes;
    costs_.objects = boxes.size();
    deal_out();
    make_list();
    {
        const Timer timer(costs_.mpi);
        from_ranks_ = gather_lists(machine_, list_);
    }
    merge_machine();
    if (leaders_ != MPI_COMM_NULL) {
        const Timer timer(costs_.mpi);
        from_machines_ = gather_lists(leaders_, machine_list_);
    }
    const bool leads = leaders_ != MPI_COMM_NULL;
    if (!is_master()) {
        costs_.bytes_sent = (leads ? machine_list_ : list_).size() * sizeof(PaperEntry);
        costs_.messages_sent = 1;
    }
    merge_all();
    scan();
}

void PaperMaster::repeat_alone() {
    const Costs traffic = costs_;
    costs_ = {};
    costs_.objects = traffic.objects;
    costs_.objects_received = traffic.objects_received;
    if (is_master()) {
        const Timer timer(costs_.plan);
        octree_ = baselines::paper_octree(boxes_, 0);
    }
    make_list();
    merge_machine();
    merge_all();
    scan();
}

/// Gives each rank its run of the objects, and the octree.
void PaperMaster::deal_out() {
    if (is_master()) {
        const Timer timer(costs_.plan);
        octree_ = baselines::paper_octree(boxes_, 0);
    }
    const Timer timer(costs_.mpi);
    std::uint64_t objects = boxes_.size();
    MPI_Bcast(&objects, 1, MPI_UINT64_T, 0, comm_);
    MPI_Bcast(&octree_, int(sizeof octree_), MPI_BYTE, 0, comm_);
    std::vector<int> lengths;
    for (std::uint64_t rank = 0; rank < std::uint64_t(size_); ++rank) {
        lengths.push_back(int(objects * (rank + 1) / std::uint64_t(size_) - objects * rank / std::uint64_t(size_)));
    }
    const std::vector<int> begins = begins_of(lengths);
    const Datatype<Box3f> type;
    const std::size_t own = std::size_t(rank_);
    own_.resize(std::size_t(lengths[own]));
    first_index_ = std::uint32_t(begins[own]);
    MPI_Scatterv(boxes_.data(), lengths.data(), begins.data(), type.get(), own_.data(), lengths[own], type.get(), 0,
                 comm_);
    if (is_master()) {
        costs_.bytes_sent = (objects - own_.size()) * sizeof(Box3f);
        costs_.messages_sent = std::uint64_t(size_ - 1);
    } else {
        costs_.objects_received = own_.size();
    }
}

void PaperMaster::make_list() {
    const Timer timer(costs_.build);
    list_ = baselines::paper_codes({own_, first_index_}, octree_);
    baselines::sort_entries(list_, baselines::PaperSort::radix, octree_.level);
}

void PaperMaster::merge_machine() {
    if (leaders_ == MPI_COMM_NULL) return;
    std::vector<PaperList> lists = from_ranks_;  // kept for repeat_alone()
    const Timer timer(costs_.merge);
    machine_list_ = baselines::merge_paper_lists(std::move(lists));
}

void PaperMaster::merge_all() {
    if (!is_master()) return;
    std::vector<PaperList> lists = from_machines_;  // kept for repeat_alone()
    const Timer timer(costs_.merge);
    whole_list_ = baselines::merge_paper_lists(std::move(lists));
    entries_ = whole_list_.size();
}

void PaperMaster::scan() {
    if (!is_master()) return;
    const Timer timer(costs_.scan);
    std::uint64_t candidates = 0;
    pairs_ = baselines::scan_paper_list(whole_list_, boxes_, candidates);
}

}  // namespace octopair::cluster
