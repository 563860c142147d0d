#include "verification/row_pass.hpp"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <utility>
#include <vector>

#include "base/stop.hpp"
#include "octopair/error.hpp"

namespace octopair {

void throw_verification_failed(const std::string& words) {
    throw Error(ErrorCode::engine_failed, "verification failed: " + words);
}

std::string name_of_pair(const Pair& pair) {
    return "pair (" + std::to_string(pair.a) + ", " + std::to_string(pair.b) + ")";
}

bool has_position(const RowSearch& rows, const Pair& pair) {
    return pair.a < rows.rows() && pair.b < rows.columns() && (rows.is_join() || pair.a < pair.b);
}

std::string fault_of_position(const RowSearch& rows, const Pair& pair) {
    if (pair.a >= rows.rows()) {
        return name_of_pair(pair) + ": a is not below " + std::to_string(rows.rows()) + ", the number of objects";
    }
    if (pair.b >= rows.columns()) {
        return name_of_pair(pair) + ": b is not below " + std::to_string(rows.columns()) + ", the number of objects";
    }
    return name_of_pair(pair) + ": a is not below b";
}

namespace {

/// Receives faults from several threads, and keeps the fault of the lowest row.
class LowestFault {
public:
    void report(std::uint64_t row, std::string fault) {
        const std::lock_guard lock(mutex_);
        if (row >= row_) return;
        row_ = row;
        fault_ = std::move(fault);
    }
    /// Exclusive upper bound of the rows whose faults count.
    std::uint64_t row() const { return row_.load(std::memory_order_relaxed); }
    ResultFault take() { return std::move(fault_); }

private:
    std::mutex mutex_;
    std::atomic<std::uint64_t> row_ = ~std::uint64_t(0);
    ResultFault fault_;
};

}  // namespace

RowPass::RowPass(const RowSearch& rows, Team& team, std::stop_token stop, const ProgressSink& progress)
    : rows_(rows), team_(team), stop_(std::move(stop)), progress_(progress) {}

ResultFault RowPass::run(const RowRange& range, Columns order, const Visit& visit) const {
    LowestFault lowest;
    std::vector<std::vector<std::uint32_t>> columns(team_.threads());
    const auto visit_block = [&](std::uint64_t begin, std::uint64_t end, std::vector<std::uint32_t>& row) {
        for (std::uint64_t a = begin; a < std::min(end, lowest.row()); ++a) {
            throw_if_stopped(stop_);
            order == Columns::ascending ? rows_.row(std::uint32_t(a), row) : rows_.unordered_row(std::uint32_t(a), row);
            if (ResultFault fault = visit(std::uint32_t(a), row)) lowest.report(a, std::move(*fault));
        }
    };
    const std::uint64_t wave_rows = std::uint64_t(range.block) * 64 * team_.threads();
    for (std::uint64_t begin = range.begin; begin < range.end; begin += wave_rows) {
        const std::uint64_t end = std::min<std::uint64_t>(range.end, begin + wave_rows);
        team_.for_each(std::size_t((end - begin + range.block - 1) / range.block), [&](std::size_t i, unsigned worker) {
            const std::uint64_t block = begin + i * range.block;
            visit_block(block, std::min(end, block + range.block), columns[worker]);
        });
        if (ResultFault fault = lowest.take()) return fault;
        if (progress_) progress_(double(end) / double(rows_.rows()));
    }
    return {};
}

}  // namespace octopair
