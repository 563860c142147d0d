// Upgrade of a stored job: converts the file of a job that was submitted to a server with another algorithm version (job_hash.hpp), so
// that this server runs it.
#pragma once

#include <string>

#include "service/server/store/state_format.hpp"

namespace octopair::service {

/// Rewrites BASE.job with the algorithm version of this program, and its hash. On return the new file has replaced the old one, and is on
/// the disk. Returns the contents besides the input.
/// Requires: the job has no result.
/// Throws: Error{io_failed} if the input does not match the hash of the old version; then, and after any other error, the old file stays.
StoredSpec upgrade_job(const std::string& base, const StoredSpec& old);

}  // namespace octopair::service
