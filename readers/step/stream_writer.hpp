// StreamWriter: writes a model stream (docs/formats.md, "Model streams"). Needs nothing of octopair's, so any reader may copy it.
#pragma once

#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace octopair::reader {

struct StreamedShape {
    double error = 0;  ///< greatest distance of the triangles from the true surface
    std::vector<std::array<double, 3>> vertices;
    std::vector<std::array<std::uint32_t, 3>> triangles;
};

struct StreamedInstance {
    std::uint32_t shape = 0;
    std::array<double, 16> transform;  ///< row by row
    std::string name, label = {}, type = {}, id = {}, parent = {}, level = {}, material = {}, host = {}, assembly = {};
    std::vector<std::string> systems = {};
};

/// Elements that have a shape but could not be read, by type.
class LostCounts {
public:
    struct Count {
        std::string type;
        std::uint64_t count;
        std::string first;
    };

    void add(const std::string& type, const std::string& which) {
        for (Count& known : counts) {
            if (known.type == type) return void(++known.count);
        }
        counts.push_back({type, 1, which});
    }

    std::vector<Count> counts;
};

class StreamWriter {
public:
    explicit StreamWriter(int descriptor) : descriptor_(descriptor) {
        add(std::string_view("OPMODEL\n").substr(0, 8), waiting_);
        add(std::uint32_t(1), waiting_);
    }

    void model(std::string_view unit, std::string_view up, std::string_view project) {
        Bytes record;
        for (const std::string_view text : {unit, up, project}) add_text(text, record);
        put(1, record);
    }
    /// Returns the number of the shape.
    std::uint32_t shape(const StreamedShape& shape) {
        Bytes record;
        add(shape.error, record);
        add(std::uint32_t(shape.vertices.size()), record);
        add(std::uint32_t(shape.triangles.size()), record);
        for (const auto& vertex : shape.vertices) add(vertex, record);
        for (const auto& triangle : shape.triangles) add(triangle, record);
        put(2, record);
        return shapes_++;
    }
    void instance(const StreamedInstance& instance) {
        Bytes record;
        add(instance.shape, record);
        add(instance.transform, record);
        for (const std::string& text : {instance.name, instance.label, instance.type, instance.id, instance.parent,
                                        instance.level, instance.material, instance.host, instance.assembly})
            add_text(text, record);
        add(std::uint32_t(instance.systems.size()), record);
        for (const std::string& system : instance.systems) add_text(system, record);
        put(3, record);
    }
    /// Says which element comes next. Goes out at once, because the work on the element may crash.
    void element(std::string_view text) {
        put_text(4, text);
        flush();
    }
    void warning(std::string_view text) { put_text(5, text); }
    void end(std::uint64_t with_geometry, std::uint64_t read, const LostCounts& lost) {
        Bytes record;
        add(with_geometry, record);
        add(read, record);
        add(std::uint32_t(lost.counts.size()), record);
        for (const auto& [type, count, first] : lost.counts) {
            add_text(type, record);
            add(count, record);
            add_text(first, record);
        }
        add(std::uint32_t(0), record);  // types left out
        put(7, record);
        flush();
    }

private:
    using Bytes = std::vector<char>;

    template <typename T>
    static void add(const T& value, Bytes& bytes) {
        const char* const begin = reinterpret_cast<const char*>(&value);
        bytes.insert(bytes.end(), begin, begin + sizeof value);
    }
    static void add(std::string_view text, Bytes& bytes) { bytes.insert(bytes.end(), text.begin(), text.end()); }
    static void add_text(std::string_view text, Bytes& bytes) {
        add(std::uint32_t(text.size()), bytes);
        add(text, bytes);
    }
    void put_text(std::uint32_t kind, std::string_view text) {
        Bytes record;
        add_text(text, record);
        put(kind, record);
    }
    void put(std::uint32_t kind, const Bytes& record) {
        add(kind, waiting_);
        add(std::uint64_t(record.size()), waiting_);
        waiting_.insert(waiting_.end(), record.begin(), record.end());
        if (waiting_.size() > (std::size_t(1) << 20)) flush();
    }
    void flush() {
        for (std::size_t at = 0; at < waiting_.size();) {
            const ssize_t written = ::write(descriptor_, waiting_.data() + at, waiting_.size() - at);
            if (written < 0 && errno == EINTR) continue;
            if (written < 0) throw std::runtime_error("cannot write the stream: " + std::string(std::strerror(errno)));
            at += std::size_t(written);
        }
        waiting_.clear();
    }

    int descriptor_;
    Bytes waiting_;
    std::uint32_t shapes_ = 0;
};

}  // namespace octopair::reader
