// GltfBuilder: makes glTF and GLB files for tests.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "base/memory.hpp"
#include "io/temporary.hpp"

namespace octopair::test {

using nlohmann::json;

/// Number that glTF gives to a type of components.
enum GltfType : std::uint16_t { int8 = 5120, uint8, int16, uint16, uint32 = 5125, float32 };

inline std::string base64(std::string_view bytes) {
    constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t bits = 0;
        for (std::size_t k = 0; k < 3; ++k)
            bits = bits << 8 | (i + k < bytes.size() ? std::uint8_t(bytes[i + k]) : std::uint8_t(0));
        for (std::size_t k = 0; k < 4; ++k)
            text.push_back(i + k <= bytes.size() ? digits[bits >> (18 - 6 * k) & 63] : '=');
    }
    return text;
}

/// Returns the bytes of a chunk of a GLB file.
inline std::string glb_chunk(std::string_view type, std::string_view content) {
    return bytes_of<std::uint32_t>({std::uint32_t(content.size())}) + std::string(type) + std::string(content);
}

/// Returns a GLB file with a header and the given chunks.
inline std::string glb_of(const std::string& chunks, std::uint32_t version = 2) {
    return "glTF" + bytes_of<std::uint32_t>({version, std::uint32_t(12 + chunks.size())}) + chunks;
}

inline Buffer<std::byte> as_buffer(std::string_view text) {
    Buffer<std::byte> buffer{text.size()};
    if (!text.empty()) std::memcpy(buffer.data(), text.data(), text.size());
    return buffer;
}

/// A file with one buffer. The member functions append to arrays of the root, and return the index of the new element.
struct GltfBuilder {
    json root = {{"asset", {{"version", "2.0"}}}};
    std::string data;

    std::size_t add(const char* list, json value) {
        root[list].push_back(std::move(value));
        return root[list].size() - 1;
    }
    std::size_t view(const std::string& bytes, json more = json::object()) {
        more.update({{"buffer", 0}, {"byteOffset", data.size()}, {"byteLength", bytes.size()}});
        data += bytes;
        return add("bufferViews", std::move(more));
    }
    template <typename T>
    std::size_t accessor(const std::vector<T>& values, GltfType type, const char* kind, json more = json::object()) {
        const std::size_t components = kind == std::string_view("SCALAR") ? 1 : std::size_t(kind[3] - '0');
        more.update({{"bufferView", view(bytes_of(values))}, {"componentType", type}, {"type", kind}});
        more.emplace("count", values.size() / components);
        return add("accessors", std::move(more));
    }
    std::size_t positions(const std::vector<float>& values) { return accessor(values, float32, "VEC3"); }
    std::size_t mesh(std::size_t position_accessor, json more = json::object()) {
        json primitive = {{"attributes", {{"POSITION", position_accessor}}}};
        primitive.update(more);
        return add("meshes", {{"primitives", json::array({std::move(primitive)})}});
    }
    /// Adds the mesh of the triangle (0, 0, 0), (1, 0, 0), (0, 1, 0).
    std::size_t triangle() { return mesh(positions({0, 0, 0, 1, 0, 0, 0, 1, 0})); }
    std::size_t node(json value) { return add("nodes", std::move(value)); }

    /// Returns the file as text, with the data in base64, or with the given URI of another file.
    std::string text(const std::string& uri = "") const {
        json all = root;
        if (!data.empty() || !uri.empty()) {
            all["buffers"][0]["byteLength"] = data.size();
            all["buffers"][0]["uri"] = uri.empty() ? "data:application/octet-stream;base64," + base64(data) : uri;
        }
        return all.dump();
    }
    std::string glb() const {
        json all = root;
        if (!data.empty()) all["buffers"][0]["byteLength"] = data.size();
        std::string text = all.dump();
        text.resize((text.size() + 3) / 4 * 4, ' ');
        const std::string padded = data + std::string((4 - data.size() % 4) % 4, '\0');
        return glb_of(glb_chunk("JSON", text) + (data.empty() ? "" : glb_chunk(std::string_view("BIN\0", 4), padded)));
    }
};

}  // namespace octopair::test
