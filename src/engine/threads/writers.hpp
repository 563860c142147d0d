// Executors of the local engine: the threads of a team, and what becomes of the pairs that shares write.
//
// Each keeps the promise of executor.hpp: pairs in the order of the shares, whatever thread ran them.
#pragma once

#include <atomic>
#include <exception>
#include <functional>
#include <span>
#include <stop_token>
#include <vector>

#include "engine/pair_list.hpp"
#include "octree/executor.hpp"
#include "parallel/team.hpp"

namespace octopair {

/// A writer that wants the pairs themselves.
class FullWriter : public ShareWriter {
public:
    bool counting() const final { return false; }
    void write_count(std::uint64_t) final;
};

/// Counts the pairs of each object as their `a`, together with other threads.
class CountByObjectWriter final : public FullWriter {
public:
    explicit CountByObjectWriter(std::span<std::uint32_t> counts) : counts_(counts) {}
    void write(std::span<const Pair> pairs) override;

private:
    std::span<std::uint32_t> counts_;
};

/// Steps without pairs.
class TeamExecutor : public Executor {
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

/// Counts pairs, all together.
class CountExecutor final : public TeamExecutor {
public:
    using TeamExecutor::TeamExecutor;
    void for_each_writing(std::size_t count, const std::function<void(std::size_t, ShareWriter&)>& body) override;
    std::uint64_t pairs() const { return pairs_; }

private:
    std::atomic<std::uint64_t> pairs_ = 0;
};

/// Counts the pairs of each object as their `a`.
class CountByObjectExecutor final : public TeamExecutor {
public:
    CountByObjectExecutor(Team& team, std::span<std::uint32_t> counts) : TeamExecutor(team), counts_(counts) {}
    void for_each_writing(std::size_t count, const std::function<void(std::size_t, ShareWriter&)>& body) override;

private:
    std::span<std::uint32_t> counts_;
};

/// Appends the pairs to a list as they come.
class ListExecutor final : public TeamExecutor {
public:
    ListExecutor(Team& team, detail::PairStorage& list);
    void for_each_writing(std::size_t count, const std::function<void(std::size_t, ShareWriter&)>& body) override;

private:
    class Writer;
    detail::PairStorage& list_;
    std::vector<std::span<Pair>> blocks_;  // each worker's: what is free of the block in its hands
};

/// Hands pairs to a function on the calling thread, as they come, holding at most `buffer_pairs`.
class StreamExecutor final : public TeamExecutor {
public:
    using Deliver = std::function<void(std::span<const Pair>)>;
    /// `abandon` is asked to stop when the calling thread or a share fails, so that the other shares end soon.
    StreamExecutor(Team& team, Deliver deliver, std::uint64_t buffer_pairs, std::stop_source abandon);

    void for_each_writing(std::size_t count, const std::function<void(std::size_t, ShareWriter&)>& body) override;

private:
    Deliver deliver_;
    std::uint64_t buffer_pairs_;
    std::stop_source abandon_;
};

}  // namespace octopair
