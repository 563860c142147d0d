// Tests the reader of NumPy's arrays with random files, in all layouts of the format, whose content is known.
#include <gtest/gtest.h>

#include <bit>
#include <cstring>
#include <string>
#include <variant>
#include <vector>

#include "boxes/box_kernel.hpp"
#include "boxes/sphere_boxes.hpp"
#include "io/boxes/npy.hpp"
#include "io/spelling.hpp"
#include "io/temporary.hpp"

namespace octopair::test {
namespace {

/// A random .npy file: its bytes, and what it says.
struct NpyFile {
    Spelling spelling;
    std::string bytes;
    std::uint64_t frames = 1, objects, columns;
    bool is_moving, is_wide, is_fortran, is_big;
    std::vector<double> numbers;  ///< in C order

    explicit NpyFile(std::uint64_t seed)
        : spelling(seed),
          objects(spelling.below(6)),
          columns(spelling.one_in(4) ? 4 : 6),
          is_moving(columns == 6 && spelling.one_in(2)),
          is_wide(spelling.one_in(2)),
          is_fortran(spelling.one_in(2)),
          is_big(spelling.one_in(3)) {
        if (is_moving) frames = spelling.below(4);
        write_header();
        numbers.resize(frames * objects * columns);
        for (double& number : numbers) {
            number = std::fabs(double(std::int64_t(spelling.below(2'000'000))) - 1e6) / 64;
            if (is_wide && spelling.one_in(8)) number = spelling.one_in(2) ? 1e-300 : 0.1;
        }
        for (std::uint64_t i = 0; i < numbers.size(); ++i) append(numbers[place_of(i)]);
    }

    /// Returns the place in C order of number `i` of the file.
    std::uint64_t place_of(std::uint64_t i) const {
        if (!is_fortran) return i;
        const std::uint64_t frame = i % frames, object = i / frames % objects, column = i / frames / objects;
        return (frame * objects + object) * columns + column;
    }

    void write_header() {
        const std::string quote = spelling.pick({"'", "'", "\""});
        const auto key = [&](const char* name) { return quote + name + quote + spelling.pick({":", ": ", " : "}); };
        std::vector<std::string> items = {key("descr") + quote + (is_big ? ">" : "<") + (is_wide ? "f8" : "f4") + quote,
                                          key("fortran_order") + (is_fortran ? "True" : "False"),
                                          key("shape") + shape()};
        if (spelling.one_in(3)) spelling.shuffle(items);
        std::string text = "{";
        for (const std::string& item : items) text += item + (&item == &items.back() ? "" : spelling.pick({", ", ","}));
        text += spelling.pick({", }", "}", ",}", " }"}) + std::string(spelling.below(70), ' ') + "\n";
        const auto version = char(1 + spelling.below(3));
        bytes = std::string("\x93NUMPY") + version + '\0' + char(text.size() & 0xFF) + char(text.size() >> 8);
        if (version > 1) bytes += std::string(2, '\0');
        bytes += text;
    }
    std::string shape() {
        const std::string end = spelling.pick({"", "L"}), comma = spelling.pick({", ", ",", " , "});
        std::string text = "(" + (is_moving ? std::to_string(frames) + end + comma : "");
        return text + std::to_string(objects) + end + comma + std::to_string(columns) + end +
               spelling.pick({")", ",)", " )"});
    }

    void append(double number) {
        const unsigned size = is_wide ? 8 : 4;
        const std::uint64_t bits =
            is_wide ? std::bit_cast<std::uint64_t>(number) : std::bit_cast<std::uint32_t>(float(number));
        for (unsigned i = 0; i < size; ++i) bytes += char(bits >> (8 * (is_big ? size - 1 - i : i)) & 0xFF);
    }

    /// Returns the boxes of frame `frame`.
    std::vector<Box3d> boxes(std::uint64_t frame) const {
        std::vector<Box3d> boxes;
        for (std::uint64_t i = 0; i < objects; ++i) {
            const double* at = numbers.data() + (frame * objects + i) * columns;
            if (columns == 6) {
                boxes.push_back({{at[0], at[1], at[2]}, {at[3], at[4], at[5]}});
            } else if (is_wide) {
                boxes.push_back(box_of_sphere(SphereRow<double>{{at[0], at[1], at[2]}, at[3]}));
            } else {
                boxes.push_back(octopair::wide(
                    box_of_sphere(SphereRow<float>{{float(at[0]), float(at[1]), float(at[2])}, float(at[3])})));
            }
        }
        return boxes;
    }
};

bool are_equal(std::span<const Box3d> a, std::span<const Box3d> b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size_bytes()) == 0);
}

std::vector<Box3d> wide_boxes(const io::LoadedScene& scene) {
    std::vector<Box3d> boxes;
    std::visit(
        [&](const auto& buffer) {
            for (const auto& box : buffer.span()) {
                boxes.push_back({{box.min[0], box.min[1], box.min[2]}, {box.max[0], box.max[1], box.max[2]}});
            }
        },
        scene.boxes);
    return boxes;
}

/// Reads some objects in all frames. Returns what is wrong; empty if nothing is.
std::string fault_of_rows(NpyFile& file, const std::string& path) {
    const io::NpyScene scene(path);
    const std::uint64_t begin = file.spelling.below(file.objects + 1);
    const std::uint64_t end = begin + file.spelling.below(file.objects - begin + 1);
    const io::LoadedScene loaded = scene.read({begin, end}, {}, file.spelling.one_in(2) ? 1 : 1 << 28);
    if (loaded.frames != file.frames || loaded.moving != file.is_moving || scene.wide() != file.is_wide) return "kind";
    std::vector<Box3d> expected;
    for (std::uint64_t frame = 0; frame < file.frames; ++frame) {
        const std::vector<Box3d> all = file.boxes(frame);
        expected.insert(expected.end(), all.begin() + std::ptrdiff_t(begin), all.begin() + std::ptrdiff_t(end));
    }
    return are_equal(wide_boxes(loaded), expected) ? "" : fmt::format("objects {} to {}", begin, end);
}

std::string fault_of_frames(const NpyFile& file, const std::string& path) {
    const auto frames = io::NpyFrames::open(path);
    if (frames.has_value() != file.is_moving) return "a frame axis";
    for (std::uint64_t frame = 0; frames && frame < file.frames; ++frame) {
        std::vector<Box3d> boxes(file.objects);
        frames->read(frame, boxes, {});
        if (!are_equal(boxes, file.boxes(frame))) return fmt::format("frame {}", frame);
    }
    return "";
}

TEST(GeneratedFiles, OfNpyAreReadAsTheyAreWritten) {
    const TemporaryDirectory directory;
    const std::string path = directory.file("a.npy");
    for (std::uint64_t i = 0; i < generated_files() / 4; ++i) {  // files on a disk cost more than texts in memory
        const std::uint64_t seed = case_seed("npy", i);
        NpyFile file(seed);
        write_file(path, file.bytes);
        ASSERT_EQ(fault_of_rows(file, path), "") << repetition(seed, file.bytes);
        ASSERT_EQ(fault_of_frames(file, path), "") << repetition(seed, file.bytes);

        write_file(path, file.spelling.mutated(file.bytes));
        const std::string fault = fault_of_reading(path + ": ", [&]() -> std::string {
            (void)io::read_npy_scene(path);
            return "";
        });
        ASSERT_EQ(fault, "") << repetition(seed, file.bytes);
    }
}

}  // namespace
}  // namespace octopair::test
