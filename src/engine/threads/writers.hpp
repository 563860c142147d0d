// Executors of the local engine. They run shares on the threads of a team and count, list or stream the pairs.
//
// Each executor keeps the guarantee of executor.hpp: lists and streams have their pairs in the order of the shares, whatever
// thread ran them.
#pragma once

#include <atomic>
#include <exception>
#include <functional>
#include <span>
#include <stop_token>
#include <vector>

#include "base/private_export.hpp"
#include "engine/pair_list.hpp"
#include "octree/executor.hpp"
#include "parallel/team.hpp"

namespace octopair {

/// Base class of writers that process each pair, not only the number of pairs.
class OCTOPAIR_PRIVATE_EXPORT FullWriter : public ShareWriter {
public:
    bool counting() const final { return false; }
    void write_count(std::uint64_t) final;
};

/// Adds the number of pairs with object i as `a` to counts[i].
/// Thread safety: several writers may share `counts`, also in shared memory; the additions are atomic.
class CountByObjectWriter final : public FullWriter {
public:
    explicit CountByObjectWriter(std::span<std::uint32_t> counts) : counts_(counts) {}
    void write(std::span<const Pair> pairs) override;

private:
    std::span<std::uint32_t> counts_;
};

/// Runs steps that write no pairs. Derived classes run steps that write pairs.
class OCTOPAIR_PRIVATE_EXPORT TeamExecutor : public Executor {
public:
    explicit TeamExecutor(Team& team) : team_(team) {}
    unsigned width() const override { return team_.threads(); }
    void for_each(std::size_t count, const std::function<void(std::size_t)>& body) override;
    void for_each_writing(std::size_t count, const std::function<void(std::size_t, ShareWriter&)>& body) override;

protected:
    Team& team() { return team_; }

private:
    Team& team_;
};

/// Counts all pairs.
class CountExecutor final : public TeamExecutor {
public:
    using TeamExecutor::TeamExecutor;
    void for_each_writing(std::size_t count, const std::function<void(std::size_t, ShareWriter&)>& body) override;
    std::uint64_t pairs() const { return pairs_; }

private:
    std::atomic<std::uint64_t> pairs_ = 0;
};

/// Adds the number of pairs with object i as `a` to counts[i].
class CountByObjectExecutor final : public TeamExecutor {
public:
    CountByObjectExecutor(Team& team, std::span<std::uint32_t> counts) : TeamExecutor(team), counts_(counts) {}
    void for_each_writing(std::size_t count, const std::function<void(std::size_t, ShareWriter&)>& body) override;

private:
    std::span<std::uint32_t> counts_;
};

/// Appends the pairs to a list, in the order of the shares.
class ListExecutor final : public TeamExecutor {
public:
    ListExecutor(Team& team, detail::PairStorage& list);
    void for_each_writing(std::size_t count, const std::function<void(std::size_t, ShareWriter&)>& body) override;

private:
    class Writer;
    detail::PairStorage& list_;
    std::vector<std::span<Pair>> blocks_;  // for each thread: the free part of its current block
};

/// Passes pairs to a function on the calling thread, in the order of the shares. Buffers at most `buffer_pairs` pairs.
class StreamExecutor final : public TeamExecutor {
public:
    using Deliver = std::function<void(std::span<const Pair>)>;
    /// Requests a stop through `abandon` when the calling thread or a share fails, so that the other shares end soon.
    StreamExecutor(Team& team, Deliver deliver, std::uint64_t buffer_pairs, std::stop_source abandon);

    void for_each_writing(std::size_t count, const std::function<void(std::size_t, ShareWriter&)>& body) override;

private:
    Deliver deliver_;
    std::uint64_t buffer_pairs_;
    std::stop_source abandon_;
};

}  // namespace octopair
