// NumPy arrays as inputs and results.
//
// Inputs    Read where they lie. The Python layer (octopair/_arrays.py) has checked dtype, shape and order, and reports errors. The
//           functions here check again, because a wrong array would be read beyond its end.
// Results   Arrays that own their memory. An array takes a vector of C++ over. Pairs of a PairList are copied, because they lie in many
//           pieces.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "octopair/input.hpp"
#include "octopair/objects.hpp"
#include "octopair/pair_list.hpp"
#include "octopair/pose.hpp"

namespace octopair::python {

namespace py = pybind11;

/// Returns the boxes of an array of shape (n, 6), float32 or float64. Throws: TypeError.
Boxes boxes_of(const py::array& array);

/// Returns the elements of an aligned, C-contiguous array of `Number` as rows of type `Row`. Throws: TypeError.
template <typename Row, typename Number = Row>
std::span<const Row> rows_of(const py::array& array) {
    constexpr std::size_t width = sizeof(Row) / sizeof(Number);
    const bool aligned = reinterpret_cast<std::uintptr_t>(array.data()) % alignof(Row) == 0;
    if (!py::isinstance<py::array_t<Number, py::array::c_style>>(array) || !aligned ||
        std::size_t(array.size()) % width != 0) {
        throw py::type_error("an array has the wrong dtype, order or shape");
    }
    return {static_cast<const Row*>(array.data()), std::size_t(array.size()) / width};
}

/// Like rows_of(); None is an empty span.
template <typename Row, typename Number = Row>
std::span<const Row> optional_rows_of(const py::object& array) {
    if (array.is_none()) return {};
    return rows_of<Row, Number>(array.cast<py::array>());
}

/// Boxes and paddings of one set or two, and references to their arrays.
class ArrayInput {
public:
    /// `padding`, `against` and `against_padding` may be None.
    ArrayInput(py::array boxes, py::object padding, py::object against, py::object against_padding);

    const Input& input() const { return input_; }
    std::uint64_t size() const;

private:
    py::array boxes_;
    py::object padding_, against_, against_padding_;
    Input input_;
};

/// Returns an array that owns `vector`, of shape (size, columns...), where the columns are the numbers of an element.
template <typename Number, typename Element>
py::array_t<Number> array_of(std::vector<Element>&& vector, const std::vector<py::ssize_t>& columns = {}) {
    std::vector<py::ssize_t> shape = {py::ssize_t(vector.size())};
    shape.insert(shape.end(), columns.begin(), columns.end());
    if (vector.empty()) return py::array_t<Number>(shape);
    auto owned = std::make_unique<std::vector<Element>>(std::move(vector));
    const auto* const numbers = reinterpret_cast<const Number*>(owned->data());
    const py::capsule owner(owned.get(), [](void* memory) { delete static_cast<std::vector<Element>*>(memory); });
    (void)owned.release();  // the capsule owns it
    return py::array_t<Number>(shape, numbers, owner);
}

/// Return a copy of pairs with shape (m, 2).
py::array_t<std::uint32_t> pairs_array(std::span<const Pair> pairs);
py::array_t<std::uint32_t> pairs_array(const PairList& list);

}  // namespace octopair::python
