// JobHash: hash of a job's options and input. Jobs with equal hashes have equal results, to the byte.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace octopair::v1 {
class JobSpec;
}  // namespace octopair::v1

namespace octopair::service {

/// Version of results. It is increased when equal input and options may give different bytes (for example, because the octal
/// order changes).
inline constexpr std::uint32_t algorithm_version = 1;

/// The 128-bit XXH3 hash of these numbers, little endian:
///   - algorithm version (u32), order (u32), margin (f64), 1 if there is a limit (u64), limit (u64), 1 if count only (u64);
///   - for each of two sets: 1 if there is this set (u64), objects (u64), precision in bits (u64), 1 if padded (u64). All four
///     are 0 for a second set that does not exist;
///   - the data in the order of the upload.
/// The hash detects mistakes. It is not secure against a client that constructs collisions for itself.
class JobHash {
public:
    /// `algorithm`: version of results.
    explicit JobHash(const v1::JobSpec& spec, std::uint32_t algorithm = algorithm_version);
    ~JobHash();
    JobHash(const JobHash&) = delete;
    JobHash& operator=(const JobHash&) = delete;

    void add(std::span<const std::byte> data);
    /// Returns the 16 bytes of the hash, most significant byte first.
    std::string digest() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace octopair::service
