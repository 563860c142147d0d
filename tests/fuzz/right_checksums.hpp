// Corrects the checksums of random bytes, so that a fuzzer reaches the data after the checksum.
#pragma once

#include <cstring>
#include <span>
#include <string>

#include "scene/recording/recording.hpp"

namespace octopair::fuzz {

template <typename Head>
Head head_at(const std::string& bytes, std::size_t at) {
    Head head;
    std::memcpy(&head, bytes.data() + at, sizeof head);
    return head;
}

/// Returns `bytes` with all checks and checksums corrected.
inline std::string put_right(std::string bytes) {
    if (bytes.size() < sizeof(RecordingHead)) return bytes;
    auto first = head_at<RecordingHead>(bytes, 0);
    first.magic = RecordingHead::right_magic;
    first.checksum = first.right_checksum();
    std::memcpy(bytes.data(), &first, sizeof first);
    for (std::size_t at = sizeof first; bytes.size() - at >= record_overhead;) {
        auto head = head_at<RecordHead>(bytes, at);
        head.check = head.right_check();
        std::memcpy(bytes.data() + at, &head, sizeof head);
        if (head.length > bytes.size() - at - record_overhead) break;
        const std::size_t covered = sizeof head + std::size_t(head.length);
        Checksum sum;
        sum.add(std::as_bytes(std::span(bytes)).subspan(at, covered));
        const std::uint64_t checksum = sum.value();
        std::memcpy(bytes.data() + at + covered, &checksum, sizeof checksum);
        at += covered + sizeof checksum;
    }
    return bytes;
}

}  // namespace octopair::fuzz
