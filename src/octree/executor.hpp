// Executor: runs the shares of a step of the algorithm. The steps themselves use no threads.
//
// Invariants
//   Shares are numbered. An executor may run them in any order and concurrently.
//   Pairs of share i come before those of share i + 1, whatever the order in which the shares run.
//   A share may be run again after its worker died, so bodies must be idempotent. (Counts by object are not: the whole pass is repeated.)
//   Executors in several processes may divide one step among them. All processes then make the same calls, and each share
//   runs in one of the processes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include "base/memory.hpp"
#include "base/private_export.hpp"
#include "octopair/objects.hpp"

namespace octopair {

class Executor;

/// Receives the pairs of one share, in order.
/// Thread safety: one thread at a time.
class OCTOPAIR_PRIVATE_EXPORT ShareWriter {
public:
    virtual ~ShareWriter() = default;
    /// True if pairs are counted only: the share then calls write_count in place of write.
    virtual bool counting() const = 0;
    /// Returns memory for `pairs` pairs, or an empty span. If the caller stores pairs from the begin of this memory on, and passes them to
    /// write(), write() need not copy them.
    virtual std::span<Pair> room([[maybe_unused]] std::size_t pairs) { return {}; }
    virtual void write(std::span<const Pair> pairs) = 0;
    virtual void write_count(std::uint64_t pairs) = 0;
};

/// The executor that builds an octree, and the pages that hold the octree.
struct BuildPlace {
    Executor& executor;
    PageSource& pages;
};

class OCTOPAIR_PRIVATE_EXPORT Executor {
public:
    virtual ~Executor() = default;
    /// Returns the number of shares that can run concurrently.
    virtual unsigned width() const = 0;
    /// Calls body(i) for each i in [0, count).
    virtual void for_each(std::size_t count, const std::function<void(std::size_t)>& body) = 0;
    /// Calls body(i, writer) for each i in [0, count), where `writer` receives the pairs of share i.
    virtual void for_each_writing(std::size_t count, const std::function<void(std::size_t, ShareWriter&)>& body) = 0;
    /// Returns where a scan with this executor builds a nested octree of `entries` entries. The default is this executor, with
    /// memory of this process. The returned executor is valid until the next call.
    /// Requires: processes that scan together make the same calls. They get the same kind of place.
    virtual BuildPlace build_place([[maybe_unused]] std::size_t entries) { return {*this, own_pages()}; }
};

/// Discards pairs: the writer for steps that write none.
class NoPairs final : public ShareWriter {
public:
    bool counting() const override { return true; }
    void write(std::span<const Pair>) override {}
    void write_count(std::uint64_t) override {}
};

/// Runs all shares on the calling thread and gives their pairs to one writer. A share that itself runs a divided step uses this executor.
class SerialExecutor final : public Executor {
public:
    explicit SerialExecutor(ShareWriter& writer) : writer_(writer) {}
    unsigned width() const override { return 1; }
    void for_each(std::size_t count, const std::function<void(std::size_t)>& body) override {
        for (std::size_t i = 0; i < count; ++i) body(i);
    }
    void for_each_writing(std::size_t count, const std::function<void(std::size_t, ShareWriter&)>& body) override {
        for (std::size_t i = 0; i < count; ++i) body(i, writer_);
    }

private:
    ShareWriter& writer_;
};

}  // namespace octopair
