// The process engine: runs the steps of the algorithm in worker processes that share memory with the application.

#include <dlfcn.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include "base/control_group.hpp"
#include "base/floating_point_scope.hpp"
#include "engine/job_queue.hpp"
#include "engine/processes/client/process_passes.hpp"
#include "engine/processes/client/worker_pool.hpp"
#include "engine/search.hpp"
#include "engine/ticket_lock.hpp"
#include "octopair/error.hpp"
#include "octopair/processes.hpp"

namespace octopair {

namespace {

namespace fs = std::filesystem;

/// Returns the path of the file that contains this code: a library, or the program. Empty if unknown.
fs::path own_file() {
    Dl_info info = {};
    if (dladdr(reinterpret_cast<const void*>(&own_file), &info) == 0 || info.dli_fname == nullptr) return {};
    return info.dli_fname;
}

std::vector<std::string> candidate_paths(const std::string& packaged) {
    std::vector<std::string> found;
    std::error_code error;
    const fs::path self = fs::read_symlink("/proc/self/exe", error);
    if (!error) {
        const fs::path folder = self.parent_path();
        found.push_back(folder / "octopair-worker");
        found.push_back(folder.parent_path() / OCTOPAIR_WORKER_FOLDER / "octopair-worker");
    }
    if (const fs::path library = own_file(); library.is_absolute())
        found.push_back((library.parent_path() / OCTOPAIR_WORKER_FROM_LIBRARY / "octopair-worker").lexically_normal());
    if (!packaged.empty()) found.push_back(packaged);
    // A build tree uses its own program, not that of an older installation. Builds for packages leave out paths that they cannot know.
    for (const std::string configured : {OCTOPAIR_WORKER_BUILT, OCTOPAIR_WORKER_INSTALLED}) {
        if (!configured.empty()) found.push_back(configured);
    }
    return found;
}

/// Returns the first of: `requested` if not empty; the path in OCTOPAIR_WORKER; the first executable of the candidates.
/// Candidates are files octopair-worker, in this order: in the folder of this program, in the libexec folder beside it, in the
/// libexec folder of this library. Then: at `packaged` (may be empty), in the build tree, in the configured installation.
/// Throws: Error{engine_failed} with the candidates if none is executable.
std::string find_worker_program(const std::string& requested, const std::string& packaged) {
    if (!requested.empty()) return requested;
    const char* const named = std::getenv("OCTOPAIR_WORKER");
    if (named != nullptr && *named != 0) return named;
    std::string tried;
    for (const std::string& path : candidate_paths(packaged)) {
        if (::access(path.c_str(), X_OK) == 0) return path;
        tried += (tried.empty() ? "" : ", ") + path;
    }
    throw Error(ErrorCode::engine_failed,
                "cannot find the worker program; set OCTOPAIR_WORKER to its path; tried " + tried);
}

unsigned worker_count(unsigned requested) {
    if (requested > max_workers) {
        throw Error(ErrorCode::usage, "workers: " + std::to_string(requested) + " is not in the range 0 to " +
                                          std::to_string(max_workers));
    }
    return requested > 0 ? requested : std::min(available_cores(), max_workers);
}

class ProcessEngine final : public Engine {
public:
    ProcessEngine(const ProcessOptions& options, const std::string& packaged_worker)
        : pool_(find_worker_program(options.worker_program, packaged_worker), worker_count(options.workers)),
          passes_(pool_, *arrays_),
          search_(passes_) {}

    WorkerFaults faults() const { return pool_.faults(); }

private:
    Summary run(const detail::Request& request, const detail::Output& output, const detail::Control& control) override {
        const TicketLock::Guard turn(ticket_lock_, control.stop);
        return search_.run(request, output, control);
    }
    std::shared_ptr<void> allocate(std::size_t bytes) override { return SharedArrays::allocate(arrays_, bytes); }
    detail::JobQueue& jobs() override { return jobs_; }
    unsigned verification_threads() const override { return passes_.width(); }

    TicketLock ticket_lock_;
    std::shared_ptr<SharedArrays> arrays_ = std::make_shared<SharedArrays>();
    WorkerPool pool_;
    ProcessPasses passes_;
    Search<ProcessPasses> search_;
    detail::JobQueue jobs_{*this};  // last member, so it is destroyed first
};

}  // namespace

std::unique_ptr<Engine> make_process_engine(const ProcessOptions& options, detail::PackagedWorker package) {
    const FloatingPointScope scope;
    return std::make_unique<ProcessEngine>(options, package.path);
}

std::unique_ptr<Engine> make_process_engine(unsigned workers, detail::PackagedWorker package) {
    return make_process_engine(ProcessOptions{.workers = workers}, package);
}

WorkerFaults worker_faults(const Engine& engine) {
    const auto* const processes = dynamic_cast<const ProcessEngine*>(&engine);
    if (processes == nullptr)
        throw Error(ErrorCode::usage, "worker_faults: the engine was not made by make_process_engine");
    return processes->faults();
}

}  // namespace octopair
