// Tests model streams, and the programs that write them. The streams are made by the writer of octopair-step, which shares no code with the
// reader.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "../../readers/step/stream_writer.hpp"
#include "base/descriptor.hpp"
#include "io/meshes/stream/model_stream.hpp"
#include "io/meshes/stream/reader_program.hpp"
#include "io/scene_reader.hpp"
#include "io/temporary.hpp"
#include "samples/random.hpp"
#include "support/cases.hpp"

namespace octopair::test {
namespace {

using io::Detail;
using io::LoadedScene;
using reader::LostCounts;
using reader::StreamedShape;
using reader::StreamWriter;

constexpr std::array<double, 16> unmoved = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

std::array<double, 16> shifted(double x, double y, double z) {
    std::array<double, 16> transform = unmoved;
    transform[3] = x, transform[7] = y, transform[11] = z;
    return transform;
}

const StreamedShape streamed_tetrahedron = {
    0.25, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {9, 9, 9}}, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};

const io::SceneContent with_shapes = {.shapes = true};

class ModelStreams : public ::testing::Test {
protected:
    /// Returns the bytes that `write` makes.
    template <typename Write>
    std::string bytes_of(const Write& write) const {
        const std::string path = folder_.file("bytes");
        const Descriptor file(::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600));
        StreamWriter writer(file.number());
        write(writer);
        return read_file(path);
    }

    /// Returns a stream of two walls that share a shape, and of a door in the first.
    std::string house() const {
        return bytes_of([](StreamWriter& writer) {
            writer.model("mm", "z", "project");
            const std::uint32_t wall = writer.shape(streamed_tetrahedron);
            writer.element("IfcWall w1");
            writer.instance({.shape = wall,
                             .transform = unmoved,
                             .name = "level/w1",
                             .label = "Wall 1",
                             .type = "IfcWall",
                             .id = "w1",
                             .parent = "Level 1",
                             .level = "Level 1",
                             .material = "brick"});
            writer.instance({.shape = wall,
                             .transform = shifted(100, 0, 0),
                             .name = "level/w2",
                             .label = "Wall 2",
                             .type = "IfcWall",
                             .id = "w2",
                             .systems = {"s1", "s2"}});
            const std::uint32_t door = writer.shape({0, streamed_tetrahedron.vertices, {{0, 1, 2}}});
            writer.instance(
                {.shape = door, .transform = unmoved, .name = "level/d", .id = "d", .host = "w1", .assembly = "w2"});
            writer.warning("a roof has no thickness");
            LostCounts lost;
            lost.add("IFCROOF", "r1");
            lost.add("IFCROOF", "r2");
            writer.end(5, 3, lost);
        });
    }

    LoadedScene read(const std::string& bytes, const io::SceneContent& content = with_shapes) const {
        std::size_t at = 0;
        const io::ByteSource source = [&](std::span<std::byte> piece) {
            const std::size_t size = std::min(piece.size(), bytes.size() - at);
            std::memcpy(piece.data(), bytes.data() + at, size);
            at += size;
            return size;
        };
        io::ReadBudget budget(stream_, {});
        budget.add_file(bytes.size());
        io::ElementInHand in_hand;
        return io::read_model_stream(source, content, budget, in_hand);
    }
    std::string refusal(const std::string& bytes, ErrorCode code = ErrorCode::bad_input) const {
        return error_of(code, [&] { (void)read(bytes); });
    }
    /// Returns the refusal of a stream that begins with a model.
    template <typename Write>
    std::string refusal_after_model(const Write& write) const {
        return refusal(bytes_of([&](StreamWriter& writer) {
            writer.model("m", "", "");
            write(writer);
            writer.end(0, 0, {});
        }));
    }

    TemporaryDirectory folder_;
    std::string stream_ = folder_.file("model.opmodel");
};

TEST_F(ModelStreams, SayWhatAnElementIs) {
    const LoadedScene scene = read(house());
    EXPECT_EQ(scene.names, (std::vector<std::string>{"level/w1", "level/w2", "level/d"}));
    EXPECT_EQ(scene.details.of(0, Detail::label), "Wall 1");
    EXPECT_EQ(scene.details.of(0, Detail::material), "brick");
    EXPECT_EQ(scene.details.of(0, Detail::level), "Level 1");
    EXPECT_EQ(scene.details.of(2, Detail::id), "d");
    EXPECT_EQ(scene.space, (io::SceneSpace{io::UpAxis::z, "mm"}));
    EXPECT_EQ(scene.project, "project");
    EXPECT_EQ(scene.chord, 0.25);
    EXPECT_EQ(scene.warnings,
              (std::vector<std::string>{
                  stream_ + ": a roof has no thickness",
                  stream_ + ": 2 of 5 elements with geometry were not read: 2 IFCROOF, the first is r1"}));
    EXPECT_EQ(scene.elements.with_geometry, 5u);
    EXPECT_EQ(scene.elements.read, 3u);
    ASSERT_EQ(scene.elements.lost.size(), 1u);
    EXPECT_EQ(scene.elements.lost[0].count, 2u);
    EXPECT_EQ(scene.elements.lost[0].first, "r1");
}

TEST_F(ModelStreams, ShareShapes) {
    const LoadedScene scene = read(house());
    ASSERT_TRUE(scene.shapes);
    EXPECT_EQ(scene.shapes->shapes.size(), 2u);
    EXPECT_EQ(scene.shapes->geometry, (std::vector<std::uint32_t>{0, 0, 1}));
    const auto& boxes = std::get<Buffer<Box3d>>(scene.boxes);
    EXPECT_EQ(boxes[1].min[0], 100);
    EXPECT_EQ(boxes[1].max[0], 101);  // the vertex that no triangle has does not count
}

TEST_F(ModelStreams, RelateElements) {
    const io::ObjectRelations relations = read(house()).relations;
    const auto has = [&](io::Relation relation, const std::string& from, const std::string& to) {
        const auto& links = relations.links[std::size_t(relation)];
        return std::any_of(links.begin(), links.end(), [&](const io::Link& link) {
            return relations.keys[link.from] == "project/" + from && relations.keys[link.to] == "project/" + to;
        });
    };
    EXPECT_TRUE(has(io::Relation::fills, "d", "w1"));
    EXPECT_TRUE(has(io::Relation::assembly, "d", "w2"));
    EXPECT_TRUE(has(io::Relation::system, "w2", "s1") && has(io::Relation::system, "w2", "s2"));
    EXPECT_EQ(relations.keys[relations.elements[1]], "project/w2");
}

TEST_F(ModelStreams, AreReadFromFilesInAnotherUnit) {
    write_file(stream_, house());
    const LoadedScene scene = io::read_scene(stream_, {.shapes = true, .unit = "m"});
    EXPECT_EQ(std::get<Buffer<Box3d>>(scene.boxes)[1].min[0], 0.1);
    EXPECT_EQ(scene.chord, 0.00025);
    EXPECT_EQ(scene.converted_from, "mm");
}

TEST_F(ModelStreams, GiveTriangles) {
    const LoadedScene scene = read(house(), {.objects = io::MeshObjects::triangle, .shapes = true});
    EXPECT_EQ(scene.objects, 9u);
    EXPECT_EQ(scene.triangles->owner_details.of(0, Detail::label), "Wall 1");
}

TEST_F(ModelStreams, ThatAreCutAreRefused) {
    const std::string whole = house();
    for (std::size_t size = 1; size < whole.size(); ++size) {
        const std::string words = refusal(whole.substr(0, size));
        EXPECT_EQ(words.find(stream_ + ": "), 0u) << words;
    }
    EXPECT_TRUE(has_text(refusal(whole + "x"), "goes on after its last record"));
}

TEST_F(ModelStreams, WithAnyByteChangedAreReadOrRefused) {
    const std::string whole = house();
    for (std::uint64_t i = 0; i < case_count(5000); ++i) {
        samples::RandomStream random(59, i);
        std::string changed = whole;
        for (std::uint64_t k = 0; k <= random.below(3); ++k)
            changed[random.below(changed.size())] = char(random.below(256));
        try {
            (void)read(changed);
        } catch (const Error& error) {
            const bool clear = error.code() == ErrorCode::bad_input || error.code() == ErrorCode::resource_limit;
            EXPECT_TRUE(clear && std::string(error.what()).find('\n') == std::string::npos)
                << i << ": " << error.what();
        }
    }
}

/// Appends the bytes of a value.
template <typename T>
void append_bytes(std::string& bytes, const T& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

std::string stream_record(std::uint32_t kind, const std::string& content, std::uint64_t length) {
    std::string bytes;
    append_bytes(bytes, kind);
    append_bytes(bytes, length);
    return bytes + content;
}

TEST_F(ModelStreams, DoNotFillTheMemoryByNumbersThatLie) {
    const std::string model = bytes_of([](StreamWriter& writer) {
        writer.model("m", "", "");
        writer.element("");  // goes out at once
    });
    std::string shape;
    append_bytes(shape, 0.0);
    append_bytes(shape, std::uint32_t(4'000'000'000));
    append_bytes(shape, std::uint32_t(1));
    EXPECT_TRUE(has_text(refusal(model + stream_record(2, shape, shape.size())), "shorter than its numbers say"));
    EXPECT_TRUE(has_text(refusal(model + stream_record(2, shape, std::uint64_t(1) << 62), ErrorCode::resource_limit),
                         "needs more than"));
    shape.resize(8);
    append_bytes(shape, std::uint32_t(10'000'000));
    append_bytes(shape, std::uint32_t(1));
    EXPECT_TRUE(has_text(refusal(model + stream_record(2, shape, std::uint64_t(1) << 40)), "ends early"));
}

TEST_F(ModelStreams, MayHaveRecordsOfLaterVersions) {
    const std::string model = bytes_of([](StreamWriter& writer) {
        writer.model("m", "", "");
        writer.element("");
    });
    const std::string end = house().substr(house().size() - (12 + 8 + 8 + 4 + (4 + 7) + 8 + (4 + 2) + 4));
    EXPECT_EQ(read(model + stream_record(4711, "anything", 8) + end).objects, 0u);
}

TEST_F(ModelStreams, ThatContradictThemselvesAreRefused) {
    EXPECT_TRUE(has_text(refusal(bytes_of([](StreamWriter& writer) { writer.end(0, 0, {}); })), "does not begin with"));
    EXPECT_TRUE(
        has_text(refusal_after_model([](StreamWriter& writer) { writer.model("m", "", ""); }), "second record"));
    EXPECT_TRUE(has_text(refusal(bytes_of([](StreamWriter& writer) {
                             writer.model("cubits", "", "");
                             writer.end(0, 0, {});
                         })),
                         "unknown unit 'cubits'"));
    const auto instance_at = [&](const std::array<double, 16>& transform, std::uint32_t shape) {
        return refusal_after_model([&](StreamWriter& writer) {
            (void)writer.shape(streamed_tetrahedron);
            writer.instance({.shape = shape, .transform = transform, .name = "x"});
        });
    };
    EXPECT_TRUE(has_text(instance_at(unmoved, 1), "shape 1, which it has not"));
    EXPECT_TRUE(has_text(instance_at(shifted(std::numeric_limits<double>::infinity(), 0, 0), 0), "not finite"));
    std::array<double, 16> projective = unmoved;
    projective[12] = 1;
    EXPECT_TRUE(has_text(instance_at(projective, 0), "0 0 0 1"));
    const auto shape_of = [&](const StreamedShape& shape) {
        return refusal_after_model([&](StreamWriter& writer) { (void)writer.shape(shape); });
    };
    EXPECT_TRUE(has_text(shape_of({0, {{0, 0, 0}}, {{0, 0, 1}}}), "beyond its 1"));
    EXPECT_TRUE(has_text(shape_of({0, {{0, 0, std::numeric_limits<double>::quiet_NaN()}}, {{0, 0, 0}}}), "not finite"));
    EXPECT_TRUE(has_text(shape_of({-1, {{0, 0, 0}}, {{0, 0, 0}}}), "no length"));
    std::string other = house();
    other[8] = 2;
    EXPECT_TRUE(has_text(refusal(other), "version 2; octopair reads version 1"));
}

/// Programs that read a file: scripts of the shell.
class ReaderPrograms : public ModelStreams {
protected:
    ReaderPrograms() { write_file(input_, "a model"); }

    LoadedScene read_with(const std::string& script, std::chrono::seconds patience = std::chrono::seconds(100),
                          const std::stop_token& stop = {}, std::optional<std::uint64_t> memory = {}) const {
        write_file(folder_.file("script"), script);
        io::SceneContent content = with_shapes;
        content.reader.command = "exec /bin/sh '" + folder_.file("script") + "'";
        content.reader.patience = patience;
        content.reader.memory = memory;
        return io::read_scene(input_, content, stop);
    }
    std::string refusal_with(const std::string& script) const {
        return error_of(ErrorCode::bad_input, [&] { (void)read_with(script); });
    }
    /// Returns the name of a file with a stream that stops after the element in hand.
    std::string begun() const {
        write_file(folder_.file("begun"), bytes_of([](StreamWriter& writer) {
                       writer.model("m", "", "");
                       writer.element("IfcWall w1 ('Wall')");
                   }));
        return folder_.file("begun");
    }

    std::string input_ = folder_.file("model.foo");
};

TEST_F(ReaderPrograms, ReadFiles) {
    write_file(folder_.file("house"), house());
    const LoadedScene scene = read_with("test \"$1\" = '" + input_ + "' && cat '" + folder_.file("house") + "'");
    EXPECT_EQ(scene.objects, 3u);
    EXPECT_EQ(scene.warnings.front(), input_ + ": a roof has no thickness");
}

TEST_F(ReaderPrograms, ThatFailAreNamedWithTheElementInHand) {
    EXPECT_EQ(refusal_with("echo first >&2; echo the disk is full >&2; exit 3"),
              input_ + ": sh failed with the status 3 (the disk is full)");
    EXPECT_EQ(refusal_with("cat '" + begun() + "'; kill -SEGV $$"),
              input_ + ": sh ended with the signal Segmentation fault, while it read IfcWall w1 ('Wall')");
    EXPECT_TRUE(has_text(refusal_with("cat '" + begun() + "'"), "ends early"));
    EXPECT_TRUE(has_text(refusal_with("echo no stream at all, but a text"), "is no model stream"));
    write_file(folder_.file("house"), house());
    EXPECT_TRUE(has_text(refusal_with("cat '" + folder_.file("house") + "'; exit 1"), "failed with the status 1"));
}

TEST_F(ReaderPrograms, ThatWriteNothingAreEnded) {
    const std::string words = error_of(ErrorCode::resource_limit, [&] {
        (void)read_with("echo $$ > '" + folder_.file("id") + "'; exec sleep 1000", std::chrono::seconds(1));
    });
    EXPECT_TRUE(has_text(words, "has written nothing for 1 seconds"));
    EXPECT_NE(::kill(std::stoi(read_file(folder_.file("id"))), 0), 0);
}

/// The program that fills the memory is not the shell, but one that the shell started.
TEST_F(ReaderPrograms, ThatFillTheMemoryAreEnded) {
    write_file(folder_.file("inner"), "echo $$ > '" + folder_.file("id") + "'; exec tail /dev/zero");
    const std::string script = "/bin/sh '" + folder_.file("inner") + "' & wait";
    const std::string words = error_of(ErrorCode::resource_limit, [&] {
        (void)read_with(script, std::chrono::seconds(100), {}, std::uint64_t(64) << 20);
    });
    EXPECT_TRUE(has_text(words, "sh needs more than 67108864 bytes of memory"));
    // init waits for a process whose parent has ended.
    const pid_t id = std::stoi(read_file(folder_.file("id")));
    const auto is_gone = [&] {
        std::ifstream state("/proc/" + std::to_string(id) + "/stat");
        std::string line;
        return !std::getline(state, line) || line.find(") Z") != std::string::npos;
    };
    while (!is_gone()) std::this_thread::yield();
}

TEST_F(ReaderPrograms, ThatCloseTheirOutputAndGoOnAreEnded) {
    (void)error_of(ErrorCode::resource_limit,
                   [&] { (void)read_with("cat '" + begun() + "'; exec sleep 1000 >&-", std::chrono::seconds(1)); });
}

TEST_F(ReaderPrograms, AreStopped) {
    std::stop_source stop;
    std::thread other([&] {
        while (!std::filesystem::exists(folder_.file("id"))) std::this_thread::sleep_for(std::chrono::milliseconds(5));
        stop.request_stop();
    });
    const std::string script = "echo $$ > '" + folder_.file("part") + "'; mv '" + folder_.file("part") + "' '" +
                               folder_.file("id") + "'; exec sleep 1000";
    (void)error_of(ErrorCode::cancelled,
                   [&] { (void)read_with(script, std::chrono::seconds(1000), stop.get_token()); });
    other.join();
    EXPECT_NE(::kill(std::stoi(read_file(folder_.file("id"))), 0), 0);
}

}  // namespace
}  // namespace octopair::test
