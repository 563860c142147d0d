#include "io/npy.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include <fmt/format.h>

#include "geometry/box_kernel.hpp"
#include "io/failure.hpp"
#include "io/input_file.hpp"
#include "io/spheres.hpp"

namespace octopair::io {

static_assert(std::endian::native == std::endian::little, "arrays are read as they lie in the file");

namespace {

/// As many as a file name NAME.000000.npy can number.
constexpr std::uint64_t most_frames = 1'000'000;

struct OpenArray {
    InputFile file;
    NpyHeader header;
};

OpenArray open_array(const std::string& path) {
    InputFile file(path);
    Buffer<std::byte> start(std::size_t(std::min<std::uint64_t>(npy_header_max_bytes, file.size())));
    file.read(0, start.span());
    NpyHeader header = parse_npy_header(start.span(), file.size(), path);
    return {std::move(file), std::move(header)};
}

template <typename T>
Buffer<T> read_rows(const OpenArray& array, std::uint64_t rows, const std::stop_token& stop) {
    Buffer<T> buffer{std::size_t(rows)};
    array.file.read(array.header.data_offset, std::as_writable_bytes(buffer.span()), stop);
    return buffer;
}

template <typename Real>
Buffer<Box<Real>> read_boxes(const OpenArray& array, const SceneShape& shape, const std::stop_token& stop) {
    if (!shape.spheres) return read_rows<Box<Real>>(array, shape.frames * shape.objects, stop);
    const auto spheres = read_rows<Sphere<Real>>(array, shape.objects, stop);
    Buffer<Box<Real>> boxes{spheres.size()};
    boxes_of_spheres<Real>(spheres.span(), boxes.span(), array.file.path());
    return boxes;
}

void refuse_integers(const NpyHeader& header, std::string_view file) {
    if (header.type == NpyType::float32 || header.type == NpyType::float64) return;
    refuse(file, fmt::format("its array is of type '{}'; '<f4' or '<f8' is needed", type_text(header.type)));
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
    if (shape[0] > most_frames) refuse(file, fmt::format("{} frames; at most {} are known", shape[0], most_frames));
    return {.objects = shape[1], .frames = shape[0], .moving = true};
}

LoadedScene read_npy_scene(const std::string& path, const std::stop_token& stop) {
    const OpenArray array = open_array(path);
    const SceneShape shape = scene_shape(array.header, path);
    LoadedScene scene;
    scene.objects = shape.objects;
    scene.frames = shape.frames;
    scene.moving = shape.moving;
    if (array.header.type == NpyType::float32) {
        scene.boxes = read_boxes<float>(array, shape, stop);
    } else {
        scene.boxes = read_boxes<double>(array, shape, stop);
    }
    return scene;
}

std::optional<NpyFrames> NpyFrames::open(const std::string& path) {
    OpenArray array = open_array(path);
    const SceneShape shape = scene_shape(array.header, path);
    if (!shape.moving) return std::nullopt;
    return NpyFrames(std::move(array.file), std::move(array.header), shape);
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
    const OpenArray array = open_array(path);
    refuse_integers(array.header, path);
    const auto& shape = array.header.shape;
    if (shape.size() != 1) refuse(path, fmt::format("its shape is {}; paddings are (n,)", shape_text(shape)));
    Buffer<double> padding;
    if (array.header.type == NpyType::float64) {
        padding = read_rows<double>(array, shape[0], stop);
    } else {
        const auto narrow = read_rows<float>(array, shape[0], stop);
        padding.resize_discard(narrow.size());
        std::copy_n(narrow.data(), narrow.size(), padding.data());
    }
    for (std::size_t i = 0; i < padding.size(); ++i) {
        if (padding[i] >= 0 && std::isfinite(padding[i])) continue;
        refuse(path, fmt::format("object {}: padding is {}, not a finite number >= 0", i, number_text(padding[i])));
    }
    return padding;
}

}  // namespace octopair::io
