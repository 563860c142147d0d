#include "engine/processes/worker/pass_runner.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <exception>
#include <new>
#include <optional>

#include "base/test_hooks.hpp"
#include "base/timed.hpp"
#include "base/tuning.hpp"
#include "engine/processes/worker/shared_buckets.hpp"
#include "octopair/error.hpp"
#include "octree/scan/scan.hpp"

namespace octopair {

namespace {

/// A set of the client's objects, in shared memory.
struct Set {
    Set(const SetRef& ref, WorkerRegions& regions) {
        if (ref.wide != 0) {
            objects.boxes = regions.array<Box3d>(ref.boxes, boxes);
        } else {
            objects.boxes = regions.array<Box3f>(ref.boxes, boxes);
        }
        objects.padding = regions.array<double>(ref.padding, padding);
    }

    std::shared_ptr<SharedMemory> boxes, padding;
    Objects objects{std::span<const Box3f>{}};
};

/// Notifies an observer whenever boxes are read.
class ObservedSource final : public ForwardingSource {
public:
    ObservedSource(const EntrySource& source, ShareObserver* observer)
        : ForwardingSource(source), observer_(observer) {}
    bool load(std::size_t begin, std::span<Entry> out) const override {
        tick();
        return source().load(begin, out);
    }
    Float32Boxes float32_boxes(std::size_t begin, std::span<Box3f> room) const override {
        tick();
        return source().float32_boxes(begin, room);
    }
    std::uint32_t pairs_with(const std::uint32_t* objects, std::uint32_t other, std::uint32_t asked) const override {
        return source().pairs_with(objects, other, asked);
    }

private:
    void tick() const {
        if (observer_ != nullptr) observer_->tick();
    }

    ShareObserver* observer_;
};

/// Notifies an observer whenever pairs are written.
class ObservedWriter final : public ShareWriter {
public:
    ObservedWriter(ShareWriter& writer, ShareObserver& observer) : writer_(writer), observer_(observer) {}
    bool counting() const override { return writer_.counting(); }
    std::span<Pair> room(std::size_t pairs) override { return writer_.room(pairs); }
    void write(std::span<const Pair> pairs) override {
        observer_.tick();
        writer_.write(pairs);
    }
    void write_count(std::uint64_t pairs) override {
        observer_.tick();
        writer_.write_count(pairs);
    }

private:
    ShareWriter& writer_;
    ShareObserver& observer_;
};

void set_message(Slot& slot, const Error& error) {
    slot.error_code = std::uint32_t(error.code());
    slot.message = {};
    std::strncpy(slot.message.data(), error.what(), slot.message.size() - 1);
}

}  // namespace

struct PassRunner::Job {
    Job(const Pass& pass, WorkerRegions& regions)
        : number(pass.job),
          first(pass.first, regions),
          second(pass.second, regions),
          memory(regions.get(pass.arena_region)),
          arena(*memory),
          source(first.objects, pass.join != 0 ? &second.objects : nullptr, pass.margin),
          octree(arena) {}

    std::uint32_t number;
    Set first, second;
    std::shared_ptr<SharedMemory> memory;
    Arena arena;
    BoxSource source;
    LinearOctree octree;
    bool built = false;
    std::uint64_t built_mark = 0;  // mark of the arena after the build
};

PassRunner::PassRunner(ControlBlockView& view, WorkerRegions& regions) : view_(view), regions_(regions) {}

PassRunner::~PassRunner() = default;

/// Divides the steps that build the octree among the workers. The octree is in memory that all workers share.
class PassRunner::BuildExecutor final : public Executor {
public:
    /// `built`: true if an earlier pass has built the octree; for_each() then does nothing.
    BuildExecutor(WorkSharing& shares, unsigned width, bool built) : shares_(shares), width_(width), built_(built) {}
    unsigned width() const override { return width_; }
    void for_each(std::size_t count, const std::function<void(std::size_t)>& body) override {
        constexpr std::array steps = {Step::encode, Step::count};
        const Step step = steps.at(step_++);
        if (built_) return;
        shares_.run(step, count, [&](const WorkSharing::ClaimedShare& share) { body(std::size_t(share.index)); });
    }
    void for_each_writing(std::size_t, const std::function<void(std::size_t, ShareWriter&)>&) override {
        throw Error(ErrorCode::engine_failed, "a step without an output for pairs wrote pairs");
    }

private:
    WorkSharing& shares_;
    unsigned width_;
    bool built_;
    std::size_t step_ = 0;
};

/// Divides the steps that write pairs, and the steps that build nested octrees of large octants, among the workers. Each
/// worker sorts and measures sets of boxes itself. The results depend only on octrees that no longer change, so a
/// replacement worker computes the same results.
template <typename Output>
class PassRunner::ScanExecutor final : public Executor {
public:
    /// Borrows all arguments. `arena`: pages for nested octrees. The arena is not rewound before the pass ends: a slow or
    /// replacement worker still reads octrees that other workers no longer need.
    ScanExecutor(WorkSharing& shares, unsigned width, Output& output, Arena& arena)
        : shares_(shares), width_(width), output_(output), arena_(arena) {}
    unsigned width() const override { return width_; }
    void for_each(std::size_t count, const std::function<void(std::size_t)>& body) override {
        for (std::size_t i = 0; i < count; ++i) body(i);
    }
    void for_each_writing(std::size_t count, const std::function<void(std::size_t, ShareWriter&)>& body) override {
        shares_.run(Step::scan, count, [&](const WorkSharing::ClaimedShare& share) {
            output_.begin(share);
            if (shares_.observer() != nullptr) {
                ObservedWriter observed(output_, *shares_.observer());
                body(std::size_t(share.index), observed);
            } else {
                body(std::size_t(share.index), output_);
            }
            output_.commit(share);
        });
    }
    BuildPlace build_place(std::size_t entries) override {
        if (!worth_sharing(entries)) return Executor::build_place(entries);
        count_path(Path::nested_shared);
        return {build_.emplace(shares_, width_, false), arena_};
    }

private:
    /// Returns true if the workers should build a nested octree together, in the arena. All workers of the pass get the same
    /// answer: they have the same arguments and have reserved the same memory.
    bool worth_sharing(std::size_t entries) const {
        const bool several_blocks = width_ > 1 && entries / tuning().build.min_block > 1;
        return several_blocks && entries <= arena_.left() / tuning().processes.nested_bytes;
    }

    WorkSharing& shares_;
    unsigned width_;
    Output& output_;
    Arena& arena_;
    std::optional<BuildExecutor> build_;  // builds the current nested octree
};

void PassRunner::run(const Pass& pass, const WorkSharing::Self& self, std::stop_token stop) {
    Slot& slot = view_.slot(self.slot);
    WorkSharing shares(view_, self, stop);
    const Context context{pass, shares, stop, slot};
    try {
        slot.outcome = take_part(context);
    } catch (const LinearOctree::Invalid& invalid) {
        slot.number = invalid.begin;
        slot.outcome = Outcome::bad_box;
    } catch (const OverBudget&) {
        slot.outcome = Outcome::over_budget;
    } catch (const Error& error) {
        set_message(slot, error);
        slot.outcome = error.code() == ErrorCode::cancelled ? Outcome::stopped : Outcome::failed;
    } catch (const std::bad_alloc&) {
        set_message(slot, Error(ErrorCode::resource_limit, "a worker process ran out of memory"));
        slot.outcome = Outcome::failed;
    } catch (const std::exception& failure) {
        set_message(slot, Error(ErrorCode::engine_failed, failure.what()));
        slot.outcome = Outcome::failed;
    }
    slot.share.store(0);
    slot.preparing.store(0);
}

Outcome PassRunner::take_part(const Context& context) {
    if (job_ == nullptr || job_->number != context.pass.job) start_job(context.pass);
    build(context);
    scan(context);
    context.slot.shares = context.shares.shares();
    return Outcome::done;
}

void PassRunner::forget_job() { job_ = nullptr; }

void PassRunner::start_job(const Pass& pass) {
    job_ = nullptr;
    job_ = std::make_unique<Job>(pass, regions_);
}

void PassRunner::build(const Context& context) {
    if (!job_->built) {
        BuildExecutor executor(context.shares, context.pass.workers, context.pass.built != 0);
        const ObservedSource source(job_->source, context.shares.observer());
        job_->octree.build(source, executor, context.stop);
        job_->built = true;
        job_->built_mark = job_->arena.mark();
    }
    context.slot.entries = job_->octree.entry_count();
    context.slot.encode_seconds = job_->octree.seconds().encode;
    context.slot.count_seconds = job_->octree.seconds().count;
    context.slot.scatter_seconds = job_->octree.seconds().scatter;
}

void PassRunner::scan(const Context& context) {
    job_->arena.rewind(job_->built_mark);
    const Pass& pass = context.pass;
    context.slot.scan_seconds = 0;
    const Timed timed(context.slot.scan_seconds);
    const auto pairs = regions_.get(pass.pairs_region);
    const WorkerPlace place{view_, *pairs, context.shares, context.stop};
    switch (pass.kind) {
        case PassKind::count:
            return scan_into(context, CountOutput(place));
        case PassKind::count_by_object:
            return count_by_object(context);
        case PassKind::list_octal:
            return scan_into(context, ListOutput(place));
        case PassKind::stream_octal:
            return scan_into(context, RingOutput(place, pass));
        case PassKind::list_ascending: {
            SharedBuckets buckets(place, pass);
            scan_into(context, buckets.output());
            return buckets.order(context.shares);
        }
    }
    throw Error(ErrorCode::engine_failed, "control block: the kind of the pass is unknown");
}

template <typename Output>
void PassRunner::scan_into(const Context& context, Output output) {
    ScanExecutor<Output> executor(context.shares, context.pass.workers, output, job_->arena);
    octopair::scan(job_->octree, {job_->source, context.stop, scan_memory_}, executor,
                   [&](std::uint64_t entries) { context.slot.entries_scanned.fetch_add(entries); });
}

void PassRunner::count_by_object(const Context& context) {
    Buffer<std::uint32_t> counts(job_->arena);
    counts.resize_discard(job_->source.size());
    const std::uint64_t blocks = context.pass.workers;
    context.shares.run(Step::scan, blocks, [&](const WorkSharing::ClaimedShare& share) {
        const std::size_t begin = counts.size() * share.index / blocks,
                          end = counts.size() * (share.index + 1) / blocks;
        std::fill(counts.data() + begin, counts.data() + end, 0u);
    });
    context.slot.number = job_->arena.offset(counts.data());
    scan_into(context, BinCountOutput(counts.span()));
}

}  // namespace octopair
