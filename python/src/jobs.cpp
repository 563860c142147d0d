// Job: a search that runs while Python does other work. Stream: the pairs of a search in chunks, as an iterator.
//
// A thread of Python runs the callbacks of all jobs (octopair/_jobs.py). It waits for the jobs that it watches, without polling: a job
// destroys its progress function when it ends, and this tells the thread.
#include <chrono>
#include <condition_variable>
#include <deque>
#include <list>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "call.hpp"
#include "engines.hpp"
#include "octopair/error.hpp"
#include "octopair/job.hpp"

namespace octopair::python {

namespace {

JobInput borrowed_input(const ArrayInput& input) {
    const Input& objects = input.input();
    if (objects.second) return JobJoin{borrowed(objects.first), borrowed(*objects.second)};
    return JobObjects(borrowed(objects.first));
}

/// Waits until `ended(time)` is true, and runs signal handlers meanwhile. Waits without end if `seconds` is negative.
/// Returns the last result of `ended`. Throws: exceptions of signal handlers.
bool wait_for_end(double seconds, const std::function<bool(std::chrono::nanoseconds)>& ended) {
    using Clock = std::chrono::steady_clock;
    constexpr std::chrono::nanoseconds interval = std::chrono::milliseconds(10);
    const bool endless = seconds < 0 || seconds > 1e9;
    const auto deadline = Clock::now() + std::chrono::nanoseconds(endless ? 0 : std::int64_t(seconds * 1e9));
    for (;;) {
        auto time = interval;
        if (!endless) time = std::min(time, std::chrono::nanoseconds(deadline - Clock::now()));
        bool done = false;
        {
            const Unlocked unlocked;
            done = ended(std::max(time, std::chrono::nanoseconds(0)));
        }
        if (done || (!endless && time <= std::chrono::nanoseconds(0))) return done;
        if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    }
}

/// The numbers of watched jobs that have ended, in the order of their ends.
struct EndedJobs {
    std::mutex mutex;
    std::condition_variable changed;
    std::list<std::uint64_t> numbers;
};

/// Never destroyed, because jobs may end as long as the process runs.
EndedJobs& ended_jobs() {
    static auto* const all = new EndedJobs;
    return *all;
}

/// Waits for the end of a watched job, and returns its number.
std::uint64_t next_ended_job() {
    check_not_forked();
    EndedJobs& ended = ended_jobs();
    const Unlocked unlocked;
    std::unique_lock lock(ended.mutex);
    ended.changed.wait(lock, [&] { return !ended.numbers.empty(); });
    const std::uint64_t number = ended.numbers.front();
    ended.numbers.pop_front();
    return number;
}

/// Says when a job ends. The mutex of EndedJobs guards the members.
class JobWatch {
public:
    /// Makes next_ended_job() return `number` at the end of the job. Returns false if the job has ended already.
    bool start(std::uint64_t number) {
        std::list<std::uint64_t> node{number};
        const std::lock_guard lock(ended_jobs().mutex);
        if (ended_) return false;
        number_ = std::move(node);
        return true;
    }
    void end() noexcept {
        EndedJobs& ended = ended_jobs();
        const std::lock_guard lock(ended.mutex);
        ended_ = true;
        if (number_.empty()) return;
        ended.numbers.splice(ended.numbers.end(), number_);  // allocates nothing
        ended.changed.notify_all();
    }

private:
    std::list<std::uint64_t> number_;  // empty: nobody watches
    bool ended_ = false;
};

/// Ends a watch when it is destroyed.
struct WatchEnd {
    explicit WatchEnd(std::shared_ptr<JobWatch> ended) : watch(std::move(ended)) {}
    WatchEnd(const WatchEnd&) = delete;
    WatchEnd& operator=(const WatchEnd&) = delete;
    ~WatchEnd() { watch->end(); }

    std::shared_ptr<JobWatch> watch;
};

/// A job, the engine that runs it, and the arrays that it reads.
class PythonJob {
public:
    PythonJob(const std::shared_ptr<PythonEngine>& engine, const py::object& input, Options options)
        : engine_(engine), input_(input) {
        engine->turn().check_free();
        engine->note_job();
        JobInput borrowed = borrowed_input(input.cast<const ArrayInput&>());
        options.progress = [end = std::make_shared<WatchEnd>(watch_)](double) {};
        const std::shared_ptr<Engine> open = engine->shared();
        const Unlocked unlocked;
        job_.reset(new Job(open->submit(std::move(borrowed), std::move(options))));
    }
    PythonJob(const PythonJob&) = delete;
    PythonJob& operator=(const PythonJob&) = delete;
    /// The job ends before the arrays are released.
    ~PythonJob() { job_.reset(); }

    const char* state() const {
        check_not_forked();
        return state_name(job_->state());
    }
    double progress() const {
        check_not_forked();
        return job_->progress();
    }
    void cancel() {
        if (!is_forked()) job_->cancel();
    }
    /// Makes next_ended_job() return `number` when the job ends. Returns false if the job is ending or has ended.
    bool watch(std::uint64_t number) {
        check_not_forked();
        return watch_->start(number);
    }
    bool wait(double seconds) {
        check_not_forked();
        return wait_for_end(seconds, [&](std::chrono::nanoseconds time) { return job_->wait_for(time); });
    }
    /// Returns (pairs, summary) once.
    py::tuple take_result() {
        wait(-1);
        const Summary summary = job_->summary();
        return py::make_tuple(pairs_array(job_->take_pairs()), summary_tuple(summary));
    }

private:
    std::shared_ptr<PythonEngine> engine_;
    py::object input_;
    std::shared_ptr<JobWatch> watch_ = std::make_shared<JobWatch>();
    std::unique_ptr<Job, ReleasedDelete> job_;
};

/// A bounded queue between the engine's thread, which finds pairs, and the Python thread, which takes chunks.
class ChunkQueue {
public:
    explicit ChunkQueue(std::size_t chunk_pairs) : chunk_pairs_(chunk_pairs) {}

    /// Appends pairs. Waits while two chunks are full.
    void put(std::span<const Pair> pairs) {
        std::unique_lock lock(mutex_);
        while (!pairs.empty()) {
            changed_.wait(lock, [&] { return closed_ || full_.size() < 2; });
            if (closed_) throw Error(ErrorCode::cancelled, "the stream was closed");
            const std::size_t taken = std::min(pairs.size(), chunk_pairs_ - open_.size());
            open_.insert(open_.end(), pairs.begin(), pairs.begin() + std::ptrdiff_t(taken));
            pairs = pairs.subspan(taken);
            if (open_.size() == chunk_pairs_) finish_chunk();
        }
    }
    /// Says that no put() follows.
    void finish() {
        const std::lock_guard lock(mutex_);
        finished_ = true;
        changed_.notify_all();
    }
    /// Waits at most for `time` until a chunk is full or the last pairs are there. Returns nothing if neither happens, and an empty
    /// chunk after the last pairs.
    std::optional<std::vector<Pair>> take(std::chrono::nanoseconds time) {
        std::unique_lock lock(mutex_);
        if (!changed_.wait_for(lock, time, [&] { return finished_ || !full_.empty(); })) return {};
        if (full_.empty()) return std::exchange(open_, {});
        std::vector<Pair> chunk = std::move(full_.front());
        full_.pop_front();
        changed_.notify_all();
        return chunk;
    }
    void close() {
        const std::lock_guard lock(mutex_);
        closed_ = true;
        changed_.notify_all();
    }

private:
    void finish_chunk() {
        full_.push_back(std::move(open_));
        open_ = {};
        changed_.notify_all();
    }

    std::size_t chunk_pairs_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<std::vector<Pair>> full_;
    std::vector<Pair> open_;
    bool closed_ = false, finished_ = false;
};

/// Finishes a queue when it is destroyed. A job destroys its sink when it ends.
struct QueueEnd {
    explicit QueueEnd(ChunkQueue& ended) : queue(ended) {}
    QueueEnd(const QueueEnd&) = delete;
    QueueEnd& operator=(const QueueEnd&) = delete;
    ~QueueEnd() { queue.finish(); }

    ChunkQueue& queue;
};

/// Half of the memory for pairs is the engine's; a chunk has an eighth of it, and at most 8 MiB. Two chunks wait, one is filled, and
/// one is the caller's.
class PythonStream {
public:
    PythonStream(const std::shared_ptr<PythonEngine>& engine, const py::object& input, Options options)
        : engine_(engine), input_(input), queue_(chunk_pairs(options)) {
        engine->turn().check_free();
        engine->note_job();
        JobInput borrowed = borrowed_input(input.cast<const ArrayInput&>());
        options.buffer_bytes /= 2;
        auto sink = [this, end = std::make_shared<QueueEnd>(queue_)](std::span<const Pair> pairs) {
            queue_.put(pairs);
        };
        const std::shared_ptr<Engine> open = engine->shared();
        const Unlocked unlocked;
        job_ = std::shared_ptr<Job>(new Job(open->submit_stream(std::move(borrowed), std::move(sink), options)),
                                    ReleasedDelete());
    }
    PythonStream(const PythonStream&) = delete;
    PythonStream& operator=(const PythonStream&) = delete;
    ~PythonStream() {
        if (!is_forked()) close();
    }

    /// Returns the next chunk. Throws: StopIteration at the end; the Error of the search; Error{cancelled} if another thread closes
    /// the stream meanwhile.
    py::array next() {
        const Turn::Holder turn(turn_);
        const std::shared_ptr<Job> job = current_job();
        if (!job) throw py::stop_iteration();
        std::optional<std::vector<Pair>> chunk;
        wait_for_end(-1, [&](std::chrono::nanoseconds time) {
            chunk = queue_.take(time);
            return chunk.has_value();
        });
        if (!chunk->empty()) return array_of<std::uint32_t>(std::move(*chunk), {2});
        end();
        summary_ = job->summary();
        throw py::stop_iteration();
    }
    void close() {
        if (is_forked()) return;
        if (const std::shared_ptr<Job> job = current_job()) job->cancel();
        queue_.close();
        end();
    }
    /// Returns the summary after the last chunk, before that None.
    py::object summary() {
        const Turn::Holder turn(turn_);
        return summary_ ? py::object(summary_tuple(*summary_)) : py::none();
    }

private:
    static std::size_t chunk_pairs(const Options& options) {
        constexpr std::uint64_t least = 1u << 16, most = 1u << 23;
        return std::size_t(std::clamp(options.buffer_bytes / 8, least, most) / sizeof(Pair));
    }

    std::shared_ptr<Job> current_job() {
        const std::lock_guard lock(mutex_);
        return job_;
    }
    void end() {
        std::shared_ptr<Job> ended;
        const std::lock_guard lock(mutex_);
        ended = std::move(job_);
        job_ = nullptr;
    }

    std::shared_ptr<PythonEngine> engine_;
    py::object input_;
    ChunkQueue queue_;
    Turn turn_;  // of next()
    std::optional<Summary> summary_;
    std::mutex mutex_;
    std::shared_ptr<Job> job_;  // last: it uses the queue
};

}  // namespace

void bind_jobs(py::module_& module) {
    py::class_<PythonJob>(module, "Job")
        .def(py::init<const std::shared_ptr<PythonEngine>&, const py::object&, Options>(), py::arg("engine"),
             py::arg("input"), py::arg("options"))
        .def_property_readonly("state", &PythonJob::state)
        .def_property_readonly("progress", &PythonJob::progress)
        .def("cancel", &PythonJob::cancel)
        .def("watch", &PythonJob::watch, py::arg("number"))
        .def("wait", &PythonJob::wait, py::arg("seconds") = -1.0)
        .def("take_result", &PythonJob::take_result);
    py::class_<PythonStream>(module, "Stream")
        .def(py::init<const std::shared_ptr<PythonEngine>&, const py::object&, Options>(), py::arg("engine"),
             py::arg("input"), py::arg("options"))
        .def("next", &PythonStream::next)
        .def("close", &PythonStream::close)
        .def_property_readonly("summary", &PythonStream::summary);
    module.def("next_ended_job", &next_ended_job);
}

}  // namespace octopair::python
