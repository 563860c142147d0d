// Tests messages that octopair's client never sends: the server refuses the call with a clear message and continues.
#include <gtest/gtest.h>

#include <limits>

#include "processes/leftovers.hpp"
#include "service/gate.hpp"
#include "service/metrics_page.hpp"
#include "service/protocol/job_hash.hpp"
#include "service/protocol/messages.hpp"
#include "service/raw_call.hpp"
#include "service/served.hpp"
#include "service/server/calls/job_messages.hpp"

namespace octopair::test {
namespace {

using v1::JobSpec;

class ServedMessages : public ::testing::Test {
protected:
    ~ServedMessages() override {
        gate_.open();
        EXPECT_TRUE(served_.comes_to_rest());
        check_serves(served_.address());
    }

    grpc::Status send(const std::vector<grpc::ByteBuffer>& messages) {
        RawCall call(channel_);
        for (const auto& message : messages) {
            if (!call.write(message)) break;
        }
        (void)call.writes_done();
        return call.finish();
    }
    void expect_bad(const grpc::Status& status, const std::string& words) {
        EXPECT_EQ(int(failure_in(status).code()), int(v1::BAD_INPUT)) << status.error_message();
        EXPECT_TRUE(has_text(status.error_message(), words));
    }

    Gate gate_;
    const Served served_{[this](service::ServerOptions& options) {
        options.engine = gated_engines(gate_);
        options.engine_widths = {1, 1, 0};
    }};
    const std::shared_ptr<grpc::Channel> channel_ = open_channel(served_.address());
    const JobSpec spec_ = spec_of(10);
};

std::string hex_of(const grpc::ByteBuffer& message) {
    std::vector<grpc::Slice> slices;
    EXPECT_TRUE(message.Dump(&slices).ok());
    std::string text;
    for (const grpc::Slice& slice : slices) {
        for (const std::uint8_t byte : slice) {
            constexpr std::string_view digits = "0123456789ABCDEF";
            text += {digits[byte >> 4], digits[byte & 15]};
        }
    }
    return text;
}

/// Compares messages with the example in docs/protocol.md, byte by byte.
TEST(Messages, AreThoseOfTheExample) {
    const std::vector<Box3f> boxes = {{{0, 0, 0}, {1, 1, 1}}, {{1, 0, 0}, {2, 1, 1}}};
    const auto data = std::as_bytes(std::span(boxes));
    v1::Upload upload;
    upload.mutable_spec()->set_id("6f1c0c1e-2f0a-4d7b-8a3e-5b9d1c2e3f40");
    upload.mutable_spec()->mutable_first()->set_objects(2);
    EXPECT_EQ(hex_of(service::pack(upload, grpc::Slice(data.data(), data.size()))),
              "0A2A"
              "0A2436663163306331652D326630612D346437622D386133652D356239643163326533663430"
              "12020802"
              "7A30"
              "0000000000000000000000000000803F0000803F0000803F"
              "0000803F0000000000000000000000400000803F0000803F");
    service::JobHash hash(upload.spec());
    hash.add(data);
    v1::Download download;
    download.mutable_head()->set_hash(hash.digest());
    download.mutable_head()->set_algorithm(service::algorithm_version);
    download.set_progress(1);
    download.mutable_summary()->set_pairs(1);
    download.mutable_summary()->set_entries(2);
    const Pair pair = {0, 1};
    EXPECT_EQ(hex_of(service::pack(download, grpc::Slice(&pair, sizeof(pair)))),
              "0A14"
              "0A104E6D61FE7C48AF4F2FBCBCB7FAA51892"
              "1001"
              "11000000000000F03F"
              "1A0408011802"
              "7A080000000001000000");
}

/// Ignores all input.
struct NoInput : service::InputTarget {
    void append(std::span<const std::byte>) override {}
    std::uint64_t missing() const override { return 0; }
};

TEST(Messages, KeepNothingThatIsUnknown) {
    v1::Upload upload;
    v1::JobSpec& spec = *upload.mutable_spec();
    spec.GetReflection()->MutableUnknownFields(&spec)->AddLengthDelimited(99, std::string(1'000'000, 'x'));
    grpc::ByteBuffer message = service::pack(upload, grpc::Slice());
    ASSERT_GT(message.Length(), 1'000'000u);
    NoInput target;
    std::size_t kept = 0;
    service::Upload reader([&](v1::JobSpec known) -> service::InputTarget& {
        kept = known.ByteSizeLong();
        return target;
    });
    reader.take(message);
    EXPECT_LT(kept, 100u);
}

TEST_F(ServedMessages, UploadsThatEndEarly) {
    expect_bad(send({}), "before it sent a job spec");
    expect_bad(send({upload_of(&spec_, {})}), "240 bytes before");
    expect_bad(send({upload_of(&spec_, bytes_of_boxes(9)), upload_of(nullptr, "12345")}), "19 bytes before");
    expect_bad(call_small(channel_, upload_of(&spec_, bytes_of_boxes(9))), "24 bytes before");
}

TEST_F(ServedMessages, MoreDataThanSaid) {
    const auto all = upload_of(&spec_, bytes_of_boxes(10)), more = upload_of(nullptr, "x");
    expect_bad(send({upload_of(&spec_, bytes_of_boxes(11))}), "more bytes");
    expect_bad(send({upload_of(&spec_, bytes_of_boxes(9)), upload_of(nullptr, bytes_of_boxes(2))}), "more bytes");
    expect_bad(call_small(channel_, upload_of(&spec_, bytes_of_boxes(11))), "more bytes");
    RawCall running(channel_);
    ASSERT_TRUE(running.write(all));
    ASSERT_TRUE(gate_.wait_for(1));
    ASSERT_TRUE(running.write(more));
    expect_bad(running.finish(), "more bytes");
    RawCall queued(channel_), before(channel_);
    ASSERT_TRUE(before.write(upload_of(&spec_, bytes_of_boxes(10))));
    ASSERT_TRUE(gate_.wait_for(1));
    const JobSpec other = spec_of(1);
    ASSERT_TRUE(queued.write(upload_of(&other, bytes_of_boxes(1))));
    ASSERT_TRUE(queued.write(more));
    expect_bad(queued.finish(), "more bytes");
}

/// The input is already released, and the call is still open, because the client has not read its result. The client reads on when the
/// server has counted the late message.
TEST(ServedMessagesAfterTheJob, DataAndTheEnd) {
    const TemporaryDirectory folder;
    std::ostringstream log;
    service::ServerOptions options = options_at("unix:" + folder.file("socket"));
    options.metrics = service::parse_address("localhost:0");
    const service::Server server(options, log_to(log));
    const std::vector<Box3f> boxes(2000);  // 16 MB of pairs
    const JobSpec crowd = spec_of(boxes.size());
    const grpc::ByteBuffer all = upload_of(&crowd, bytes_of(boxes)), nothing = upload_of(nullptr, {});
    std::size_t sent = 0;
    for (const auto& late : {upload_of(nullptr, "x"), nothing, upload_of(&crowd, {})}) {
        RawCall call(open_channel(server.address().text()));
        ASSERT_TRUE(call.write(all));
        ASSERT_TRUE(call.read());
        ASSERT_TRUE(comes_true([&] { return server.load().jobs == 0; }, std::chrono::minutes(1)));
        ASSERT_TRUE(call.write(late));
        sent += all.Length() + late.Length();
        ASSERT_TRUE(page_has(log, "octopair_received_bytes_total " + std::to_string(sent)));
        (void)call.writes_done();
        const grpc::Status status = call.finish();
        EXPECT_EQ(status.ok(), late.Length() == nothing.Length()) << status.error_message();
    }
    check_serves(server.address().text());
}

TEST_F(ServedMessages, JobsOutOfPlace) {
    const auto data = upload_of(nullptr, bytes_of_boxes(1)), job = upload_of(&spec_, bytes_of_boxes(1));
    expect_bad(send({data}), "the first message has no job spec");
    expect_bad(send({upload_of(nullptr, {})}), "the first message has no job spec");
    expect_bad(send({job, job}), "a second job");
    expect_bad(call_small(channel_, data), "the first message has no job spec");
}

TEST_F(ServedMessages, SpecsThatMakeNoSense) {
    const auto refused = [&](const std::function<void(JobSpec&)>& change, const std::string& words) {
        JobSpec spec = spec_;
        change(spec);
        expect_bad(send({upload_of(&spec, bytes_of_boxes(10))}), words);
    };
    refused([](JobSpec& spec) { spec.clear_id(); }, "UUID");
    refused([](JobSpec& spec) { spec.set_id(std::string(100'000, 'a')); }, "UUID");
    refused([](JobSpec& spec) { spec.set_id("../../../../../../../../../etc/passwd"); }, "UUID");
    refused([](JobSpec& spec) { spec.set_order(v1::Order(7)); }, "order 7");
    refused([](JobSpec& spec) { spec.mutable_first()->set_precision(v1::Precision(9)); }, "precision 9");
    refused([](JobSpec& spec) { spec.mutable_second()->set_precision(v1::Precision(-1)); }, "precision -1");
    refused([](JobSpec& spec) { spec.set_margin(-1); }, "margin");
    refused([](JobSpec& spec) { spec.set_margin(std::numeric_limits<double>::quiet_NaN()); }, "margin");
    refused([](JobSpec& spec) { spec.set_margin(std::numeric_limits<double>::infinity()); }, "margin");
}

TEST_F(ServedMessages, Garbage) {
    std::vector<std::string> messages = {
        std::string(1, '\0'),      "\xff",
        std::string(100, '\xff'),  "\x0a\xff\xff\xff\xff\x07",
        std::string(1000, '\x0b'), "\x7a\x05xx",
        "\x0a\x03\x0a\x01\xff",    std::string("\x0a\x02\x08\x01\x7a\xff\xff\xff\xff\x0f", 10)};
    for (const std::string& message : messages) {
        expect_bad(send({buffer_of(message)}), "");
        expect_bad(send({upload_of(&spec_, {}), buffer_of(message)}), "");
        expect_bad(call_small(channel_, buffer_of(message)), "");
    }
    const auto large = buffer_of(std::string(service::max_message_bytes + 1, 'x'));
    EXPECT_EQ(call_small(channel_, large).error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
    EXPECT_FALSE(send({large}).ok());
}

TEST_F(ServedMessages, PiecesOfAnySize) {
    gate_.open();
    const std::string data = bytes_of(std::vector<Box3f>(10));
    for (const std::size_t size : {1, 7, 24, 100, 239, 240}) {
        std::vector<grpc::ByteBuffer> messages = {upload_of(&spec_, {})};
        for (std::size_t at = 0; at < data.size(); at += size)
            messages.push_back(upload_of(nullptr, data.substr(at, size)));
        messages.push_back(upload_of(nullptr, {}));
        EXPECT_TRUE(send(messages).ok());
    }
}

TEST_F(ServedMessages, OffsetsBeyondTheResult) {
    gate_.open();
    for (const std::uint64_t offset : {std::uint64_t(45), std::uint64_t(46), ~std::uint64_t(0)}) {
        JobSpec spec = spec_;
        spec.set_offset(offset);
        RawCall call(channel_);
        ASSERT_TRUE(call.write(upload_of(&spec, bytes_of(std::vector<Box3f>(10)))));
        std::uint64_t pairs = 0;
        while (auto message = call.read()) {
            v1::Download small;
            EXPECT_TRUE(service::unpack(*message, small, [&](auto piece) { pairs += piece.size(); }));
        }
        EXPECT_EQ(pairs, 0u);
        EXPECT_TRUE(call.finish().ok());
    }
}

TEST_F(ServedMessages, AJobThatComesTwice) {
    RawCall first(channel_), again(channel_), other(channel_);
    ASSERT_TRUE(first.write(upload_of(&spec_, bytes_of_boxes(10))));
    ASSERT_TRUE(gate_.wait_for(1));
    ASSERT_TRUE(other.write(upload_of(&spec_, std::string(240, '\0'))));
    expect_bad(other.finish(), "already exists");
    ASSERT_TRUE(again.write(upload_of(&spec_, bytes_of_boxes(10))));
    EXPECT_EQ(first.finish().error_code(), grpc::StatusCode::CANCELLED);
    gate_.open();
    EXPECT_TRUE(again.finish().ok());
}

TEST_F(ServedMessages, MethodsThatAreNone) {
    RawCall none(channel_, "Nothing"), empty(channel_, "");
    EXPECT_EQ(none.finish().error_code(), grpc::StatusCode::UNIMPLEMENTED);
    EXPECT_EQ(empty.finish().error_code(), grpc::StatusCode::UNIMPLEMENTED);
}

}  // namespace
}  // namespace octopair::test
