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
#include <span>
#include <stop_token>
#include <vector>

#include "octopair/box_array.hpp"
#include "octopair/input.hpp"
#include "octopair/job.hpp"
#include "octopair/objects.hpp"
#include "octopair/options.hpp"
#include "octopair/pair_list.hpp"
#include "octopair/summary.hpp"

namespace octopair {

namespace detail {  // not for users
class JobQueue;
struct Control;
struct Output;
struct Request;
}  // namespace detail

/// Receives batches in order, on the calling thread; a span is valid during the call only. What it throws ends the
/// search and reaches the caller.
using PairSink = std::function<void(std::span<const Pair>)>;

class Engine {
public:
    Engine() = default;
    Engine(const Engine&) = delete;
    Engine& operator=(const Engine&) = delete;
    virtual ~Engine() = default;

    /// Finds the pairs of one set (`Objects{boxes}`), or of two (`Join{first, second}`), and writes them to `pairs`.
    /// Throws: Error{bad_input} with the object's index for a box that is not one; Error{cancelled} within 200 ms of a stop
    /// request; Error{resource_limit}, Error{engine_failed}; Error{usage} where the kind of engine cannot make this call (its
    /// header says why).
    Summary find_pairs(const Input& input, PairList& pairs, const Options& options = {}, std::stop_token stop = {});
    /// Hands the pairs to `sink` in order, and holds at most `Options::buffer_bytes` of them at a time. With an empty `sink`
    /// the pairs are only counted. Throws: as find_pairs().
    Summary stream_pairs(const Input& input, const PairSink& sink, const Options& options = {},
                         std::stop_token stop = {});
    /// Returns the number of pairs, at most `Options::limit`, and stores none of them. Throws: as find_pairs().
    std::uint64_t count_pairs(const Input& input, const Options& options = {}, std::stop_token stop = {});

    /// Starts a job (job.hpp): find_pairs(), or stream_pairs() for `sink`, on a thread of the engine, which also calls `sink`.
    /// Returns at once. The end of the engine cancels its jobs. A box or a padding that is wrong fails the job.
    /// Throws: Error{bad_input} for wrong options or sizes; Error{resource_limit} for more than 2^32 - 1 objects, or without
    /// memory or threads for a job; Error{usage} as find_pairs().
    Job submit(JobInput input, Options options = {});
    Job submit_stream(JobInput input, PairSink sink, Options options = {});

    /// Room for boxes (Box3f or Box3d) where this engine reads them without copying; waits for no call. Throws
    /// Error{resource_limit} for more than there is room for, or than 2^32 - 1.
    template <typename Element = Box3f>
    BoxArray<Element> allocate_boxes(std::uint64_t count) {
        return BoxArray<Element>(allocate_array(count, sizeof(Element)), count);
    }

private:
    Summary call(const detail::Request& request, const detail::Output& output, std::stop_token stop);
    template <typename Work>
    Job submit_work(Work work);
    std::shared_ptr<void> allocate_array(std::uint64_t count, std::size_t element_bytes);

    /// Before run(), of options and sizes. Throws Error.
    virtual void check(const detail::Request& request) const;
    virtual Summary run(const detail::Request& request, const detail::Output& output,
                        const detail::Control& control) = 0;
    /// Every engine has one, as its last member: it ends the jobs before what they use goes.
    virtual detail::JobQueue& jobs() = 0;
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
