// Tests result files of pairs in each format.
#include "io/results/pair_writer.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <nlohmann/json.hpp>

#include "io/files/atomic_file.hpp"
#include "io/temporary.hpp"

namespace octopair::test {
namespace {

using Pairs = std::vector<Pair>;

void write_pairs(io::PairWriter& writer, const std::vector<Pairs>& frames) {
    for (std::size_t f = 0; f < frames.size(); ++f) {
        writer.begin_frame(f);
        for (std::size_t i = 0; i < frames[f].size(); i += 3) {
            writer.write(std::span(frames[f]).subspan(i, std::min<std::size_t>(3, frames[f].size() - i)));
        }
        writer.end_frame();
    }
    writer.finish();
}

Pairs read_npy_pairs(const std::string& path) {
    const std::string content = read_file(path);
    const auto header = io::parse_npy_header(std::as_bytes(std::span(content)), content.size(), path);
    EXPECT_EQ(header.type, io::NpyType::uint32);
    EXPECT_EQ(header.shape.size(), 2u);
    EXPECT_EQ(header.shape[1], 2u);
    Pairs pairs(header.shape[0]);
    if (!pairs.empty()) std::memcpy(pairs.data(), content.data() + header.data_offset, pairs.size() * sizeof(Pair));
    return pairs;
}

TEST(PairWriter, FramesAreNumberedInTheirNames) { EXPECT_EQ(io::frame_path("a.b/c.npy", 12), "a.b/c.000012.npy"); }

RC_GTEST_PROP(PairWriter, NpyAndCsvRoundTrip, (const std::vector<std::pair<std::uint32_t, std::uint32_t>>& raw)) {
    const TemporaryDirectory directory;
    Pairs pairs;
    std::string csv = "a,b\n";
    for (const auto& [a, b] : raw) {
        pairs.push_back({a * 2654435761u, b * 2246822519u});
        csv += std::to_string(pairs.back().a) + ',' + std::to_string(pairs.back().b) + '\n';
    }
    for (const std::string name : {"p.npy", "p.csv"}) {
        write_pairs(*io::make_file_writer(directory.file(name), false, {}), {pairs});
    }
    RC_ASSERT(read_npy_pairs(directory.file("p.npy")) == pairs);
    RC_ASSERT(read_file(directory.file("p.csv")) == csv);
}

TEST(PairWriter, WritesFrames) {
    const TemporaryDirectory directory;
    const std::vector<Pairs> frames = {{{0, 1}, {2, 3}}, {}, {{4, 4294967295u}}};
    for (const std::string name : {"p.npy", "p.csv", "p.jsonl"}) {
        write_pairs(*io::make_file_writer(directory.file(name), true, {}), frames);
    }
    EXPECT_EQ(directory.names(),
              (std::vector<std::string>{"p.000000.npy", "p.000001.npy", "p.000002.npy", "p.csv", "p.jsonl"}));
    for (std::size_t f = 0; f < 3; ++f) {
        EXPECT_EQ(read_npy_pairs(io::frame_path(directory.file("p.npy"), f)), frames[f]);
    }
    EXPECT_EQ(read_file(directory.file("p.csv")), "frame,a,b\n0,0,1\n0,2,3\n2,4,4294967295\n");
    EXPECT_EQ(read_file(directory.file("p.jsonl")),
              "{\"frame\":0,\"a\":0,\"b\":1}\n{\"frame\":0,\"a\":2,\"b\":3}\n{\"frame\":2,\"a\":4,\"b\":4294967295}\n");
}

TEST(PairWriter, NamesAreValidJson) {
    const TemporaryDirectory directory;
    const std::vector<std::string> names = {"plain", "quote\" slash\\ line\n\x01",
                                            "Gr\xc3\xb6\xc3\x9f"
                                            "e",
                                            "broken \xff\xc3", ""};
    const std::vector<std::string> others = {"of the other set"};
    write_pairs(*io::make_file_writer(directory.file("p.jsonl"), false, {&names, &names}), {{{0, 1}, {2, 3}, {3, 4}}});
    write_pairs(*io::make_file_writer(directory.file("q.jsonl"), false, {&names, &others}), {{{1, 0}}});
    std::istringstream lines(read_file(directory.file("p.jsonl")));
    std::vector<nlohmann::json> found;
    for (std::string line; std::getline(lines, line);) found.push_back(nlohmann::json::parse(line));
    ASSERT_EQ(found.size(), 3u);
    EXPECT_EQ(found[0], (nlohmann::json{{"a", 0}, {"b", 1}, {"a_name", names[0]}, {"b_name", names[1]}}));
    EXPECT_EQ(found[1]["a_name"], names[2]);
    EXPECT_EQ(found[1]["b_name"], "broken \xef\xbf\xbd\xef\xbf\xbd");
    EXPECT_FALSE(found[2].contains("b_name"));
    EXPECT_EQ(nlohmann::json::parse(read_file(directory.file("q.jsonl")))["b_name"], others[0]);
}

TEST(PairWriter, LeavesNothingUnlessFinished) {
    const TemporaryDirectory directory;
    for (const std::string name : {"p.npy", "p.csv", "p.jsonl"}) {
        const auto writer = io::make_file_writer(directory.file(name), false, {});
        writer->begin_frame(0);
        writer->write(Pairs(100'000, Pair{1, 2}));
        writer->end_frame();
    }
    EXPECT_EQ(directory.names(), std::vector<std::string>{});
}

}  // namespace
}  // namespace octopair::test
