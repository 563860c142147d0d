// Checks XGL files, and writes them in a form that Assimp reads rightly (correct_xgl()).
#include "io/meshes/assimp/content/mesh_content.hpp"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <new>
#include <optional>
#include <set>
#include <vector>

#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "io/meshes/text_words.hpp"
#include "io/meshes/xml/xml_tree.hpp"

namespace octopair::io {

namespace {

using XglPoint = std::array<double, 3>;

std::string capitals(std::string_view text) {
    std::string result(text);
    for (char& c : result) c = c >= 'a' && c <= 'z' ? char(c - 32) : c;
    return result;
}

/// Returns whether an element has this name, in capitals or small letters.
bool is_called(const XmlElement& element, std::string_view name) { return capitals(element.name()) == name; }

std::optional<XmlElement> child_called(const XmlElement& parent, std::string_view name) {
    for (const XmlElement& child : parent.children()) {
        if (is_called(child, name)) return child;
    }
    return std::nullopt;
}

std::optional<std::string_view> id_of(const XmlElement& element) {
    const auto id = element.attribute("ID");
    return id ? id : element.attribute("id");
}

std::string_view word_in(const XmlElement& element) {
    std::string_view text = element.text();
    return take_list_word(text);
}

/// Returns the numbers of an element, separated by commas or white space.
std::vector<double> numbers_in(const XmlElement& element, std::size_t count) {
    NumberList list = numbers_of(element.text(), ",");
    if (!list.wrong.empty())
        element.refuse(fmt::format("<{}> has '{}', which is no number", element.name(), shown(list.wrong)));
    if (list.numbers.size() != count)
        element.refuse(fmt::format("<{}> has {} numbers in place of {}", element.name(), list.numbers.size(), count));
    return std::move(list.numbers);
}

XglPoint point_in(const XmlElement& element) {
    const std::vector<double> numbers = numbers_in(element, 3);
    return {numbers[0], numbers[1], numbers[2]};
}

/// The axes of an object, and its origin, in the world.
struct XglPose {
    std::array<XglPoint, 3> axes = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    XglPoint origin{};

    XglPoint direction(const XglPoint& vector) const {
        XglPoint moved{};
        for (std::size_t k = 0; k < 3; ++k) {
            for (std::size_t axis = 0; axis < 3; ++axis) moved[k] += axes[axis][k] * vector[axis];
        }
        return moved;
    }
    XglPoint place(const XglPoint& point) const {
        XglPoint moved = direction(point);
        for (std::size_t k = 0; k < 3; ++k) moved[k] += origin[k];
        return moved;
    }
};

XglPoint unit_vector(const XmlElement& element, const XglPoint& vector) {
    const double length = std::hypot(vector[0], vector[1], vector[2]);
    if (!(length > 0) || !std::isfinite(length)) element.refuse(fmt::format("<{}> has no direction", element.name()));
    return {vector[0] / length, vector[1] / length, vector[2] / length};
}

/// Returns the pose that a TRANSFORM gives: its y is UP, its z is FORWARD.
XglPose pose_of_transform(const XmlElement& transform) {
    XglPoint forward = {0, 0, 1}, up = {0, 1, 0};
    XglPose pose;
    double scale = 1;
    for (const XmlElement& child : transform.children()) {
        if (is_called(child, "FORWARD")) forward = unit_vector(child, point_in(child));
        if (is_called(child, "UP")) up = unit_vector(child, point_in(child));
        if (is_called(child, "POSITION")) pose.origin = point_in(child);
        if (is_called(child, "SCALE")) scale = numbers_in(child, 1)[0];
    }
    if (std::abs(up[0] * forward[0] + up[1] * forward[1] + up[2] * forward[2]) > 1e-4)
        transform.refuse("the directions FORWARD and UP are not perpendicular");
    const XglPoint right = {up[1] * forward[2] - up[2] * forward[1], up[2] * forward[0] - up[0] * forward[2],
                            up[0] * forward[1] - up[1] * forward[0]};
    pose.axes = {right, up, forward};
    for (XglPoint& axis : pose.axes) {
        for (double& number : axis) number *= scale;
    }
    return pose;
}

XglPose product(const XglPose& outer, const XglPose& inner) {
    XglPose result;
    for (std::size_t axis = 0; axis < 3; ++axis) result.axes[axis] = outer.direction(inner.axes[axis]);
    result.origin = outer.place(inner.origin);
    return result;
}

class XglWriter {
public:
    explicit XglWriter(const XmlTree& tree) : tree_(tree) {
        for (std::size_t i = 0; i < tree.size(); ++i) {
            const XmlElement element = tree.at(i);
            if (is_called(element, "OBJECTREF")) placed_.emplace(word_in(element));
            const auto id = id_of(element);
            if (!id) continue;
            if (is_called(element, "MESH")) meshes_[std::string(*id)] = i;
            if (is_called(element, "OBJECT")) objects_[std::string(*id)] = i;
        }
    }

    MeshContent write() {
        for (std::size_t i = 0; i < tree_.size(); ++i) {
            if (!is_called(tree_.at(i), "WORLD")) continue;
            out_.open("WORLD");
            write_material();
            write_content(tree_.at(i), {});
            out_.close();
            return {out_.take(), {}, left_out_.list()};
        }
        refuse(tree_.path(), "has no element <WORLD>, which XGL files have");
    }

private:
    void write_material() {
        out_.open("MAT");
        out_.attribute("ID", "0");
        for (const std::string_view colour : {"AMB", "DIFF"}) {
            out_.open(colour);
            out_.text("1.0, 1.0, 1.0");
            out_.close();
        }
        out_.close();
    }

    /// Writes the content of the world or of an object. `pose`: pose of this content in the world.
    void write_content(const XmlElement& object, const XglPose& pose) {
        if (std::find(open_.begin(), open_.end(), object.index()) != open_.end())
            object.refuse("the object refers to itself");
        if (out_.size() > max_bytes) object.refuse("the objects that are referred to are more than 2 GiB");
        open_.push_back(object.index());
        const auto transform = child_called(object, "TRANSFORM");
        const XglPose here = transform ? product(pose, pose_of_transform(*transform)) : pose;
        for (const XmlElement& child : object.children()) {
            if (is_called(child, "MESH") && !id_of(child)) write_mesh(child, here);
            if (is_called(child, "MESHREF")) write_mesh(referred(child, meshes_), here);
            if (is_called(child, "OBJECT") && !is_definition(child)) write_object(child, here);
            if (is_called(child, "OBJECTREF")) write_object(referred(child, objects_), here);
        }
        open_.pop_back();
    }

    /// Returns whether references place an object. If none does, the object is read where it stands in the world, as Assimp does.
    bool is_definition(const XmlElement& object) const {
        const auto id = id_of(object);
        return id && placed_.contains(*id);
    }

    void write_object(const XmlElement& object, const XglPose& pose) {
        out_.open("OBJECT");
        write_content(object, pose);
        out_.close();
    }

    XmlElement referred(const XmlElement& reference, const std::map<std::string, std::size_t>& definitions) const {
        const std::string_view id = word_in(reference);
        const auto found = definitions.find(std::string(id));
        if (found == definitions.end())
            reference.refuse(fmt::format("<{}> refers to '{}', which is not in the file", reference.name(), shown(id)));
        return tree_.at(found->second);
    }

    void write_mesh(const XmlElement& mesh, const XglPose& pose) {
        points_.clear();
        std::size_t faces = 0;
        for (const XmlElement& child : mesh.children()) {
            const auto id = id_of(child);
            if (is_called(child, "P") && id) points_[std::string(*id)] = pose.place(point_in(child));
            faces += is_called(child, "F") || is_called(child, "L");
            if (is_called(child, "PATCH")) left_out_.add("elements <PATCH>");
        }
        if (faces == 0) return;
        out_.open("MESH");
        std::map<std::string, std::size_t> numbers;
        for (const auto& [id, point] : points_) {
            const std::size_t number = numbers.size();
            numbers[id] = number;
            write_point(number, point);
        }
        for (const XmlElement& child : mesh.children()) {
            if (is_called(child, "F")) write_face(child, "F", 3, numbers);
            if (is_called(child, "L")) write_face(child, "L", 2, numbers);
        }
        out_.close();
    }

    void write_point(std::size_t number, const XglPoint& point) {
        out_.open("P");
        out_.attribute("ID", fmt::format("{}", number));
        out_.text(fmt::format("{}, {}, {}", point[0], point[1], point[2]));
        out_.close();
    }

    void write_face(const XmlElement& face, std::string_view type, std::size_t corners,
                    const std::map<std::string, std::size_t>& numbers) {
        out_.open(type);
        write_reference("MATREF", 0);
        for (std::size_t k = 1; k <= corners; ++k) {
            const std::string name = fmt::format("{}V{}", type, k);
            const auto corner = child_called(face, name);
            if (!corner) face.refuse(fmt::format("has no <{}>", name));
            const auto reference = child_called(*corner, "PREF");
            if (!reference) corner->refuse("has no <PREF>");
            const auto found = numbers.find(std::string(word_in(*reference)));
            if (found == numbers.end())
                reference->refuse(fmt::format("the point '{}' is not in the mesh", shown(word_in(*reference))));
            out_.open(name);
            write_reference("PREF", found->second);
            out_.close();
        }
        out_.close();
    }

    void write_reference(std::string_view name, std::size_t number) {
        out_.open(name);
        out_.text(fmt::format("{}", number));
        out_.close();
    }

    static constexpr std::size_t max_bytes = std::size_t(1) << 31;

    const XmlTree& tree_;
    XmlWriter out_;
    LeftOut left_out_;
    std::map<std::string, std::size_t> meshes_, objects_;  // ID -> element
    std::map<std::string, XglPoint> points_;               // points of the mesh that is being written
    std::set<std::string, std::less<>> placed_;            // IDs of objects that references place
    std::vector<std::size_t> open_;                        // objects that are being written
};

/// Returns the text of a ZGL file: two bytes, and deflated text.
std::string inflated(const std::string& path, std::string_view bytes) {
    constexpr std::size_t header = 2, max_text = std::size_t(1) << 31;
    std::string text;
    z_stream stream{};
    if (::inflateInit2(&stream, -MAX_WBITS) != Z_OK) throw std::bad_alloc();
    const std::unique_ptr<z_stream, decltype(&::inflateEnd)> owner(&stream, &::inflateEnd);
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data() + std::min(header, bytes.size())));
    stream.avail_in = uInt(bytes.size() - std::min(header, bytes.size()));
    for (int state = Z_OK; state != Z_STREAM_END;) {
        const std::size_t before = text.size();
        text.resize(before + (std::size_t(1) << 16));
        stream.next_out = reinterpret_cast<Bytef*>(text.data() + before);
        stream.avail_out = uInt(text.size() - before);
        state = ::inflate(&stream, Z_NO_FLUSH);
        text.resize(text.size() - stream.avail_out);
        if (state != Z_OK && state != Z_STREAM_END) refuse(path, "is damaged or cut: it cannot be unpacked");
        if (text.size() > max_text) refuse(path, "has more than 2 GiB when it is unpacked");
    }
    return text;
}

}  // namespace

MeshContent correct_xgl(const std::string& path, std::string_view bytes) {
    const XmlTree tree(path, bytes);
    return XglWriter(tree).write();
}

MeshContent correct_zgl(const std::string& path, std::string_view bytes) {
    const std::string text = inflated(path, bytes);
    MeshContent content = correct_xgl(path, text);
    content.ending = ".xgl";
    return content;
}

}  // namespace octopair::io
