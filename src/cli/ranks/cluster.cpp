#include "cli/ranks/cluster.hpp"

#include <fmt/format.h>
#include <mpi.h>

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <span>
#include <string_view>

#include "base/error_codes.hpp"
#include "cli/command/program_main.hpp"
#include "octopair/error.hpp"

namespace octopair::cli {

Cluster::Run::Run() {
    int level = 0;
    if (MPI_Init_thread(nullptr, nullptr, MPI_THREAD_MULTIPLE, &level) != MPI_SUCCESS || level < MPI_THREAD_FUNNELED)
        throw Error(ErrorCode::engine_failed, "cannot start MPI with support for threads (MPI_THREAD_FUNNELED)");
}

Cluster::Run::~Run() {
    if (std::uncaught_exceptions() > 0 && !ends_alike) {
        int rank = 0;
        MPI_Comm_rank(MPI_COMM_WORLD, &rank);
        std::fprintf(stderr, "%s: rank %d failed without the other ranks; all ranks are aborted\n", program_name, rank);
        abort(exit_status(ErrorCode::engine_failed));
    }
    MPI_Finalize();
}

void Cluster::abort(int status) {
    MPI_Abort(MPI_COMM_WORLD, status);
    std::abort();  // MPI_Abort is not declared [[noreturn]]
}

int Cluster::fail_together(const Error& error) {
    if (first()) (void)fail(error);
    // Without this barrier, mpirun may kill the first rank in the middle of its message when another rank exits.
    together([] {});
    return status_of(error.code());
}

void Cluster::together(const std::function<void()>& part) {
    joint([&] { Agreement(comm_).together(part); });
}

void Cluster::joint(const std::function<void()>& part) {
    try {
        part();
    } catch (...) {
        run_.ends_alike = true;
        throw;
    }
}

void Cluster::refuse_object(std::uint64_t position, const std::string& message) {
    throw BadObject{position, message, {}};
}

namespace {

const Fact* find_fact(const Facts& facts, std::string_view what) {
    const auto found = std::find_if(facts.begin(), facts.end(), [&](const Fact& fact) { return fact.what == what; });
    return found == facts.end() ? nullptr : &*found;
}

std::string shown(const Fact* fact) {
    if (fact == nullptr) return "not given";
    return fact->where.empty() ? fact->value : fmt::format("{} ({})", fact->value, fact->where);
}

void check_same(const Facts& first, const Facts& other, std::size_t rank) {
    const auto check = [&](const Fact& fact) {
        const Fact* const a = find_fact(first, fact.what);
        const Fact* const b = find_fact(other, fact.what);
        if (a != nullptr && b != nullptr && a->value == b->value) return;
        throw Error(ErrorCode::usage,
                    fmt::format("ranks 0 and {} differ in {}: {}, {}", rank, fact.what, shown(a), shown(b)));
    };
    for (const Fact& fact : first) check(fact);
    for (const Fact& fact : other) check(fact);
}

/// Throws: Error{usage} about the first fact of any rank that differs from the fact of the first rank. `of_ranks`: facts by rank.
void check_facts_agree(const std::vector<Facts>& of_ranks) {
    for (std::size_t rank = 1; rank < of_ranks.size(); ++rank) check_same(of_ranks[0], of_ranks[rank], rank);
}

/// Encodes facts as bytes, to send them to other ranks. Requires: no text contains '\0'.
std::string packed(const Facts& facts) {
    std::string bytes;
    for (const Fact& fact : facts) {
        for (const std::string* text : {&fact.what, &fact.value, &fact.where}) bytes += *text + '\0';
    }
    return bytes;
}

/// Decodes the bytes that packed() returned.
Facts unpacked(const std::string& bytes) {
    Facts facts;
    std::size_t at = 0;
    const auto next = [&] {
        const std::size_t end = bytes.find('\0', at);
        std::string text = bytes.substr(at, end - at);
        at = end + 1;
        return text;
    };
    while (at < bytes.size()) {
        Fact fact{next(), next(), next()};
        facts.push_back(std::move(fact));
    }
    return facts;
}

}  // namespace

void Cluster::require_same(const Facts& own) {
    const std::string bytes = packed(own);
    const Gathered<char> all = comm_.all_gather(std::span<const char>(bytes));
    std::vector<Facts> of_ranks;
    of_ranks.reserve(ranks());
    for (unsigned rank = 0; rank < ranks(); ++rank)
        of_ranks.push_back(unpacked({all.values.begin() + std::ptrdiff_t(all.begins[rank]),
                                     all.values.begin() + std::ptrdiff_t(all.begins[rank + 1])}));
    joint([&] { check_facts_agree(of_ranks); });
}

std::string Cluster::broadcast_text(const std::string& text) {
    std::string told(comm_.all_gather(std::uint64_t(text.size())).front(), ' ');
    if (first()) told = text;
    comm_.broadcast(std::span(told), 0);
    return told;
}

namespace {

/// Copies the pairs of a list, batch by batch.
class ListReader {
public:
    explicit ListReader(const PairList& list) : chunks_(list.chunks()) {}

    void read(std::span<Pair> out) {
        while (!out.empty()) {
            if (taken_ == chunks_.front().size()) {
                chunks_ = chunks_.subspan(1);
                taken_ = 0;
                continue;
            }
            const auto part =
                chunks_.front().subspan(taken_).first(std::min(out.size(), chunks_.front().size() - taken_));
            std::copy(part.begin(), part.end(), out.begin());
            out = out.subspan(part.size());
            taken_ += part.size();
        }
    }

private:
    std::span<const std::span<const Pair>> chunks_;
    std::size_t taken_ = 0;  // number of pairs already copied from the first chunk
};

}  // namespace

void Cluster::relay(const PairList& piece, const std::function<void(std::span<const Pair>)>& take) {
    constexpr std::uint64_t most = 1 << 20;  // pairs per message
    together([&] {
        for (const auto chunk : piece.chunks()) {
            if (first()) take(chunk);
        }
    });
    const std::vector<std::uint64_t> sizes = comm_.all_gather(piece.size());
    ListReader reader(piece);
    std::vector<Pair> some;
    for (unsigned from = 1; from < ranks(); ++from) {
        for (std::uint64_t left = sizes[from]; left > 0;) {
            const std::uint64_t count = std::min(left, most);
            together([&] {
                if (first() || rank() == from) some.resize(std::size_t(count));
                if (rank() == from) reader.read(some);
            });
            send_to_first(from, std::span<const Pair>(some), std::span(some));
            together([&] {
                if (first()) take(some);
            });
            left -= count;
        }
    }
}

}  // namespace octopair::cli
