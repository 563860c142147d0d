// Engines: places where octopair looks for the pairs of overlapping boxes.
//
// Result    every pair of objects that counts (objects.hpp), once; the same bytes from every engine, for any number of
//           threads, on any instruction set.
// Errors    octopair::Error (error.hpp); the input is never modified; a failed call leaves the engine usable and the
//           PairList empty.
// Threads   an engine may be used from any thread; its calls run one after another, as they came; different engines are
//           independent.
// Cost      O((n log n + pairs) / k) time, at most 56 bytes an object beside input and output in
//           the local engine (docs/engines.md has the others).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string_view>
#include <vector>

#include "octopair/box_array.hpp"
#include "octopair/job.hpp"
#include "octopair/objects.hpp"
#include "octopair/pair_list.hpp"

namespace octopair {

/// `octal`: the order of the linear octree, the cheapest. `ascending`: by a, then b. Both are deterministic.
enum class Order : std::uint8_t { ascending, octal };

/// Receives how much of a call is done, 0 to 1, never falling; from one thread at a time, which may not be the
/// caller's.
using ProgressSink = std::function<void(double)>;

struct Options {
    Order order = Order::ascending;
    double margin = 0;                        ///< gap up to which a pair counts, on every axis; finite, >= 0
    std::optional<std::uint64_t> limit = {};  ///< the first so many pairs of the order
    std::uint64_t buffer_bytes = 1ull << 30;  ///< bound on pairs held while streaming; at least 1 MiB is used
    ProgressSink progress = {};               ///< may be empty; what it throws ends the call and reaches the caller
    /// Checks the result by a second algorithm that shares no code with the octree (docs/design.md, "Certificates").
    /// A difference throws Error{engine_failed} that names a pair; of a list that failed, no pair is left. A stream fails
    /// before a pair that does not belong is handed out, and for want of a pair at its end at the latest.
    /// Time: some microseconds an object, shared by the threads; often ten times the call. Memory, in this process: 33
    /// bytes an object (64 for float64), 12 more in octal order; the number of pairs does not matter.
    /// Throws Error{usage} on an engine of MPI ranks, none of which has all objects.
    bool verify = false;
};

/// Wall-clock seconds of the steps; a step that was passed over more than once (streaming) is summed.
struct StepSeconds {
    double encode = 0, sort = 0, merge = 0, scan = 0;
};

/// Outcome of Options::verify.
struct Verification {
    bool done = false;   ///< the result was checked, and no difference was found
    double seconds = 0;  ///< wall clock; not part of the seconds of the call
    /// Static text for users that names the properties which were not checked; empty if all were. Examples: the order of the
    /// pairs in octal order, which pairs are the first under a limit, which pairs were counted.
    std::string_view not_checked = {};
};

/// What a call did, beside its pairs.
struct Summary {
    std::uint64_t pairs = 0;
    bool truncated = false;     ///< `limit` was reached and at least one more pair exists
    double seconds = 0;         ///< wall clock
    std::uint64_t entries = 0;  ///< of the linear octree; at most 8 an object
    StepSeconds steps = {};
    Verification verification = {};
};

/// Receives batches in order, on the calling thread; a span is valid during the call only. What it throws ends the
/// search and reaches the caller.
using PairSink = std::function<void(std::span<const Pair>)>;

class JobQueue;  // internal

class Engine {
public:
    Engine() = default;
    Engine(const Engine&) = delete;
    Engine& operator=(const Engine&) = delete;
    virtual ~Engine() = default;

    /// Throws Error{cancelled} within 200 ms of a stop request, Error{bad_input} with the object's index for a box that
    /// is not one.
    Summary find_pairs(const Objects& objects, PairList& pairs, const Options& options = {}, std::stop_token stop = {});
    Summary find_pairs_between(const Objects& first, const Objects& second, PairList& pairs,
                               const Options& options = {}, std::stop_token stop = {});
    /// Hands the pairs to `sink` in order; holds at most `Options::buffer_bytes` of them at a time. An empty `sink` has
    /// them counted only.
    Summary stream_pairs(const Objects& objects, const PairSink& sink, const Options& options = {},
                         std::stop_token stop = {});
    Summary stream_pairs_between(const Objects& first, const Objects& second, const PairSink& sink,
                                 const Options& options = {}, std::stop_token stop = {});
    /// The number of pairs (at most `Options::limit`, if given); stores none of them.
    std::uint64_t count_pairs(const Objects& objects, const Options& options = {}, std::stop_token stop = {});
    std::uint64_t count_pairs_between(const Objects& first, const Objects& second, const Options& options = {},
                                      std::stop_token stop = {});

    /// Jobs (job.hpp): the same calls, made on a thread of the engine's own; collected, or streamed to a `sink` that is
    /// called there. Return at once. Throw what is wrong with options and sizes, as those calls do, and
    /// Error{resource_limit} for want of memory or threads; what is wrong with a box or a padding fails the job. The
    /// engine's end cancels its jobs.
    Job submit(JobObjects objects, Options options = {});
    Job submit_between(JobObjects first, JobObjects second, Options options = {});
    Job submit_stream(JobObjects objects, PairSink sink, Options options = {});
    Job submit_stream_between(JobObjects first, JobObjects second, PairSink sink, Options options = {});

    /// Room for boxes (Box3f or Box3d) where this engine reads them without copying; waits for no call. Throws
    /// Error{resource_limit} for more than there is room for, or than 2^32 - 1.
    template <typename Element = Box3f>
    BoxArray<Element> allocate_boxes(std::uint64_t count) {
        return BoxArray<Element>(allocate_array(count, sizeof(Element)), count);
    }

    struct Request;  ///< objects, the second set of a join, options: what every call above becomes (internal)
    struct Output;   ///< a list, a sink, or neither to count (internal)
    struct Control;  ///< stop token and progress (internal)

private:
    Summary call(const Request& request, const Output& output, std::stop_token stop);
    template <typename Work>
    Job submit_work(Work work);
    std::shared_ptr<void> allocate_array(std::uint64_t count, std::size_t element_bytes);

    /// Before run(), of options and sizes. Throws Error.
    virtual void check(const Request& request) const;
    virtual Summary run(const Request& request, const Output& output, const Control& control) = 0;
    /// Every engine has one, as its last member: it ends the jobs before what they use goes.
    virtual JobQueue& jobs() = 0;
    /// Aligned to 64 bytes; freed by the last who holds it, which may be after the engine. May throw std::bad_alloc.
    virtual std::shared_ptr<void> allocate(std::size_t bytes);
    /// Threads of this process that check a result (Options::verify); 0: one per core.
    virtual unsigned verification_threads() const;
};

/// Threads of this process. 0: one per core.
std::unique_ptr<Engine> make_local_engine(unsigned threads = 0);

/// The short form: one call on an engine of its own. Keep an Engine where calls repeat: it keeps its memory.
std::vector<Pair> find_pairs(std::span<const Box3f> boxes, const Options& options = {});
std::vector<Pair> find_pairs(std::span<const Box3d> boxes, const Options& options = {});

}  // namespace octopair
