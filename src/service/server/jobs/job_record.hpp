// JobRecord: what outlives the server of a job: its input until it is read, and how it ended.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>

#include "service/server/jobs/budget.hpp"

namespace octopair {
class Engine;
}  // namespace octopair

namespace octopair::v1 {
class JobReport;
}  // namespace octopair::v1

namespace octopair::service {

class UploadedInput;

class JobRecord {
public:
    virtual ~JobRecord() = default;

    /// Of input and options.
    virtual std::string hash() const = 0;
    /// What the job takes when it runs; none: there is not as much now.
    virtual std::optional<Budget::Reservation> ask_memory() = 0;
    /// Throws Error{io_failed} for a file that is damaged, Error{cancelled} on a stop.
    virtual std::unique_ptr<UploadedInput> load(Engine& engine, const std::stop_token& stop) const = 0;
    /// When it returns, how the job ended lasts. Throws Error{io_failed}.
    virtual void end(const v1::JobReport& ending) = 0;
    /// Has this done soon where waiting for a disk holds nobody up.
    virtual void later(std::function<void()> errand) = 0;
};

}  // namespace octopair::service
