// Checks of errors: the code and the words of an Error, and the index and the set of the object that it is about.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "octopair/engine.hpp"
#include "octopair/error.hpp"

namespace octopair::test {

/// Returns the code of the Error that `call` throws, or nothing.
template <typename Call>
std::optional<ErrorCode> code_of(const Call& call) {
    try {
        call();
    } catch (const Error& error) {
        EXPECT_FALSE(std::string(error.what()).empty());
        return error.code();
    }
    return std::nullopt;
}

/// Returns the message of the Error that `call` throws. Fails if `call` throws no Error, or an Error with another code.
template <typename Call>
std::string error_of(ErrorCode code, const Call& call) {
    try {
        call();
    } catch (const Error& error) {
        EXPECT_EQ(int(error.code()), int(code)) << error.what();
        return error.what();
    }
    ADD_FAILURE() << "nothing was thrown";
    return {};
}

/// Returns the message of the Error that `call` throws, or an empty text if the call succeeds. Fails if the code is another one.
template <typename Call>
std::string error_if_any(ErrorCode code, const Call& call) {
    try {
        call();
    } catch (const Error& error) {
        EXPECT_EQ(int(error.code()), int(code)) << error.what();
        return error.what();
    }
    return {};
}

/// Succeeds if `text` contains `part`. Otherwise reports both.
inline ::testing::AssertionResult has_text(const std::string& text, const std::string& part) {
    if (text.find(part) != std::string::npos) return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure() << "'" << part << "' is not in: " << text;
}

/// Fails unless `call` throws an Error that has `code` and whose message contains `words`.
template <typename Call>
void expect_error(ErrorCode code, const std::string& words, const Call& call) {
    EXPECT_TRUE(has_text(error_of(code, call), words));
}

/// Returns the place of the Error that `call` throws.
template <typename Call>
std::optional<ErrorPlace> place_of_error(const Call& call) {
    try {
        call();
        ADD_FAILURE() << "nothing was thrown";
    } catch (const Error& error) {
        return error.place();
    }
    return {};
}

template <typename Call>
void expect_place(const Call& call, std::uint64_t index, unsigned set) {
    const std::optional<ErrorPlace> place = place_of_error(call);
    ASSERT_TRUE(place);
    EXPECT_EQ(place->index, index);
    EXPECT_EQ(place->set, set);
    EXPECT_FALSE(place->frame);
}

/// Checks the errors of calls and, if the engine has jobs, of jobs.
inline void expect_places_of_errors(Engine& engine, bool jobs = true) {
    const std::vector<Box3f> good(5, Box3f{{0, 0, 0}, {1, 1, 1}});
    std::vector<Box3f> bad = good;
    bad[3].max[1] = std::numeric_limits<float>::quiet_NaN();
    const Objects good_objects{good, {}}, bad_objects{bad, {}};
    expect_place([&] { (void)engine.count_pairs(bad_objects); }, 3, 0);
    expect_place([&] { (void)engine.count_pairs(Join{bad_objects, good_objects}); }, 3, 0);
    expect_place([&] { (void)engine.count_pairs(Join{good_objects, bad_objects}); }, 3, 1);
    const std::vector<double> paddings = {0, 0, -1, 0, 0};
    expect_place([&] { (void)engine.count_pairs(Objects{good, paddings}); }, 2, 0);
    EXPECT_FALSE(place_of_error([&] { (void)engine.count_pairs(good_objects, {.margin = -1}); }));
    if (jobs) expect_place([&] { (void)engine.submit(bad).summary(); }, 3, 0);
}

}  // namespace octopair::test
