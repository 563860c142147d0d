#include "io/boxes/npy.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <type_traits>
#include <variant>

#include <fmt/format.h>

#include "boxes/box_kernel.hpp"
#include "boxes/sphere_boxes.hpp"
#include "io/files/failure.hpp"
#include "io/files/file_mapping.hpp"
#include "io/files/input_file.hpp"
#include "io/formats/format_choice.hpp"
#include "octopair/error.hpp"

namespace octopair::io {

static_assert(std::endian::native == std::endian::little, "little endian arrays are read without conversion");

namespace {

/// Maximum number of frames, because frame numbers in names of result files have six digits: NAME.000000.npy.
constexpr std::uint64_t max_frames = 1'000'000;

NpyHeader read_header(const InputFile& file) {
    Buffer<std::byte> start(std::size_t(std::min<std::uint64_t>(npy_header_max_bytes, file.size())));
    file.read(0, start.span());
    return parse_npy_header(start.span(), file.size(), file.path());
}

void refuse_integers(const NpyHeader& header, std::string_view file) {
    if (header.type == NpyType::float32 || header.type == NpyType::float64) return;
    refuse(file, fmt::format("its array is of type '{}'; '<f4' or '<f8' is needed: save array.astype('<f8')",
                             type_text(header.type)));
}

/// Reverses the order of the bytes of each number.
template <typename Real>
void turn_bytes(std::span<Real> values) {
    for (Real& value : values) {
        if constexpr (sizeof(Real) == 4) {
            value = std::bit_cast<Real>(__builtin_bswap32(std::bit_cast<std::uint32_t>(value)));
        } else {
            value = std::bit_cast<Real>(__builtin_bswap64(std::bit_cast<std::uint64_t>(value)));
        }
    }
}

/// A position in the array of a file: the number with index `first`.
struct ArrayPlace {
    const InputFile& file;
    const NpyHeader& header;
    std::uint64_t first;
};

/// Reads consecutive numbers of a file.
template <typename Real>
void read_numbers(const ArrayPlace& from, std::span<Real> values, const std::stop_token& stop) {
    const std::uint64_t begin = from.header.data_offset + from.first * sizeof(Real);
    if (!from.header.big_endian) return from.file.read(begin, std::as_writable_bytes(values), stop);
    constexpr std::size_t piece = std::size_t(1) << 20;  // a stop request is seen before each
    for (std::size_t at = 0; at < values.size(); at += piece) {
        const auto some = values.subspan(at, std::min(piece, values.size() - at));
        from.file.read(begin + at * sizeof(Real), std::as_writable_bytes(some), stop);
        turn_bytes(some);
    }
}

/// Returns the numbers of boxes or spheres as one span, without a copy.
template <typename Real, typename Object>
std::span<Real> as_numbers(std::span<Object> objects) {
    static_assert(sizeof(Object) % sizeof(Real) == 0);
    return {reinterpret_cast<Real*>(objects.data()), objects.size() * (sizeof(Object) / sizeof(Real))};
}

/// Consecutive spheres of a file: the first has the index `begin`.
template <typename Real>
struct Spheres {
    std::span<const SphereRow<Real>> rows;
    std::uint64_t begin;
    std::string_view file;
};

template <typename Real>
void find_boxes(const Spheres<Real>& spheres, std::span<Box<Real>> boxes, const std::stop_token& stop) {
    try {
        write_sphere_boxes(spheres.rows, boxes, spheres.begin, stop);
    } catch (const Error& error) {
        if (error.code() == ErrorCode::cancelled) cancel();
        refuse(spheres.file, error.what());
    }
}

}  // namespace

SceneShape scene_shape(const NpyHeader& header, std::string_view file) {
    refuse_integers(header, file);
    const auto& shape = header.shape;
    if (shape.size() == 2 && (shape[1] == 6 || shape[1] == 4)) return {.objects = shape[0], .spheres = shape[1] == 4};
    if (shape.size() != 3 || shape[2] != 6) {
        refuse(file,
               fmt::format("its shape is {}; boxes are (n, 6) or (frames, n, 6), spheres (n, 4)", shape_text(shape)));
    }
    if (shape[0] > max_frames) refuse(file, fmt::format("{} frames; the maximum is {}", shape[0], max_frames));
    return {.objects = shape[1], .frames = shape[0], .moving = true};
}

NpyScene::NpyScene(const std::string& path)
    : file_(path), header_(read_header(file_)), shape_(scene_shape(header_, path)) {}

LoadedScene NpyScene::read(const ObjectRows& rows, const std::stop_token& stop, std::uint64_t min_mapped) const {
    LoadedScene scene;
    scene.objects = rows.end - rows.begin;
    scene.frames = shape_.frames;
    scene.moving = shape_.moving;
    if (wide()) {
        scene.boxes = read_boxes<double>(rows, stop, min_mapped);
    } else {
        scene.boxes = read_boxes<float>(rows, stop, min_mapped);
    }
    return scene;
}

template <typename Real>
Buffer<Box<Real>> NpyScene::read_boxes(const ObjectRows& rows, const std::stop_token& stop,
                                       std::uint64_t min_mapped) const {
    const std::size_t objects = std::size_t(rows.end - rows.begin);
    if (auto mapped = map_boxes<Real>(rows, min_mapped)) return std::move(*mapped);
    Buffer<Box<Real>> boxes{std::size_t(shape_.frames) * objects};
    if (shape_.spheres) {
        Buffer<SphereRow<Real>> spheres{objects};
        if (header_.fortran_order) {
            read_columns(rows, as_numbers<Real>(spheres.span()), stop);
        } else {
            read_rows(rows.begin, spheres.span(), stop);
        }
        find_boxes<Real>({spheres.span(), rows.begin, file_.path()}, boxes.span(), stop);
        return boxes;
    }
    if (header_.fortran_order) {
        read_columns(rows, as_numbers<Real>(boxes.span()), stop);
        return boxes;
    }
    // If all objects are read, the layout in memory is that of the file, so one read is enough.
    const bool whole = objects == shape_.objects;
    const std::size_t runs = whole ? 1 : std::size_t(shape_.frames), length = whole ? boxes.size() : objects;
    for (std::size_t run = 0; run < runs; ++run) {
        read_rows(run * shape_.objects + rows.begin, boxes.span().subspan(run * length, length), stop);
    }
    return boxes;
}

/// Maps boxes that are adjacent in the file. Returns nothing if the boxes are not adjacent, or are too few for a mapping.
template <typename Real>
std::optional<Buffer<Box<Real>>> NpyScene::map_boxes(const ObjectRows& rows, std::uint64_t min_mapped) const {
    const std::uint64_t objects = rows.end - rows.begin;
    const bool as_in_memory = !header_.fortran_order && !header_.big_endian;
    const bool adjacent = as_in_memory && !shape_.spheres && (shape_.frames == 1 || objects == shape_.objects);
    const std::uint64_t bytes = shape_.frames * objects * sizeof(Box<Real>);
    const std::uint64_t begin = header_.data_offset + rows.begin * sizeof(Box<Real>);
    if (!adjacent || bytes < min_mapped || begin % alignof(Box<Real>) != 0) return std::nullopt;
    auto* const boxes = static_cast<Box<Real>*>(map_file(file_, begin, std::size_t(bytes)));
    if (boxes == nullptr) return std::nullopt;
    return Buffer<Box<Real>>::adopt(boxes, std::size_t(shape_.frames * objects), mapped_pages());
}

/// Reads the objects `rows` in all frames from an array in Fortran order: for each column, the frames of the first object, then those of
/// the next. `values` has the columns of the first object in the first frame, then those of the next object.
template <typename Real>
void NpyScene::read_columns(const ObjectRows& rows, std::span<Real> values, const std::stop_token& stop) const {
    constexpr std::size_t piece = std::size_t(1) << 18;
    const std::uint64_t objects = rows.end - rows.begin, frames = shape_.frames, width = header_.shape.back();
    const std::uint64_t numbers = objects * frames;
    Buffer<Real> some{std::size_t(std::min<std::uint64_t>(piece, numbers))};
    for (std::uint64_t column = 0; column < width; ++column) {
        const std::uint64_t first = (column * shape_.objects + rows.begin) * frames;
        for (std::uint64_t begin = 0; begin < numbers; begin += piece) {
            const auto part = some.span().first(std::size_t(std::min<std::uint64_t>(piece, numbers - begin)));
            read_numbers({file_, header_, first + begin}, part, stop);
            for (std::size_t i = 0; i < part.size(); ++i) {
                const std::uint64_t object = (begin + i) / frames, frame = (begin + i) % frames;
                values[(frame * objects + object) * width + column] = part[i];
            }
        }
    }
}

/// Reads boxes or spheres that are adjacent in the file.
template <typename T>
void NpyScene::read_rows(std::uint64_t first, std::span<T> rows, const std::stop_token& stop) const {
    using Real = std::conditional_t<std::is_same_v<T, Box3d> || std::is_same_v<T, SphereRow<double>>, double, float>;
    read_numbers({file_, header_, first * (sizeof(T) / sizeof(Real))}, as_numbers<Real>(rows), stop);
}

LoadedScene read_npy_scene(const std::string& path, const std::stop_token& stop) {
    const NpyScene scene(path);
    return scene.read({0, scene.shape().objects}, stop);
}

std::optional<NpyFrames> NpyFrames::open(const std::string& path) {
    InputFile file(path);
    NpyHeader header = read_header(file);
    const SceneShape shape = scene_shape(header, path);
    if (!shape.moving) return std::nullopt;
    NpyFrames frames(std::move(file), std::move(header), shape);
    if (frames.header_.fortran_order) frames.whole_ = read_npy_scene(path);
    return frames;
}

template <typename Real>
void NpyFrames::read_rows(std::uint64_t first, std::span<Box<Real>> rows, const std::stop_token& stop) const {
    if (!header_.fortran_order) return read_numbers({file_, header_, first * 6}, as_numbers<Real>(rows), stop);
    file_.check_unchanged();
    const auto all = std::get<Buffer<Box<Real>>>(whole_.boxes).span();
    std::copy_n(all.begin() + std::ptrdiff_t(first), rows.size(), rows.begin());
}

void NpyFrames::read(std::uint64_t frame, std::span<Box3f> boxes, const std::stop_token& stop) const {
    read_rows(frame * shape_.objects, boxes, stop);
}

void NpyFrames::read(std::uint64_t frame, std::span<Box3d> boxes, const std::stop_token& stop) const {
    const std::uint64_t first = frame * shape_.objects;
    if (wide()) return read_rows(first, boxes, stop);
    constexpr std::size_t batch = 4096;
    Buffer<Box3f> narrow(std::min(batch, boxes.size()));
    for (std::size_t i = 0; i < boxes.size(); i += batch) {
        const auto rows = narrow.span().first(std::min(batch, boxes.size() - i));
        read_rows(first + i, rows, stop);
        std::transform(rows.begin(), rows.end(), boxes.data() + i, octopair::wide<float>);
    }
}

Buffer<double> read_padding(const std::string& path, const std::stop_token& stop) {
    check_not_wrapped(path);
    const InputFile file(path);
    const NpyHeader header = read_header(file);
    refuse_integers(header, path);
    const auto& shape = header.shape;
    if (shape.size() != 1) refuse(path, fmt::format("its shape is {}; paddings are (n,)", shape_text(shape)));
    Buffer<double> padding{std::size_t(shape[0])};
    if (header.type == NpyType::float64) {
        read_numbers({file, header, 0}, padding.span(), stop);
    } else {
        constexpr std::size_t piece = std::size_t(1) << 20;  // a stop request is seen before each
        Buffer<float> narrow{std::min(piece, padding.size())};
        for (std::size_t at = 0; at < padding.size(); at += piece) {
            const auto some = narrow.span().first(std::min(piece, padding.size() - at));
            read_numbers({file, header, at}, some, stop);
            std::copy_n(some.data(), some.size(), padding.data() + at);
        }
    }
    for (std::size_t i = 0; i < padding.size(); ++i) {
        if (i % (std::size_t(1) << 20) == 0 && stop.stop_requested()) cancel();
        if (padding[i] >= 0 && std::isfinite(padding[i])) continue;
        refuse(path, fmt::format("object {}: padding is {}, not a finite number >= 0", i, number_text(padding[i])));
    }
    return padding;
}

}  // namespace octopair::io
