// Executor: how the steps of the algorithm are shared out. The steps themselves know no threads.
//
// Shares are numbered; an executor may run them in any order and side by side, and hands each a place to put its pairs
// such that pairs end up in the order of the shares. It may run one again that ended half-way, and may be one of several
// in processes that all go through the same steps: then a share runs in one of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include "base/memory.hpp"
#include "octopair/objects.hpp"

namespace octopair {

class Executor;

/// Where one share's pairs go, in order. One thread at a time.
class ShareWriter {
public:
    virtual ~ShareWriter() = default;
    /// The rows may be counted only: then write_count is called in place of write.
    virtual bool counting() const = 0;
    virtual void write(std::span<const Pair> pairs) = 0;
    virtual void write_count(std::uint64_t pairs) = 0;
};

/// Which executor builds an octree, and in which pages.
struct BuildPlace {
    Executor& executor;
    PageSource& pages;
    PageSource& scratch;  ///< for data that nobody reads after the sort
};

class Executor {
public:
    virtual ~Executor() = default;
    /// How many shares can run side by side.
    virtual unsigned width() const = 0;
    /// Calls body(i) for each i below `count`.
    virtual void for_each(std::size_t count, const std::function<void(std::size_t)>& body) = 0;
    /// The same, with pairs: those of share i come before those of share i + 1.
    virtual void for_each_writing(std::size_t count, const std::function<void(std::size_t, ShareWriter&)>& body) = 0;
    /// Returns where a scan with this executor builds a nested octree of `entries` entries: usually with this executor, in
    /// memory of this process. Processes that scan together must make the same calls, and get the same kind of place.
    /// The executor returned is valid until the next call.
    virtual BuildPlace build_place([[maybe_unused]] std::size_t entries) { return {*this, own_pages(), own_pages()}; }
};

/// For steps that write no pairs.
class NoPairs final : public ShareWriter {
public:
    bool counting() const override { return true; }
    void write(std::span<const Pair>) override {}
    void write_count(std::uint64_t) override {}
};

/// Runs all shares on the calling thread, pairs to one writer: how a share runs steps within itself.
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
