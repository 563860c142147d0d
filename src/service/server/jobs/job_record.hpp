// JobRecord: the persistent part of a detached job, which outlives the server: the input until it is read, and how the job
// ended.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>

#include "octopair/error.hpp"
#include "service/server/jobs/budget.hpp"

namespace octopair {
class Engine;
}  // namespace octopair

namespace octopair::v1 {
class JobReport;
}  // namespace octopair::v1

namespace octopair::service {

class UploadedInput;

/// Thrown when a job's input or result does not fit on the disk now, or exceeds the limit on the state folder.
class NoRoomError : public Error {
public:
    explicit NoRoomError(const std::string& message) : Error(ErrorCode::io_failed, message) {}
};

class JobRecord {
public:
    virtual ~JobRecord() = default;

    /// Returns the hash of input and options.
    virtual std::string hash() const = 0;
    /// Returns a reservation of the memory that the job needs to run, or nothing if not enough memory is free now.
    virtual std::optional<Budget::Reservation> ask_memory() = 0;
    /// Reads the input into memory of `engine`. Throws: Error{io_failed} for a damaged file, Error{cancelled} after a stop
    /// request.
    virtual std::unique_ptr<UploadedInput> load(const std::shared_ptr<Engine>& engine,
                                                const std::stop_token& stop) const = 0;
    /// Stores how the job ended. On return `ending` is on the disk. Throws: Error{io_failed}, NoRoomError.
    virtual void end(const v1::JobReport& ending) = 0;
    /// Deletes the stored part of the result, because the rest did not fit. The job must then wait until has_room() returns true.
    /// `run`: how long the job ran. Throws: Error if the result can never fit.
    virtual void wait_for_room(const NoRoomError& why, std::chrono::duration<double> run) = 0;
    /// Returns whether the disk and the limit on state have enough room for the job's result.
    virtual bool has_room() = 0;
    /// Runs `task` soon on the thread of the disk queue, where it may wait for disks.
    virtual void run_on_disk_queue(std::function<void()> task) = 0;
};

}  // namespace octopair::service
