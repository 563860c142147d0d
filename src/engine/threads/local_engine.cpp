// The local engine: runs the steps of the algorithm on the threads of this process.

#include "engine/job_queue.hpp"
#include "engine/search.hpp"
#include "engine/threads/thread_passes.hpp"
#include "engine/ticket_lock.hpp"

namespace octopair {

namespace {

class LocalPasses final : public ThreadPasses {
public:
    explicit LocalPasses(unsigned threads)
        : ThreadPasses(threads, [this](const ThreadScan& scan) { scan_octants(scan, octree(), scan.call.source); }) {}

    void build(Call& call, double progress) {
        TeamExecutor executor(team());
        build_octree(call, progress, [&] {
            try {
                octree().build(call.source, executor, call.stop.get_token());
            } catch (const LinearOctree::Invalid& invalid) {
                call.source.refuse(invalid.begin);
            }
        });
        call.summary.entries = octree().entry_count();
    }
};

class LocalEngine final : public Engine {
public:
    explicit LocalEngine(unsigned threads) : passes_(threads) {}

private:
    Summary run(const detail::Request& request, const detail::Output& output, const detail::Control& control) override {
        const TicketLock::Guard turn(ticket_lock_, control.stop);
        return search_.run(request, output, control);
    }
    detail::JobQueue& jobs() override { return jobs_; }
    unsigned verification_threads() const override { return passes_.width(); }

    TicketLock ticket_lock_;
    LocalPasses passes_;
    Search<LocalPasses> search_{passes_};
    detail::JobQueue jobs_{*this};  // last member, so it is destroyed first
};

}  // namespace

std::unique_ptr<Engine> make_local_engine(unsigned threads) { return std::make_unique<LocalEngine>(threads); }

}  // namespace octopair
