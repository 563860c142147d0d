// Tests the reader of OBJ with random files, in all spellings of the format, whose content is known.
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "io/spelling.hpp"

namespace octopair::test {
namespace {

/// A random OBJ file: its text, and what it says.
class ObjFile {
public:
    explicit ObjFile(std::uint64_t seed) : spelling_(seed), capitals_(spelling_.one_in(8)) {
        text_ = spelling_.byte_order_mark();
        keep_part();
        for (std::uint64_t i = 3 + spelling_.below(4); i > 0; --i) write_vertex();
        for (std::uint64_t i = 1 + spelling_.below(12); i > 0; --i) write_anything();
        write_face();
        if (spelling_.one_in(2)) text_.resize(text_.size() - spelling_.line_end().size());
    }

    const std::string& text() const { return text_; }
    Spelling& spelling() { return spelling_; }
    std::uint64_t warnings() const { return vendor_lines_ > 0; }

    std::vector<io::PlainMesh> meshes() const {
        std::map<std::string, int> uses;
        for (const Part& part : parts_) uses[part.group] += !part.mesh.ends.empty();
        std::vector<io::PlainMesh> meshes;
        for (const Part& part : parts_) {
            if (part.mesh.ends.empty()) continue;
            meshes.push_back(part.mesh);
            meshes.back().name =
                uses[part.group] > 1 && part.group != part.object ? part.object + "/" + part.group : part.group;
            give_vertices(meshes.back());
        }
        return meshes;
    }

private:
    /// The faces of one group of one object. Corners are vertices of the file.
    struct Part {
        std::string object, group;
        io::PlainMesh mesh;
    };

    void give_vertices(io::PlainMesh& mesh) const {
        std::map<std::uint32_t, std::uint32_t> numbers;
        for (std::uint32_t& corner : mesh.corners) {
            const auto [known, is_new] = numbers.try_emplace(corner, std::uint32_t(mesh.vertices.size()));
            if (is_new) mesh.vertices.push_back(vertices_[corner]);
            corner = known->second;
        }
    }

    /// Makes the part of the current group the current one.
    void keep_part() {
        const std::string group = group_.empty() ? object_ : group_, object = object_.empty() ? group : object_;
        for (current_ = 0; current_ < parts_.size(); ++current_) {
            if (parts_[current_].object == object && parts_[current_].group == group) return;
        }
        parts_.push_back({object, group, {}});
    }

    void begin_line(const char* keyword) {
        while (spelling_.one_in(6)) text_ += spelling_.indent() + spelling_.line_end();
        if (spelling_.one_in(8)) text_ += spelling_.indent() + "# v 1 2 3 \\" + spelling_.line_end();
        text_ += spelling_.indent() + spelling_.in_case(keyword, capitals_);
    }
    void end_line(bool with_comment) {
        if (with_comment && spelling_.one_in(6)) text_ += spelling_.pick({"#", " # 7", "\t#a # b"});
        text_ += spelling_.indent() + spelling_.line_end();
    }
    /// Writes what separates words; the line may continue on the next.
    void write_blank() {
        text_ += spelling_.blank();
        if (spelling_.one_in(12)) text_ += "\\" + spelling_.line_end() + spelling_.indent();
    }

    void write_vertex() {
        begin_line("v");
        Point3d place;
        for (double& at : place) {
            const SpelledNumber number = spelling_.spelled();
            write_blank();
            text_ += number.text;
            at = number.value;
        }
        vertices_.push_back(place);
        text_ += spelling_.pick({"", "", " 1.0", " 0.5", " 0.5 0.25 1", " 1 0.5 0.25 1"});  // a weight, or a colour
        end_line(true);
    }

    void write_face() {
        const bool points = spelling_.one_in(12), line = !points && spelling_.one_in(12);
        const std::size_t corners = points ? 1 + spelling_.below(3)
                                    : line ? 2 + spelling_.below(3)
                                           : 3 + spelling_.below(4);
        begin_line(points ? "p" : line ? "l" : spelling_.one_in(8) ? "fo" : "f");
        std::vector<std::uint32_t> numbers;
        for (std::size_t i = 0; i < corners; ++i) {
            const std::size_t vertex = spelling_.below(vertices_.size());
            write_blank();
            text_ += spelling_.one_in(4) ? fmt::format("-{}", vertices_.size() - vertex) : std::to_string(vertex + 1);
            text_ += spelling_.pick({"", "", "/1", "//2", "/1/2", "/-1", "//-1"});
            numbers.push_back(std::uint32_t(vertex));
        }
        add_faces(numbers, points ? 1 : line ? 2 : corners);
        end_line(true);
    }

    /// Adds each `size` successive corners as a face.
    void add_faces(const std::vector<std::uint32_t>& corners, std::size_t size) {
        io::PlainMesh& mesh = parts_[current_].mesh;
        for (std::size_t i = 0; i + size <= corners.size(); ++i) {
            for (std::size_t k = 0; k < size; ++k) mesh.corners.push_back(corners[i + k]);
            mesh.end_face();
        }
        if (!material_.empty()) mesh.materials.insert(material_);
    }

    void write_name(const char* keyword, std::string& name) {
        name = spelling_.pick({"bolt#1", "bolt#2", "a b", "K\xc3\xb6rper", "part", "#"});
        begin_line(keyword);
        text_ += spelling_.blank() + name;
        end_line(false);
    }

    void write_anything() {
        switch (spelling_.below(10)) {
            case 0:
                write_name("o", object_);
                group_.clear();
                return keep_part();
            case 1:
                write_name("g", group_);
                return keep_part();
            case 2:
                group_.clear();
                begin_line("g");
                end_line(false);
                return keep_part();
            case 3:
                return write_name("usemtl", material_);
            case 4:
                begin_line(
                    spelling_.pick({"vn 0 0 1", "vt 0.5 0.5", "s off", "mtllib a b.mtl", "lod 3", "vp 1"}).c_str());
                return end_line(true);
            case 5:
                vendor_lines_ += 1;
                begin_line("vendor_line");
                return end_line(true);
            case 6:
            case 7:
                return write_vertex();
            default:
                return write_face();
        }
    }

    Spelling spelling_;
    bool capitals_;
    std::string text_, object_, group_, material_;
    std::vector<Point3d> vertices_;
    std::vector<Part> parts_;
    std::size_t current_ = 0;
    std::uint64_t vendor_lines_ = 0;
};

TEST(GeneratedFiles, OfObjAreReadAsTheyAreWritten) {
    const std::stop_token without_stop;
    for (std::uint64_t i = 0; i < generated_files(); ++i) {
        const std::uint64_t seed = case_seed("obj", i);
        ObjFile file(seed);
        std::vector<std::string> warnings;
        const auto meshes = io::parse_obj({file.text(), "m.obj", without_stop, {}, &warnings});
        ASSERT_EQ(difference(meshes, file.meshes()), "") << repetition(seed, file.text());
        ASSERT_EQ(warnings.size(), file.warnings()) << repetition(seed, file.text());

        const std::string mutated = file.spelling().mutated(file.text());
        const std::string fault = fault_of_reading("m.obj: ", [&] {
            return fault_of_mesh(io::parse_obj({mutated, "m.obj", without_stop}));
        });
        ASSERT_EQ(fault, "") << repetition(seed, mutated);
    }
}

}  // namespace
}  // namespace octopair::test
