// ScenePublisher: passes the state of a running scene to its watchers, without delaying the scene.
//
// Invariants
//   The scene's thread copies its state only if a watcher waits for a step that the scene has done. Otherwise a step costs some
//   relaxed accesses of atomic numbers.
//   The scene's thread spends at most 1% of its time on copies: after a copy it makes none for 100 times the processor time of the
//   copy, and for at least 20 ms.
//   The scene's thread never waits for a watcher: another thread passes snapshots on.
//   At most `max_snapshots` snapshots of a scene exist. A watcher keeps a snapshot until it is sent.
//   An error during a copy reaches the watchers, not the scene.
#pragma once

#include <grpcpp/support/status.h>

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "base/memory.hpp"
#include "octopair/error.hpp"
#include "octopair/scene.hpp"
#include "service/server/jobs/budget.hpp"
#include "service/server/net/caller.hpp"

namespace octopair::v1 {
class SceneReport;
}  // namespace octopair::v1

namespace octopair::service {

/// Numbers of a step, and of the scene after it.
struct StepNumbers {
    std::uint64_t step = 0;  ///< the first step is 1; 0: no step yet
    std::uint64_t objects = 0;
    std::uint64_t pairs = 0;
    std::uint64_t began = 0;
    std::uint64_t ended = 0;
    double seconds = 0;
};

/// A copy of the state of a scene after a step, for the watchers of the scene. Not changed after it is made, so any thread may read it.
struct StepSnapshot {
    Budget::Reservation memory;
    StepNumbers numbers;
    Precision precision = Precision::float32;
    std::uint64_t indices = 0;
    std::uint64_t listed = 0;    ///< number of pairs in `data`
    std::uint64_t pairs_at = 0;  ///< offset of the first pair in `data`, in bytes
    Buffer<std::byte> data;      ///< presence, boxes and pairs, as in octopair.proto's SceneSnapshot

    /// Returns whether the snapshot has as many pairs as a watcher with this limit gets.
    bool lists(std::uint64_t pair_limit) const { return listed >= pair_limit || listed == numbers.pairs; }
};

class ResultReader;

/// A call that waits for a snapshot.
class SnapshotReceiver {
public:
    virtual ~SnapshotReceiver() = default;
    /// Receives a snapshot, or null and the reason why there is none. Requires: does not block and does not throw.
    virtual void receive(std::shared_ptr<const StepSnapshot> snapshot, const grpc::Status& failure) = 0;
};

/// Returns the error for a scene that does not exist, or that the caller does not see.
Error no_scene(const std::string& id);

class ScenePublisher {
public:
    using Clock = std::chrono::steady_clock;

    static constexpr std::size_t max_snapshots = 4;
    static constexpr std::chrono::milliseconds min_interval{20};
    /// After a copy, the next copy waits this many times the processor time of the copy. So copies take at most 1% of the time.
    static constexpr int intervals_per_copy = 100;

    /// The scene of a publisher.
    struct Description {
        std::string owner;
        Precision precision = Precision::float32;
        double margin = 0;
        /// Wakes the scene's thread if it waits for its client. Called until close().
        std::function<void()> wake;
    };
    struct Waiting {
        std::weak_ptr<SnapshotReceiver> receiver;
        std::uint64_t after_step = 0;  ///< the receiver wants the state after a step with a greater number
        std::uint64_t pair_limit = 0;  ///< maximum number of pairs that the receiver wants
    };
    /// Copies the scene's state, with at most `pair_limit` pairs.
    using Take = std::function<StepSnapshot(std::uint64_t pair_limit)>;

    /// `reader`: thread that passes snapshots on. Requires: `reader` outlives the publisher.
    ScenePublisher(Description scene, ResultReader& reader);
    ScenePublisher(const ScenePublisher&) = delete;
    ScenePublisher& operator=(const ScenePublisher&) = delete;

    const std::string& id() const { return id_; }
    const std::string& owner() const { return scene_.owner; }

    // For the scene's thread.

    /// Stores the numbers of the last step, for report().
    void note_step(const StepNumbers& numbers);
    /// Returns whether a watcher waits for the state after the last step. Thread safety: any thread may call it.
    bool is_wanted() const {
        return steps_.load(std::memory_order_relaxed) > wanted_after_.load(std::memory_order_relaxed);
    }
    /// Returns the time before which publish() must not be called.
    Clock::time_point next_time() const { return next_time_; }
    /// Calls `take`, and passes the snapshot to the watchers that wait for it.
    void publish(const Take& take) noexcept;
    /// Ends the scene: calls of watchers end with no_scene().
    void close() noexcept;

    // For any thread.

    /// Returns the numbers of the last step. While a step ends, some may be those of the step before. The owner is not set.
    v1::SceneReport report() const;
    /// Returns the latest snapshot if it fits `waiting`. Otherwise returns null, and the receiver later gets one snapshot or error.
    /// Throws: no_scene() after close().
    std::shared_ptr<const StepSnapshot> wait(Waiting waiting);
    /// Removes a receiver. No effect if it does not wait.
    void forget(const SnapshotReceiver& receiver);

private:
    using Receivers = std::vector<std::shared_ptr<SnapshotReceiver>>;

    std::uint64_t pair_limit() const;
    Receivers take_receivers(std::uint64_t step);
    void update_wanted();
    void pass_on(Receivers receivers, std::shared_ptr<const StepSnapshot> snapshot, const grpc::Status& failure);

    const std::string id_;
    Description scene_;
    ResultReader& reader_;

    std::atomic<std::uint64_t> steps_ = 0, objects_ = 0, pairs_ = 0;
    std::atomic<double> seconds_ = 0;
    /// Number of a step: some watcher waits for a later step. Greatest number: no watcher waits.
    std::atomic<std::uint64_t> wanted_after_ = ~std::uint64_t(0);

    // Used by the scene's thread.
    Clock::time_point next_time_{};
    std::vector<std::weak_ptr<const StepSnapshot>> snapshots_;

    mutable std::mutex mutex_;
    std::vector<Waiting> waiting_;
    std::weak_ptr<const StepSnapshot> latest_;
    bool closed_ = false;
};

/// The running scenes of a server, by id. Thread safety: any thread may call it.
class SceneTable {
public:
    void enter(const std::shared_ptr<ScenePublisher>& scene);
    void remove(const ScenePublisher& scene);
    /// Throws: Error{bad_input} if the caller sees no scene `id`.
    std::shared_ptr<ScenePublisher> find(const Caller& caller, const std::string& id) const;
    /// Returns the scenes that the caller sees with ids greater than `after`, ascending by id, at most `most` of them.
    std::vector<std::shared_ptr<ScenePublisher>> of(const Caller& caller, const std::string& after,
                                                    std::size_t most) const;

private:
    mutable std::mutex mutex_;
    std::map<std::string, std::shared_ptr<ScenePublisher>> scenes_;
};

}  // namespace octopair::service
