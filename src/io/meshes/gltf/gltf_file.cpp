#include "io/meshes/gltf/gltf_file.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <limits>
#include <optional>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "io/files/letter_case.hpp"
#include "io/json/json_text.hpp"
#include "io/meshes/gltf/fields.hpp"
#include "io/meshes/uri.hpp"
#include "octopair/error.hpp"

namespace octopair::io::gltf {

namespace {

using nlohmann::json;

constexpr std::string_view magic = "glTF";
constexpr std::uint32_t json_chunk = 0x4E4F534A, binary_chunk = 0x004E4942;
constexpr std::size_t header_bytes = 12, chunk_header_bytes = 8;

std::uint32_t number_at(std::span<const std::byte> bytes, std::size_t offset) {
    std::uint32_t number = 0;
    std::memcpy(&number, bytes.data() + offset, sizeof number);
    return number;
}

std::string_view text_of(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

bool is_glb(std::span<const std::byte> bytes) { return text_of(bytes).starts_with(magic); }

Buffer<std::byte> content_of(const std::string& path, const std::stop_token& stop) {
    const InputFile file(path);
    Buffer<std::byte> content{std::size_t(file.size())};
    file.read(0, content.span(), stop);
    return content;
}

/// Parses JSON. Bytes that are not UTF-8 become U+FFFD, because old exporters write names in other encodings.
json parsed(std::string_view text, const std::string& path, const std::stop_token& stop) {
    constexpr int max_levels = 512;  // objects of applications may be nested deeply
    try {
        return parse_json(text, path, stop, max_levels);
    } catch (const Error& error) {
        if (error.code() != ErrorCode::bad_input) throw;
        const std::string clean = clean_text(text);
        if (clean == text) throw;
        return parse_json(clean, path, stop, max_levels);
    }
}

/// Returns a version of the object "asset"; empty if it is absent.
std::string version_of(const JsonFields& root, std::string_view key) {
    const JsonFields asset(root.required("asset"), root.place_of("asset"));
    const json* const version = asset.find(key);
    if (version == nullptr) return {};
    // Some exporters write 2.0 as a number.
    if (version->is_number()) return fmt::format("{:.1f}", version->get<double>());
    return json_text(*version, asset.place_of(key));
}

/// Throws: Error{bad_input} if a file can be read only by programs that know a newer version than 2.0.
void check_least_version(const JsonFields& root) {
    const std::string least = version_of(root, "minVersion");
    if (least.empty() || least.starts_with("2.0") || least.starts_with("1.")) return;
    const JsonFields asset(root.required("asset"), root.place_of("asset"));
    asset.refuse_key("minVersion",
                     fmt::format("the file needs a reader of glTF {}; octopair reads glTF 2.0, so write the "
                                 "file as glTF 2.0",
                                 shown_text(least)));
}

/// Returns whether a text has the key "version", with a value that begins with 1.
bool names_version_1(std::string_view text) {
    constexpr std::string_view key = "\"version\"", blank = " \t\r\n";
    for (std::size_t at = text.find(key); at != std::string_view::npos; at = text.find(key, at + 1)) {
        std::size_t value = text.find_first_not_of(blank, at + key.size());
        if (value == std::string_view::npos || text[value] != ':') continue;
        value = text.find_first_not_of(blank, value + 1);
        if (value == std::string_view::npos) continue;
        if (text[value] == '"') ++value;
        if (value < text.size() && text[value] == '1') return true;
    }
    return false;
}

}  // namespace

GltfFile::GltfFile(const std::string& path, const std::stop_token& stop)
    : GltfFile(path, content_of(path, stop), stop) {}

GltfFile::GltfFile(std::string path, Buffer<std::byte> content, const std::stop_token& stop)
    : budget_(std::move(path), stop), content_(std::move(content)) {
    budget_.add_file(content_.size());
    if (content_.size() == 0) refuse(this->path(), "is empty");
    if (is_glb(content_.span())) {
        split_glb();
    } else {
        parse(content_.span());
    }
}

void GltfFile::split_glb() {
    const std::span<const std::byte> all = content_.span();
    const auto cut = [&](std::uint64_t bytes) {
        refuse(path(), fmt::format("is cut: a GLB file of {} bytes, but it says that it has {}; copy it again",
                                   all.size(), bytes));
    };
    if (all.size() < header_bytes) cut(header_bytes);
    if (const std::uint32_t version = number_at(all, 4); version != 2) {
        version_ = fmt::format("{}.0", version);
        return;
    }
    const std::uint64_t length = number_at(all, 8);
    if (length > all.size()) cut(length);
    std::span<const std::byte> text;
    for (std::uint64_t at = header_bytes; at + chunk_header_bytes <= length;) {
        const std::uint64_t size = number_at(all, at), type = number_at(all, at + 4);
        at += chunk_header_bytes;
        if (size > length - at) cut(at + size);
        const auto chunk = all.subspan(at, size);
        if (text.data() == nullptr) {
            if (type != json_chunk) refuse(path(), "the first chunk of the GLB file is not JSON");
            text = chunk;
        } else if (type == binary_chunk && binary_chunk_.data() == nullptr) {
            binary_chunk_ = chunk;
        }
        at += size;
    }
    while (!text.empty() && text.back() == std::byte(0)) text = text.first(text.size() - 1);  // wrong padding
    parse(text);
}

void GltfFile::parse(std::span<const std::byte> text) {
    root_ = parsed(text_of(text), path(), stop());
    (void)JsonFields(fields().required("asset"), fields().place_of("asset")).required("version");
    version_ = version_of(fields(), "version");
    check_least_version(fields());
}

std::size_t GltfFile::count(std::string_view list) const { return array_or_empty(fields(), list).size(); }

JsonFields GltfFile::item(std::string_view list, std::uint64_t number) const {
    const json::array_t& items = array_or_empty(fields(), list);
    if (number >= items.size()) {
        refuse(path(), fmt::format("refers to {}[{}], but the file has {} {}", list, number, items.size(), list));
    }
    return {items[number], fmt::format("{}: {}[{}]", path(), list, number)};
}

BufferView GltfFile::view(std::uint64_t number) {
    const JsonFields fields = item("bufferViews", number);
    const std::uint64_t offset = whole_number_or(fields, "byteOffset", 0), size = whole_number(fields, "byteLength");
    const std::uint64_t from = whole_number(fields, "buffer");
    const auto bytes = buffer(from);
    if (offset > bytes.size() || size > bytes.size() - offset) {
        refuse(fields.place(),
               fmt::format("ends at byte {} of buffers[{}], which has {} bytes", offset + size, from, bytes.size()));
    }
    return {bytes.subspan(offset, size), whole_number_or(fields, "byteStride", 0),
            fmt::format("bufferViews[{}]", number)};
}

std::span<const std::byte> GltfFile::buffer(std::uint64_t number) {
    const JsonFields fields = item("buffers", number);
    const auto bytes = bytes_of(fields, number);
    const std::uint64_t size = whole_number(fields, "byteLength");
    if (size > bytes.size())
        fields.refuse_key("byteLength", fmt::format("{}, but its data have {} bytes; copy or export the file again",
                                                    size, bytes.size()));
    return bytes.first(size);
}

std::span<const std::byte> GltfFile::bytes_of(const JsonFields& buffer, std::uint64_t number) {
    const auto known = buffers_.find(number);
    if (known != buffers_.end()) return known->second.span();
    if (buffer.find("uri") == nullptr) {
        if (number != 0 || binary_chunk_.data() == nullptr)
            refuse(buffer.place(), "has no URI, and the file has no binary chunk for it");
        return binary_chunk_;
    }
    const std::string& uri = buffer.text("uri");
    const bool is_data = equal_in_any_case(scheme_of(uri).value_or(""), "data");
    Buffer<std::byte> bytes = is_data ? embedded(buffer, uri) : other_file(buffer, uri);
    if (!is_data) budget_.add_file(bytes.size());
    return buffers_.emplace(number, std::move(bytes)).first->second.span();
}

Buffer<std::byte> GltfFile::embedded(const JsonFields& buffer, std::string_view uri) const {
    const std::optional<UriData> data = data_of(uri);
    if (!data) buffer.refuse_key("uri", fmt::format("'{}' has no comma before its data", shown_text(uri)));
    std::string_view text = data->text;
    std::string decoded;
    if (text.find('%') != std::string_view::npos) text = decoded = percent_decoded(text);
    if (!data->is_base64) {
        Buffer<std::byte> bytes{text.size()};
        std::memcpy(bytes.data(), text.data(), text.size());
        return bytes;
    }
    auto bytes = decoded_base64(text, stop());
    if (!bytes) bytes = decoded_base64(without_blanks(text), stop());  // rare: the base64 text has several lines
    if (!bytes) buffer.refuse_key("uri", fmt::format("'{}' is not valid base64", shown_text(uri)));
    return std::move(*bytes);
}

Buffer<std::byte> GltfFile::other_file(const JsonFields& buffer, std::string_view uri) const {
    const auto refuse_uri = [&](std::string_view what) {
        buffer.refuse_key("uri", fmt::format("'{}' {}; put the data into a file beside this one, and give its name",
                                             shown_text(uri), what));
    };
    if (const auto scheme = scheme_of(uri))
        refuse_uri(fmt::format("has the scheme '{}', not the name of a file", *scheme));
    const std::string name = percent_decoded(uri);
    if (name.empty() || name.find('\0') != std::string::npos) refuse_uri("is not the name of a file");
    if (name.starts_with('/')) refuse_uri("is an absolute name");
    // If the folder is ".", the path cannot be "-", which would mean standard input.
    const auto parent = std::filesystem::path(path()).parent_path();
    const auto folder = parent.empty() ? std::filesystem::path(".") : parent;
    std::error_code error;
    std::filesystem::path file = folder / name;
    // Some exporters do not encode the name. The decoded name comes first.
    if (!std::filesystem::exists(file, error) && std::filesystem::exists(folder / uri, error)) file = folder / uri;
    if (!std::filesystem::exists(file, error))
        buffer.refuse_key("uri", fmt::format("there is no file '{}' in {}", shown_text(name), folder.string()));
    if (!std::filesystem::is_regular_file(file, error))
        buffer.refuse_key("uri", fmt::format("'{}' is not a regular file", shown_text(uri)));
    try {
        return content_of(file.string(), stop());
    } catch (const Error& failure) {
        if (failure.code() == ErrorCode::cancelled) throw;
        throw Error(failure.code(), fmt::format("{}: {}", buffer.place(), failure.what()));
    }
}

bool may_need_assimp(const std::string& path) {
    try {
        const InputFile file(path);
        std::array<std::byte, header_bytes + chunk_header_bytes> head{};
        const auto some = std::size_t(std::min<std::uint64_t>(head.size(), file.size()));
        file.read(0, std::span(head).first(some));
        std::uint64_t begin = 0, size = file.size();
        if (is_glb(head)) {
            if (number_at(head, 4) == 1) return true;
            begin = std::min<std::uint64_t>(head.size(), file.size());
            size = std::min<std::uint64_t>(number_at(head, header_bytes), file.size() - begin);
        }
        Buffer<std::byte> bytes{std::size_t(size)};
        file.read(begin, bytes.span());
        const std::string_view text = text_of(bytes.span());
        return text.find("KHR_draco_mesh_compression") != std::string_view::npos || names_version_1(text);
    } catch (const Error&) {
        return false;  // reading the file will throw the error
    }
}

}  // namespace octopair::io::gltf
