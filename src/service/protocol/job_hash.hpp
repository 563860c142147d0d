// What a job asks for, as one number: the same jobs have the same results, to the byte, if their hashes are the same.
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

/// Of results: raised whenever the same input and options may give other bytes (the octal order may change from version
/// to version).
inline constexpr std::uint32_t algorithm_version = 1;

/// XXH3 in 128 bits of, little endian: algorithm version (u32), order (u32), margin (f64), whether there is a limit (u64),
/// the limit (u64), count only (u64); for each set, the second one all zeros if there is none: is there (u64), objects
/// (u64), precision in bits (u64), padded (u64); then the data as they are uploaded. It is for noticing mistakes, and no
/// guard against a client that cheats itself.
class JobHash {
public:
    explicit JobHash(const v1::JobSpec& spec);
    ~JobHash();
    JobHash(const JobHash&) = delete;
    JobHash& operator=(const JobHash&) = delete;

    void add(std::span<const std::byte> data);
    /// Its 16 bytes, the high ones first.
    std::string digest() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace octopair::service
