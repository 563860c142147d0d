#include "service/protocol/job_hash.hpp"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <array>
#include <bit>

#include "service/protocol/octopair.pb.h"

namespace octopair::service {

static_assert(std::endian::native == std::endian::little, "numbers are hashed as they lie in memory");

struct JobHash::Impl {
    XXH3_state_t xxh;
};

namespace {

template <typename Number>
void add_number(JobHash& hash, Number number) {
    hash.add(std::as_bytes(std::span(&number, 1)));
}

void add_set(JobHash& hash, bool there, const v1::ObjectSet& set) {
    const std::uint64_t bits = there ? set.precision() == v1::FLOAT64 ? 64 : 32 : 0;
    const std::array<std::uint64_t, 4> numbers = {there, set.objects(), bits, set.padded()};
    hash.add(std::as_bytes(std::span(numbers)));
}

}  // namespace

JobHash::JobHash(const v1::JobSpec& spec, std::uint32_t algorithm) : impl_(std::make_unique<Impl>()) {
    XXH3_128bits_reset(&impl_->xxh);
    add_number(*this, algorithm);
    add_number(*this, std::uint32_t(spec.order()));
    add_number(*this, spec.margin());
    const std::array<std::uint64_t, 3> numbers = {spec.has_limit(), spec.limit(), spec.count_only()};
    add(std::as_bytes(std::span(numbers)));
    add_set(*this, true, spec.first());
    add_set(*this, spec.has_second(), spec.second());
}

JobHash::~JobHash() = default;

void JobHash::add(std::span<const std::byte> data) { XXH3_128bits_update(&impl_->xxh, data.data(), data.size()); }

std::string JobHash::digest() const {
    XXH128_canonical_t bytes;
    XXH128_canonicalFromHash(&bytes, XXH3_128bits_digest(&impl_->xxh));
    return {std::begin(bytes.digest), std::end(bytes.digest)};
}

}  // namespace octopair::service
