// Tests that a server reports an invalid call with the message of the local engine.
#include <gtest/gtest.h>

#include <limits>

#include "io/temporary.hpp"
#include "processes/asked.hpp"
#include "service/gate.hpp"
#include "service/served.hpp"
#include "support/kinds.hpp"

namespace octopair::test {
namespace {

constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();

std::string words_of(Engine& engine, const Scene& scene, const Asked& asked, ErrorCode& code) {
    try {
        (void)ask(engine, scene, asked);
    } catch (const Error& error) {
        code = error.code();
        return error.what();
    }
    ADD_FAILURE() << "nothing was thrown";
    return {};
}

class ServedErrors : public ::testing::Test {
protected:
    void expect_same(const Scene& scene, const Asked& asked) {
        SCOPED_TRACE(asked.describe());
        ErrorCode expected_code{}, code{};
        const std::string expected = words_of(*local_, scene, asked, expected_code);
        EXPECT_EQ(words_of(*remote_, scene, asked, code), expected);
        EXPECT_EQ(int(code), int(expected_code));
        EXPECT_TRUE(served_.comes_to_rest());
        check_serves(served_.address());
    }

    const Served served_;
    const std::unique_ptr<Engine> local_ = make_local_engine(2), remote_ = served_.client();
};

TEST_F(ServedErrors, OfABoxWithItsIndexInEitherSet) {
    for (const std::uint64_t objects : {std::uint64_t(40), std::uint64_t(60'000)}) {  // one message; several messages
        for (const bool wide : {false, true}) {
            Scene scene("uniform", objects, 1);
            scene.first[objects / 2 + 3].min[1] = not_a_number;
            scene.wide_first[objects / 2 + 3].min[1] = not_a_number;
            expect_same(scene, {.how = How::list, .wide = wide});
            expect_same(scene, {.how = How::stream, .join = true, .wide = wide});
            expect_same(scene, {.how = How::count, .wide = wide});
            Scene other("uniform", objects, 1);
            std::swap(other.second[7].min[0], other.second[7].max[0]);
            std::swap(other.wide_second[7].min[0], other.wide_second[7].max[0]);
            expect_same(other, {.how = How::list, .join = true, .wide = wide});
        }
    }
}

TEST_F(ServedErrors, OfPaddingsAndOptions) {
    Scene scene("uniform", 100, 1);
    scene.padding[99] = -1;
    expect_same(scene, {.how = How::list, .padded = true});
    scene.padding[99] = std::numeric_limits<double>::infinity();
    expect_same(scene, {.how = How::list, .padded = true});
    scene.padding.pop_back();
    expect_same(scene, {.how = How::list, .padded = true});
    expect_same(scene, {.how = How::list, .margin = -1});
    expect_same(scene, {.how = How::list, .margin = not_a_number});
}

TEST_F(ServedErrors, LeaveTheListEmpty) {
    const std::vector<Box3f> good = make_boxes("dense", 500, 1);
    std::vector<Box3f> bad = good;
    bad[499].max[2] = not_a_number;
    PairList list;
    (void)remote_->find_pairs({good}, list);
    ASSERT_GT(list.size(), 0u);
    EXPECT_THROW((void)remote_->find_pairs({bad}, list), Error);
    EXPECT_EQ(list.size(), 0u);
}

TEST_F(ServedErrors, OfSinksAndProgressReachTheCaller) {
    const Scene scene("dense", 60'000, 1);
    struct Own {};
    const PairSink sink = [](auto) { throw Own(); };
    EXPECT_THROW((void)remote_->stream_pairs(scene.objects({}), sink), Own);
    EXPECT_TRUE(served_.comes_to_rest());
    Options options;
    options.progress = [](double) { throw Own(); };
    EXPECT_THROW((void)remote_->count_pairs(scene.objects({}), options), Own);
    EXPECT_TRUE(served_.comes_to_rest());
    const std::vector<Box3f> few(20);
    EXPECT_THROW((void)remote_->stream_pairs({few}, sink), Own);
    EXPECT_THROW((void)remote_->count_pairs({few}, options), Own);
    check_serves(served_.address());
}

TEST(ServedFailures, DoNotNameFoldersOfTheServer) {
    Gate gate;
    const Served served([&](service::ServerOptions& options) { options.engine = gated_engines(gate); });
    gate.fail("worker processes end at their start, with a signal: /opt/secret place/libexec/octopair-worker");
    const std::vector<Box3f> boxes(3);
    EXPECT_EQ(error_of(ErrorCode::engine_failed, [&] { (void)served.client()->count_pairs({boxes}); }),
              "worker processes end at their start, with a signal: octopair-worker");
}

TEST_F(ServedErrors, HaveTheirPlaces) { expect_places_of_errors(*remote_); }

}  // namespace
}  // namespace octopair::test
