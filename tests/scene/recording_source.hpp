// source_of(): a recording in memory, for tests.
#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <span>
#include <string>

#include "scene/recording/recording_reader.hpp"

namespace octopair::test {

/// Returns a source of `bytes`, which must outlive it.
inline RecordingSource source_of(const std::string& bytes) {
    const auto read = [&bytes](std::uint64_t offset, std::span<std::byte> out) {
        ASSERT_LE(offset, bytes.size());
        ASSERT_LE(out.size(), bytes.size() - offset);
        if (!out.empty()) std::memcpy(out.data(), bytes.data() + offset, out.size());
    };
    return {"r.rec", bytes.size(), read};
}

}  // namespace octopair::test
