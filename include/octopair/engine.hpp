// Engine: finds all pairs of overlapping boxes.
//
// Result    Every pair of objects that counts (objects.hpp), exactly once. Every engine returns the same bytes, for any number
//           of threads and any instruction set.
// Errors    Calls throw octopair::Error (error.hpp). They never modify their input. A failed call leaves the engine usable
//           and the PairList empty.
// Threads   Any thread may call an engine; its calls run one after another, in the order of arrival. Different engines are
//           independent.
// Callbacks A sink, a filter or a progress function that calls the engine which runs it, or waits for a job of that engine, gets an
//           Error{usage} at once, on any thread: the engine runs one call at a time. Calls of other engines, and submit(), are
//           allowed there.
// Engines   Each engine derives from Engine: engine/threads, engine/processes, engine/mpi, service/client. The command chooses
//           one in cli/engine_choice.cpp.
// Cost      O((n log n + pairs) / k) time on k threads. docs/memory.md has the bytes per object of each engine, besides input
//           and output.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <stop_token>
#include <vector>

#include "octopair/box_array.hpp"
#include "octopair/input.hpp"
#include "octopair/job.hpp"
#include "octopair/limits.hpp"
#include "octopair/objects.hpp"
#include "octopair/options.hpp"
#include "octopair/pair_list.hpp"
#include "octopair/summary.hpp"

namespace [[gnu::visibility("default")]] octopair {

namespace detail {  // not for users
class JobQueue;
struct Control;
struct Output;
struct Request;
}  // namespace detail

/// Receives pairs in batches, in order, on the calling thread. The span is valid only during the call. An exception ends the
/// search and propagates to the caller.
using PairSink = std::function<void(std::span<const Pair>)>;

class Engine {
public:
    Engine() = default;
    Engine(const Engine&) = delete;
    Engine& operator=(const Engine&) = delete;
    virtual ~Engine() = default;

    /// Finds the pairs of one set (`Objects{boxes}`), or of two (`Join{first, second}`), and stores them in `pairs`.
    /// Throws: Error{bad_input} with the index of the first invalid box; Error{cancelled} within 200 ms after a stop request;
    /// Error{resource_limit}; Error{engine_failed}; Error{usage} in a callback of this engine, or if this kind of engine does not
    /// support the call (its header says why).
    Summary find_pairs(const Input& input, PairList& pairs, const Options& options = {}, std::stop_token stop = {});
    /// Finds all pairs and passes them to `sink` in order, using at most `Options::buffer_bytes` for pairs. With an empty
    /// `sink` the pairs are only counted. Throws: as find_pairs().
    Summary stream_pairs(const Input& input, const PairSink& sink, const Options& options = {},
                         std::stop_token stop = {});
    /// Like stream_pairs(), for a sink that has room for `max_pairs` pairs, for example on a disk. Threads and worker processes notice
    /// early that there are more: with Order::ascending, before the sink gets a pair. Otherwise it gets at most `max_pairs`.
    /// Throws: also TooManyPairs (error.hpp) if there are more pairs, after `Options::limit`.
    Summary stream_at_most(std::uint64_t max_pairs, const Input& input, const PairSink& sink,
                           const Options& options = {}, std::stop_token stop = {});
    /// Returns the number of pairs, at most `Options::limit`. Stores none of them. Throws: as find_pairs().
    std::uint64_t count_pairs(const Input& input, const Options& options = {}, std::stop_token stop = {});

    /// Returns at once the handle of a job (job.hpp) that runs find_pairs() on a thread of the engine. An invalid box or
    /// padding fails the job. Destroying the engine cancels its jobs.
    /// Throws: Error{bad_input} for invalid options or sizes that differ; Error{resource_limit} for more than 2^32 - 1 objects,
    /// or if memory or threads run out; Error{usage} as find_pairs().
    Job submit(JobInput input, Options options = {});
    /// Like submit(), but the job runs stream_pairs(). The thread of the engine calls `sink`. Throws: as submit().
    Job submit_stream(JobInput input, PairSink sink, Options options = {});

    /// Returns an array for `count` boxes (Box3f or Box3d) that this engine reads without copying. Does not wait for calls.
    /// Throws: Error{resource_limit} if memory runs out, or for more than 2^32 - 1 boxes.
    template <typename Element = Box3f>
    BoxArray<Element> allocate_boxes(std::uint64_t count) {
        return BoxArray<Element>(allocate_array(count, sizeof(Element)), count);
    }

private:
    Summary call(const detail::Request& request, const detail::Output& output, std::stop_token stop);
    template <typename Work>
    Job submit_work(Work work);
    std::shared_ptr<void> allocate_array(std::uint64_t count, std::size_t element_bytes);

    /// Checks options and sizes before run(). Throws: Error.
    virtual void check(const detail::Request& request) const;
    virtual Summary run(const detail::Request& request, const detail::Output& output,
                        const detail::Control& control) = 0;
    /// Returns the engine's job queue. Every engine has its queue as last member, so that jobs end before the members that they
    /// use are destroyed.
    virtual detail::JobQueue& jobs() = 0;
    /// Returns uninitialised memory, aligned to 64 bytes, which may outlive the engine. Throws: std::bad_alloc.
    virtual std::shared_ptr<void> allocate(std::size_t bytes);
    /// Returns the number of threads of this process that check a result (Options::verify); 0: one per core.
    virtual unsigned verification_threads() const;
};

/// Returns an engine that uses `threads` threads of this process; 0: one per core that the process may use (taskset(1), control
/// groups). Throws: Error{usage} for more than max_threads.
std::unique_ptr<Engine> make_local_engine(unsigned threads = 0);

/// Returns the pairs of `boxes`, found by a temporary local engine. For repeated calls keep an Engine: it reuses its memory.
std::vector<Pair> find_pairs(std::span<const Box3f> boxes, const Options& options = {});
std::vector<Pair> find_pairs(std::span<const Box3d> boxes, const Options& options = {});

}  // namespace octopair
