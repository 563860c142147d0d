#include "io/meshes/gltf/accessor.hpp"

#include <algorithm>
#include <cstring>
#include <limits>

#include <fmt/format.h>

#include "io/meshes/gltf/fields.hpp"

namespace octopair::io::gltf {

namespace {

template <typename T>
T value_at(const std::byte* bytes) {
    T value;
    std::memcpy(&value, bytes, sizeof value);
    return value;
}

/// Returns the name that glTF gives to elements with this number of components.
std::string_view element_name(unsigned components) {
    constexpr std::array<std::string_view, 4> names = {"SCALAR", "VEC2", "VEC3", "VEC4"};
    return names[components - 1];
}

}  // namespace

Accessor::Accessor(GltfFile& file, std::uint64_t number, unsigned components) : components_(components) {
    const JsonFields fields = file.item("accessors", number);
    place_ = fields.place();
    read_type(fields);
    const std::string& element = fields.text("type");
    if (element != element_name(components)) {
        fields.refuse_key("type",
                          fmt::format("'{}', but {} is needed here", shown_text(element), element_name(components)));
    }
    count_ = whole_number(fields, "count");
    if (fields.find("bufferView") != nullptr) {
        base_ = elements_in(file, fields, stride_);
    } else {
        constexpr std::uint64_t most = 1 << 24;
        if (count_ > most)
            refuse(place_, fmt::format("has {} elements without data; at most {} are read", count_, most));
    }
    if (const auto* const sparse = fields.find("sparse"))
        read_sparse(file, JsonFields(*sparse, fields.place_of("sparse")));
}

void Accessor::read_type(const JsonFields& fields) {
    const std::uint64_t type = whole_number(fields, "componentType");
    if (type < 5120 || type > 5126 || type == 5124)
        fields.refuse_key("componentType",
                          fmt::format("{} is not a type of glTF, which are 5120 to 5123, 5125 and 5126", type));
    type_ = Type(type);
    normalized_ = fields.find("normalized") != nullptr && fields.boolean("normalized");
    if (normalized_ && type_ == Type::uint32)
        fields.refuse_key("normalized", "integers of 32 bits cannot be normalized");
    if (is_float()) normalized_ = false;
}

const std::byte* Accessor::elements_in(GltfFile& file, const JsonFields& fields, std::uint64_t& stride) const {
    const BufferView view = file.view(whole_number(fields, "bufferView"));
    const std::uint64_t offset = whole_number_or(fields, "byteOffset", 0), size = components_ * component_bytes();
    stride = view.stride == 0 ? size : view.stride;
    if (stride < size) {
        refuse(fields.place(),
               fmt::format("has elements of {} bytes, but the byteStride of {} is {}", size, view.name, stride));
    }
    const std::uint64_t count = whole_number(fields, "count"), bytes = view.bytes.size();
    if (count == 0) return nullptr;
    const bool inside = offset <= bytes && size <= bytes - offset && (count - 1) <= (bytes - offset - size) / stride;
    if (!inside) {
        // All numbers are at most 2^53 and the stride may be large, so the product is computed in float64.
        const double end = double(offset) + double(count - 1) * double(stride) + double(size);
        refuse(fields.place(), fmt::format("ends at byte {:.0f} of {}, which has {} bytes", end, view.name, bytes));
    }
    return view.bytes.data() + offset;
}

void Accessor::read_sparse(GltfFile& file, const JsonFields& sparse) {
    const std::uint64_t count = whole_number(sparse, "count");
    // Indices and values are separate arrays with equal checks. They differ only in their types.
    nlohmann::json values = sparse.required("values"), indices = sparse.required("indices");
    if (!values.is_object()) refuse_json_type(sparse.place_of("values"), values, "an object");
    if (!indices.is_object()) refuse_json_type(sparse.place_of("indices"), indices, "an object");
    values["count"] = indices["count"] = count;
    std::uint64_t stride = 0;
    const JsonFields value_fields(values, sparse.place_of("values"));
    replacements_ = elements_in(file, value_fields, stride);
    if (count > 0 && stride != components_ * component_bytes())
        refuse(value_fields.place(), "has a byteStride, which sparse values must not have");
    Accessor numbers = *this;
    numbers.components_ = 1;
    numbers.replaced_.clear();
    numbers.place_ = sparse.place_of("indices");
    const JsonFields index_fields(indices, numbers.place_);
    numbers.read_type(index_fields);
    numbers.check_indices();
    numbers.base_ = numbers.elements_in(file, index_fields, numbers.stride_);
    file.charge(count, sizeof(std::uint64_t));
    for (std::uint64_t i = 0; i < count; ++i) {
        const std::uint64_t index = numbers.index_at(i);
        if (index >= count_) refuse(numbers.place_, fmt::format("replaces element {} of {}", index, count_));
        if (i > 0 && index <= replaced_.back())
            refuse(numbers.place_, fmt::format("index {} is {}, which is not above the index before it", i, index));
        replaced_.push_back(index);
    }
}

void Accessor::check_indices() const {
    const bool is_unsigned = type_ == Type::uint8 || type_ == Type::uint16 || type_ == Type::uint32;
    if (!is_unsigned || normalized_) refuse(place_, "indices must be unsigned integers that are not normalized");
}

std::uint32_t Accessor::largest_index() const {
    if (type_ == Type::uint8) return std::numeric_limits<std::uint8_t>::max();
    return type_ == Type::uint16 ? std::numeric_limits<std::uint16_t>::max()
                                 : std::numeric_limits<std::uint32_t>::max();
}

std::uint32_t Accessor::index_at(std::uint64_t index) const {
    const std::byte* const bytes = element_bytes(index);
    if (bytes == nullptr) return 0;
    if (type_ == Type::uint8) return value_at<std::uint8_t>(bytes);
    return type_ == Type::uint16 ? value_at<std::uint16_t>(bytes) : value_at<std::uint32_t>(bytes);
}

const std::byte* Accessor::element_bytes(std::uint64_t index) const {
    if (!replaced_.empty()) {
        const auto found = std::lower_bound(replaced_.begin(), replaced_.end(), index);
        if (found != replaced_.end() && *found == index)
            return replacements_ + std::uint64_t(found - replaced_.begin()) * components_ * component_bytes();
    }
    return base_ == nullptr ? nullptr : base_ + index * stride_;
}

double Accessor::step() const {
    if (!normalized_) return 1;
    switch (type_) {
        case Type::int8:
            return 1.0 / 127;
        case Type::uint8:
            return 1.0 / 255;
        case Type::int16:
            return 1.0 / 32767;
        default:
            return 1.0 / 65535;
    }
}

double Accessor::number(const std::byte* bytes) const {
    switch (type_) {
        case Type::int8: {
            const double value = value_at<std::int8_t>(bytes);
            return normalized_ ? std::max(value / 127, -1.0) : value;
        }
        case Type::uint8: {
            const double value = value_at<std::uint8_t>(bytes);
            return normalized_ ? value / 255 : value;
        }
        case Type::int16: {
            const double value = value_at<std::int16_t>(bytes);
            return normalized_ ? std::max(value / 32767, -1.0) : value;
        }
        case Type::uint16: {
            const double value = value_at<std::uint16_t>(bytes);
            return normalized_ ? value / 65535 : value;
        }
        case Type::uint32:
            return value_at<std::uint32_t>(bytes);
        case Type::float32:
            break;
    }
    return double(value_at<float>(bytes));
}

std::uint64_t Accessor::component_bytes() const {
    if (type_ == Type::int8 || type_ == Type::uint8) return 1;
    return type_ == Type::int16 || type_ == Type::uint16 ? 2 : 4;
}

}  // namespace octopair::io::gltf
