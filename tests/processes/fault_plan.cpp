#include "processes/fault_plan.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cstdlib>
#include <stdexcept>

namespace octopair::test {

MappedPlan::MappedPlan() : file_(::memfd_create("faults", MFD_CLOEXEC)), named_(true) {
    if (!file_.open() || ::ftruncate(file_.number(), sizeof(FaultPlan)) != 0)
        throw std::runtime_error("cannot make a memory file for the plan of faults");
    map();
    const std::string path = "/proc/" + std::to_string(::getpid()) + "/fd/" + std::to_string(file_.number());
    ::setenv(plan_variable, path.c_str(), 1);
}

MappedPlan::MappedPlan(Named) {
    const char* const path = std::getenv(plan_variable);
    if (path == nullptr) return;
    file_ = Descriptor(::open(path, O_RDWR | O_CLOEXEC));
    if (file_.open()) map();
}

MappedPlan::~MappedPlan() {
    if (named_) ::unsetenv(plan_variable);
    if (plan_ != nullptr) ::munmap(plan_, sizeof *plan_);
}

void MappedPlan::map() {
    void* const mapped = ::mmap(nullptr, sizeof(FaultPlan), PROT_READ | PROT_WRITE, MAP_SHARED, file_.number(), 0);
    if (mapped == MAP_FAILED) throw std::runtime_error("cannot map the plan of faults");
    plan_ = static_cast<FaultPlan*>(mapped);
}

void MappedPlan::set(std::span<const Fault> faults) {
    if (faults.size() > FaultPlan::most) throw std::length_error("the plan has no room for so many faults");
    plan_->end.store(0);
    plan_->next.store(0);
    plan_->passed.store(0);
    std::copy(faults.begin(), faults.end(), plan_->faults.begin());
    plan_->end.store(std::uint32_t(faults.size()));
}

FaultCounts MappedPlan::happened() const {
    FaultCounts counts{};
    for (std::size_t step = 0; step < counts.size(); ++step) {
        for (std::size_t kind = 0; kind < counts[step].size(); ++kind) {
            counts[step][kind] = plan_->happened[step][kind].load();
        }
    }
    return counts;
}

}  // namespace octopair::test
