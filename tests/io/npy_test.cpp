// Tests .npy arrays as scenes and paddings.
#include "io/boxes/npy.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>

#include "io/temporary.hpp"
#include "support/calls.hpp"

namespace octopair::test {
namespace {

using io::LoadedScene;
using io::NpyType;

constexpr const char* truncated = ": the file was truncated while it was read";
constexpr const char* changed = ": the file changed while it was read; run again when no program writes to it";

class Npy : public ::testing::Test {
protected:
    std::string save(const std::string& content) const {
        const std::string path = directory_.file("a.npy");
        write_file(path, content);
        return path;
    }
    std::string refusal(const std::string& content) const {
        const std::string path = save(content);
        const std::string words = error_of(ErrorCode::bad_input, [&] { (void)io::read_npy_scene(path); });
        EXPECT_TRUE(words.starts_with(path + ": ")) << words;
        return words.substr(std::min(words.size(), path.size() + 2));
    }

    TemporaryDirectory directory_;
};

TEST_F(Npy, ReadsBoxesOfBothPrecisions) {
    std::vector<float> floats(18);
    std::vector<double> doubles(18);
    for (int i = 0; i < 18; ++i) doubles[i] = double(floats[i] = float(i) * 0.3f);
    const LoadedScene narrow = io::read_npy_scene(save(npy_of(NpyType::float32, {3, 6}, floats)));
    const LoadedScene wide = io::read_npy_scene(save(npy_of(NpyType::float64, {3, 6}, doubles)));
    for (const LoadedScene* scene : {&narrow, &wide}) {
        EXPECT_EQ(scene->objects, 3u);
        EXPECT_EQ(scene->frames, 1u);
        EXPECT_FALSE(scene->moving);
        EXPECT_TRUE(scene->names.empty());
    }
    EXPECT_EQ(std::get<Buffer<Box3f>>(narrow.boxes)[2].max[1], floats[16]);
    EXPECT_EQ(std::get<Buffer<Box3d>>(wide.boxes)[2].max[1], doubles[16]);
}

/// Boxes of a file of `objects` objects, mapped whatever their size.
LoadedScene map_rows(const std::string& path, const io::ObjectRows& rows) {
    return io::NpyScene(path).read(rows, {}, 1);
}

template <typename Real>
std::span<const Box<Real>> boxes_of(const LoadedScene& scene) {
    return std::get<Buffer<Box<Real>>>(scene.boxes).span();
}

TEST_F(Npy, MapsRows) {
    constexpr std::uint64_t objects = 5000;
    std::vector<float> floats(objects * 6);
    for (std::size_t i = 0; i < floats.size(); ++i) floats[i] = float(i);
    const std::vector<double> doubles(floats.begin(), floats.end());
    const std::string narrow = save(npy_of(NpyType::float32, {objects, 6}, floats)), wide = directory_.file("wide.npy");
    write_file(wide, npy_of(NpyType::float64, {objects, 6}, doubles));
    // More rounds than there are slots, so that slots are used again.
    for (std::uint64_t begin = 0; begin < objects; begin += 41) {
        const io::ObjectRows rows{begin, std::min(objects, begin + 1000)};
        LoadedScene scene = map_rows(narrow, rows);
        EXPECT_EQ(scene.objects, rows.end - rows.begin);
        EXPECT_EQ(boxes_of<float>(scene).size(), scene.objects);
        EXPECT_EQ(boxes_of<float>(scene).front().min[0], float(6 * begin));
        EXPECT_EQ(boxes_of<float>(scene).back().max[2], float(6 * rows.end - 1));
        scene = map_rows(wide, rows);
        EXPECT_EQ(boxes_of<double>(scene).front().min[0], double(6 * begin));
        EXPECT_EQ(boxes_of<double>(scene).back().max[2], double(6 * rows.end - 1));
        EXPECT_NO_THROW(scene.check_mapped());
    }
}

TEST_F(Npy, ReadsRowsIfNoMoreCanBeMapped) {
    const std::string path = save(npy_of(NpyType::float32, {3, 6}, std::vector<float>(18, 2)));
    std::vector<LoadedScene> scenes;
    for (unsigned i = 0; i < 70; ++i) scenes.push_back(map_rows(path, {0, 3}));
    for (const LoadedScene& scene : scenes) EXPECT_EQ(boxes_of<float>(scene)[2].max[2], 2);
}

TEST_F(Npy, RefusesAMappedFileThatBecomesShorter) {
    constexpr std::uint64_t objects = 100'000;
    const std::string path = save(npy_of(NpyType::float32, {objects, 6}, std::vector<float>(6 * objects, 1)));
    const LoadedScene scene = map_rows(path, {0, objects}), other = map_rows(path, {0, 10});
    std::filesystem::resize_file(path, 1'000'000);
    const auto boxes = boxes_of<float>(scene);
    EXPECT_EQ(boxes[30'000].min[0], 1);
    EXPECT_TRUE(std::isnan(boxes[objects - 1].min[0]));
    EXPECT_TRUE(std::isnan(boxes[50'000].max[2]));
    for (const LoadedScene* mapped : {&scene, &other})
        EXPECT_EQ(error_of(ErrorCode::bad_input, [&] { mapped->check_mapped(); }), path + truncated);
}

/// A file, and the ways in which other programs may change it while it is mapped.
class MappedNpy : public Npy {
protected:
    static constexpr std::uint64_t objects = 1000, bytes = 128 + objects * sizeof(Box3f);

    MappedNpy() { write_file(path_, content_); }
    /// Waits until the system's clock gives a change another time than the creation of the file.
    void wait_for_another_time() const {
        struct stat before {
        }, now{};
        ASSERT_EQ(::stat(path_.c_str(), &before), 0);
        const std::string other = directory_.file("clock");
        do {
            write_file(other, "tick");
            ASSERT_EQ(::stat(other.c_str(), &now), 0);
        } while (now.st_ctim.tv_sec == before.st_ctim.tv_sec && now.st_ctim.tv_nsec == before.st_ctim.tv_nsec);
    }
    /// Returns what check_mapped() says after a change; empty for nothing.
    std::string said_after(const std::function<void()>& change) const {
        const LoadedScene scene = map_rows(path_, {0, objects});
        EXPECT_NO_THROW(scene.check_mapped());
        wait_for_another_time();
        change();
        const std::string message = error_if_any(ErrorCode::bad_input, [&] { scene.check_mapped(); });
        return message.substr(std::min(path_.size(), message.size()));
    }
    /// Writes to the file in place.
    void overwrite(std::size_t offset, const std::string& text) const {
        std::fstream file(path_, std::ios::in | std::ios::out | std::ios::binary);
        file.seekp(std::streamoff(offset));
        file << text;
        ASSERT_TRUE(file.flush());
    }

    std::string path_ = directory_.file("a.npy");
    std::string content_ = npy_of(NpyType::float32, {objects, 6}, std::vector<float>(6 * objects, 1));
};

TEST_F(MappedNpy, IsRefusedAfterItsContentChanged) {
    EXPECT_EQ(said_after([&] { std::filesystem::resize_file(path_, bytes - 3); }), truncated);
    write_file(path_, content_);
    EXPECT_EQ(said_after([&] { overwrite(bytes, "x"); }), changed) << "longer";
    write_file(path_, content_);
    EXPECT_EQ(said_after([&] { overwrite(bytes - 4, "xxxx"); }), changed);
    EXPECT_EQ(said_after([&] { overwrite(0, content_); }), changed) << "the same bytes again";
    EXPECT_EQ(said_after([&] {
                  std::filesystem::resize_file(path_, bytes - 3);
                  std::filesystem::resize_file(path_, bytes);
              }),
              changed);
    const auto time = std::filesystem::last_write_time(path_);
    EXPECT_EQ(said_after([&] {
                  overwrite(bytes - 4, "yyyy");
                  std::filesystem::last_write_time(path_, time);
              }),
              changed)
        << "with its old time";
}

TEST_F(MappedNpy, IsReadToItsEndAfterItWasReplaced) {
    const std::string other = directory_.file("b.npy");
    EXPECT_EQ(said_after([&] { std::filesystem::create_hard_link(path_, directory_.file("c.npy")); }), "");
    EXPECT_EQ(said_after([&] {
                  write_file(other, "another one");
                  std::filesystem::rename(other, path_);
              }),
              "");
    write_file(path_, content_);
    EXPECT_EQ(said_after([&] { std::filesystem::remove(path_); }), "");
}

TEST_F(MappedNpy, IsCopiedForReadersAtAnyTime) {
    LoadedScene scene = map_rows(path_, {0, objects});
    scene.copy_mapped();
    wait_for_another_time();
    overwrite(bytes - 4, "xxxx");
    EXPECT_EQ(boxes_of<float>(scene).back().max[2], 1);
    EXPECT_NO_THROW(scene.check_mapped());
    LoadedScene late = map_rows(path_, {0, objects});
    wait_for_another_time();
    overwrite(bytes - 4, "yyyy");
    EXPECT_EQ(error_of(ErrorCode::bad_input, [&] { late.copy_mapped(); }), path_ + changed);
}

TEST_F(MappedNpy, IsRefusedIfItChangesBetweenReads) {
    const io::NpyScene scene(path_);
    wait_for_another_time();
    overwrite(bytes - 4, "xxxx");
    EXPECT_EQ(error_of(ErrorCode::bad_input, [&] { (void)scene.read({0, objects}, {}); }), path_ + changed);
}

TEST_F(Npy, ReadsFrames) {
    std::vector<float> values(2 * 3 * 6);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = float(i);
    const LoadedScene scene = io::read_npy_scene(save(npy_of(NpyType::float32, {2, 3, 6}, values)));
    EXPECT_TRUE(scene.moving);
    EXPECT_EQ(scene.frames, 2u);
    EXPECT_EQ(scene.objects, 3u);
    EXPECT_EQ(std::get<std::span<const Box3f>>(scene.frame(1).boxes)[0].min[0], 18.0f);
}

TEST_F(Npy, ReadsOneFrameAtATime) {
    constexpr std::size_t objects = 5000;  // more than the reader widens at once
    std::vector<float> floats(2 * objects * 6);
    for (std::size_t i = 0; i < floats.size(); ++i) floats[i] = float(i) * 0.3f;
    const auto narrow = io::NpyFrames::open(save(npy_of(NpyType::float32, {2, objects, 6}, floats)));
    ASSERT_TRUE(narrow);
    EXPECT_EQ(narrow->shape().frames, 2u);
    EXPECT_EQ(narrow->shape().objects, objects);
    EXPECT_FALSE(narrow->wide());
    std::vector<Box3f> boxes(objects);
    std::vector<Box3d> widened(objects);
    for (const std::size_t frame : {std::size_t(1), std::size_t(0)}) {
        narrow->read(frame, boxes, {});
        narrow->read(frame, widened, {});
        for (std::size_t i = 0; i < objects; ++i) {
            const float expected = floats[(frame * objects + i) * 6 + 4];
            ASSERT_EQ(boxes[i].max[1], expected);
            ASSERT_EQ(widened[i].max[1], double(expected));
        }
    }
    const auto wide = io::NpyFrames::open(
        save(npy_of(NpyType::float64, {1, 2, 6}, std::vector<double>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 0.1})));
    ASSERT_TRUE(wide && wide->wide());
    wide->read(0, std::span(widened).first(2), {});
    EXPECT_EQ(widened[1].max[2], 0.1);
}

TEST_F(Npy, FramesAreOfMovingScenesAlone) {
    EXPECT_FALSE(io::NpyFrames::open(save(npy_of(NpyType::float32, {1, 6}, std::vector<float>(6)))));
    EXPECT_FALSE(io::NpyFrames::open(save(npy_of(NpyType::float32, {1, 4}, std::vector<float>(4)))));
    error_of(ErrorCode::bad_input, [&] { (void)io::NpyFrames::open(save("hello")); });
    const auto frames = io::NpyFrames::open(save(npy_of(NpyType::float32, {2, 1, 6}, std::vector<float>(12))));
    std::filesystem::resize_file(directory_.file("a.npy"), 128 + 30);
    std::vector<Box3f> box(1);
    for (const std::uint64_t frame : {0, 1})
        EXPECT_EQ(error_of(ErrorCode::bad_input, [&] { frames->read(frame, box, {}); }),
                  directory_.file("a.npy") + truncated);
}

TEST_F(Npy, ReadsEmptyArrays) {
    EXPECT_EQ(io::read_npy_scene(save(npy_of<float>(NpyType::float32, {0, 6}, {}))).objects, 0u);
    EXPECT_EQ(io::read_npy_scene(save(npy_of<float>(NpyType::float32, {0, 4}, {}))).objects, 0u);
    EXPECT_EQ(io::read_npy_scene(save(npy_of<double>(NpyType::float64, {5, 0, 6}, {}))).frames, 5u);
}

TEST_F(Npy, ReadsSpheres) {
    const std::vector<double> spheres = {0, 1, 2, 0.5, -4, -5, -6, 0};
    const LoadedScene scene = io::read_npy_scene(save(npy_of(NpyType::float64, {2, 4}, spheres)));
    const auto& boxes = std::get<Buffer<Box3d>>(scene.boxes);
    EXPECT_EQ(boxes[0].min[2], 1.5);
    EXPECT_EQ(boxes[0].max[0], 0.5);
    EXPECT_EQ(boxes[1].min[1], -5.0);
    EXPECT_EQ(boxes[1].max[1], -5.0);
}

TEST_F(Npy, RefusesSpheresThatAreNone) {
    const float nan = std::nanf("");
    EXPECT_EQ(refusal(npy_of<float>(NpyType::float32, {2, 4}, {0, 0, 0, 1, 0, 0, 0, -2})),
              "object 1: radius is -2, not a finite number >= 0");
    EXPECT_EQ(refusal(npy_of<float>(NpyType::float32, {2, 4}, {0, 0, 0, 1, 0, 0, 0, -nan})),
              "object 1: radius is nan, not a finite number >= 0");
    EXPECT_EQ(refusal(npy_of<float>(NpyType::float32, {1, 4}, {0, nan, 0, 1})),
              "object 0: centre y is nan, not a finite number");
    const float huge = std::numeric_limits<float>::max();
    EXPECT_EQ(refusal(npy_of<float>(NpyType::float32, {1, 4}, {0, 0, huge, huge})),
              "object 0: its box is outside the range of float32");
}

TEST_F(Npy, RefusesOtherShapesAndTypes) {
    EXPECT_EQ(refusal(npy_of<float>(NpyType::float32, {2, 5}, std::vector<float>(10))),
              "its shape is (2, 5); boxes are (n, 6) or (frames, n, 6), spheres (n, 4)");
    EXPECT_NE(refusal(npy_of<float>(NpyType::float32, {6}, std::vector<float>(6))), "");
    EXPECT_NE(refusal(npy_of<float>(NpyType::float32, {}, std::vector<float>(1))), "");
    EXPECT_NE(refusal(npy_of<float>(NpyType::float32, {1, 1, 4}, std::vector<float>(4))), "");
    EXPECT_NE(refusal(npy_of<float>(NpyType::float32, {1, 1, 1, 6}, std::vector<float>(6))), "");
    EXPECT_EQ(refusal(npy_of<std::uint32_t>(NpyType::uint32, {1, 6}, std::vector<std::uint32_t>(6))),
              "its array is of type '<u4'; '<f4' or '<f8' is needed: save array.astype('<f8')");
    EXPECT_EQ(refusal(npy_of<float>(NpyType::float32, {1ull << 60, 0, 6}, {})),
              "1152921504606846976 frames; the maximum is 1000000");
}

TEST_F(Npy, RefusesWhatIsNoFile) {
    EXPECT_EQ(error_of(ErrorCode::io_failed, [&] { (void)io::read_npy_scene(directory_.file("none.npy")); }),
              directory_.file("none.npy") + ": cannot open: No such file or directory");
    EXPECT_EQ(error_of(ErrorCode::bad_input, [&] { (void)io::read_npy_scene(directory_.path()); }),
              directory_.path() + ": not a regular file");
}

TEST_F(Npy, StopsWhenAsked) {
    const std::string path = save(npy_of<float>(NpyType::float32, {1, 6}, std::vector<float>(6)));
    EXPECT_NE(error_of(ErrorCode::cancelled, [&] { (void)io::read_npy_scene(path, requested_stop()); }), "");
}

TEST_F(Npy, ReadsPadding) {
    const auto wide = io::read_padding(save(npy_of<double>(NpyType::float64, {3}, {0, 0.1, 1e300})));
    EXPECT_EQ(wide[1], 0.1);
    const auto narrow = io::read_padding(save(npy_of<float>(NpyType::float32, {2}, {0, 0.1f})));
    EXPECT_EQ(narrow[1], double(0.1f));
    for (const double wrong : {-1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
        const std::string path = save(npy_of<double>(NpyType::float64, {2}, {0, wrong}));
        expect_error(ErrorCode::bad_input, "object 1: padding is ", [&] { (void)io::read_padding(path); });
    }
    const std::string path = save(npy_of<double>(NpyType::float64, {2, 1}, {0, 1}));
    EXPECT_NE(error_of(ErrorCode::bad_input, [&] { (void)io::read_padding(path); }), "");
}

}  // namespace
}  // namespace octopair::test
