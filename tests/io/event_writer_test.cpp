// Tests result files of events.
#include "io/results/pair_writer.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "io/files/atomic_file.hpp"
#include "io/temporary.hpp"

namespace octopair::test {
namespace {

using io::Event;
using io::ResultFormat;
using Pairs = std::vector<Pair>;

TEST(EventWriter, FormatsByEnding) {
    EXPECT_EQ(int(io::event_format("c.csv")), int(ResultFormat::csv));
    EXPECT_EQ(int(io::event_format("c.jsonl")), int(ResultFormat::jsonl));
    for (const std::string path : {"c.npy", "c", "c.json"}) {
        EXPECT_NE(error_of(ErrorCode::usage, [&] { (void)io::event_format(path); }), "") << path;
    }
    const TemporaryDirectory directory;
    error_of(ErrorCode::usage,
             [&] { io::EventWriter(ResultFormat::npy, std::make_unique<io::AtomicFile>(directory.file("e")), {}); });
}

TEST(EventWriter, WritesRowsWithNames) {
    const TemporaryDirectory directory;
    const std::vector<std::string> names = {"a \"name\"", ""}, others = {"", "other"};
    for (const std::string name : {"e.csv", "e.jsonl"}) {
        const std::string path = directory.file(name);
        io::EventWriter writer(io::event_format(path), std::make_unique<io::AtomicFile>(path), {&names, &others});
        writer.write(0, Event::begin, Pairs{{0, 1}, {1, 0}});
        writer.write(1, Event::end, Pairs{{0, 1}});
        writer.write(1, Event::begin, Pairs{});
        writer.write(1'000'000, Event::begin, Pairs{{1, 0}});
        EXPECT_FALSE(std::filesystem::exists(path));
        writer.finish();
    }
    EXPECT_EQ(read_file(directory.file("e.csv")),
              "frame,event,a,b\n0,begin,0,1\n0,begin,1,0\n1,end,0,1\n1000000,begin,1,0\n");
    EXPECT_EQ(read_file(directory.file("e.jsonl")),
              "{\"frame\":0,\"event\":\"begin\",\"a\":0,\"b\":1,\"a_name\":\"a \\\"name\\\"\",\"b_name\":\"other\"}\n"
              "{\"frame\":0,\"event\":\"begin\",\"a\":1,\"b\":0}\n"
              "{\"frame\":1,\"event\":\"end\",\"a\":0,\"b\":1,\"a_name\":\"a \\\"name\\\"\",\"b_name\":\"other\"}\n"
              "{\"frame\":1000000,\"event\":\"begin\",\"a\":1,\"b\":0}\n");
}

TEST(EventWriter, LargestNumbersFit) {
    const TemporaryDirectory directory;
    io::EventWriter writer(ResultFormat::csv, std::make_unique<io::AtomicFile>(directory.file("e.csv")), {});
    writer.write(~std::uint64_t(0), Event::begin, Pairs(100'000, {4294967294u, 4294967295u}));
    writer.finish();
    EXPECT_TRUE(read_file(directory.file("e.csv")).ends_with("\n18446744073709551615,begin,4294967294,4294967295\n"));
}

}  // namespace
}  // namespace octopair::test
