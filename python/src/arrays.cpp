#include "arrays.hpp"

#include <algorithm>
#include <thread>

#include "call.hpp"

namespace octopair::python {

namespace {

// Pairs that a thread copies. Starting a thread for fewer takes longer than copying them.
constexpr std::uint64_t pairs_per_thread = 1u << 18;

/// Copies pairs [begin, end) of the list to out[begin].
void copy_range(const PairList& list, std::uint64_t begin, std::uint64_t end, Pair* out) {
    std::uint64_t at = 0;
    for (const auto chunk : list.chunks()) {
        const std::uint64_t from = std::max(begin, at), to = std::min(end, at + chunk.size());
        if (from < to) std::copy_n(chunk.begin() + std::ptrdiff_t(from - at), to - from, out + from);
        at += chunk.size();
    }
}

/// Copies all pairs to `out`, on several threads: new memory costs more time than the copy.
void copy_pairs(const PairList& list, Pair* out) {
    const std::uint64_t size = list.size();
    std::uint64_t threads = size / pairs_per_thread;
    if (threads < 2) return copy_range(list, 0, size, out);
    threads = std::min<std::uint64_t>(threads, std::max(1u, std::min(8u, std::thread::hardware_concurrency())));
    std::vector<std::jthread> helpers;
    for (std::uint64_t i = 1; i < threads; ++i) {
        helpers.emplace_back([&, i] { copy_range(list, size * i / threads, size * (i + 1) / threads, out); });
    }
    copy_range(list, 0, size / threads, out);
}

Objects objects_of(const py::array& boxes, const py::object& padding) {
    return {boxes_of(boxes), optional_rows_of<double>(padding)};
}

Input input_of(const py::array& boxes, const py::object& padding, const py::object& against,
               const py::object& against_padding) {
    const Objects first = objects_of(boxes, padding);
    if (against.is_none()) return first;
    return Join{first, objects_of(against.cast<py::array>(), against_padding)};
}

}  // namespace

Boxes boxes_of(const py::array& array) {
    if (array.ndim() != 2 || array.shape(1) != 6) throw py::type_error("boxes must have the shape (n, 6)");
    if (py::isinstance<py::array_t<float>>(array)) return rows_of<Box3f, float>(array);
    return rows_of<Box3d, double>(array);
}

ArrayInput::ArrayInput(py::array boxes, py::object padding, py::object against, py::object against_padding)
    : boxes_(std::move(boxes)),
      padding_(std::move(padding)),
      against_(std::move(against)),
      against_padding_(std::move(against_padding)),
      input_(input_of(boxes_, padding_, against_, against_padding_)) {}

std::uint64_t ArrayInput::size() const { return input_.first.size() + (input_.second ? input_.second->size() : 0); }

py::array_t<std::uint32_t> pairs_array(std::span<const Pair> pairs) {
    py::array_t<std::uint32_t> array({py::ssize_t(pairs.size()), py::ssize_t(2)});
    std::copy(pairs.begin(), pairs.end(), reinterpret_cast<Pair*>(array.mutable_data()));
    return array;
}

py::array_t<std::uint32_t> pairs_array(const PairList& list) {
    py::array_t<std::uint32_t> array({py::ssize_t(list.size()), py::ssize_t(2)});
    auto* const out = reinterpret_cast<Pair*>(array.mutable_data());
    const Unlocked unlocked;
    copy_pairs(list, out);
    return array;
}

}  // namespace octopair::python
