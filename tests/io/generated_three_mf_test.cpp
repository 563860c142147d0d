// Tests the reader of 3MF with random files, in all spellings of the format, whose content is known.
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "io/spelling.hpp"
#include "io/three_mf_reading.hpp"

namespace octopair::test {
namespace {

/// What a file says of an object of the build.
struct WrittenObject {
    std::string name, label, material;
    Pose pose;
    const shape::Mesh* mesh;
};

struct WrittenReference {
    std::size_t part, number;
    Pose pose;
    std::string part_number;
};

struct Written3mfObject {
    int id;
    std::string name, part_number, material;
    shape::Mesh mesh;
    std::vector<WrittenReference> components;

    const std::string& label(const WrittenReference& reference) const {
        return !name.empty() ? name : reference.part_number.empty() ? part_number : reference.part_number;
    }
};

struct WrittenPart {
    std::string path, text;  // of the file within the package, and its content
    std::vector<Written3mfObject> objects;
};

/// Returns the pose that applies `b` first, in plain float64.
Pose product(const Pose& a, const Pose& b) {
    Pose pose;
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 4; ++column) {
            double sum = 0;
            for (int k = 0; k < 3; ++k) sum += a.rows[row][k] * b.rows[k][column];
            pose.rows[row][column] = column == 3 ? sum + a.rows[row][3] : sum;
        }
    }
    return pose;
}

/// A random 3MF file: its bytes, and what it says.
class ThreeMfFile {
public:
    explicit ThreeMfFile(std::uint64_t seed) : spelling(seed) {
        core_ = spelling.pick({"", "", "c:", "core-1.2:"});
        production_ = spelling.pick({"p", "production", "P_"});
        unit = spelling.pick({"", "micron", "millimeter", "centimeter", "inch", "foot", "meter"});
        parts_.resize(1 + spelling.below(3));
        for (std::size_t i = parts_.size(); i-- > 0;)
            write_part(i);  // the start part comes last: it refers to the others
        pack();
        const bool several = items_.size() > 1;
        list(items_, several ? "ROOT" : "", Pose());
    }

    Spelling spelling;
    std::string bytes, unit;
    std::vector<WrittenObject> objects;

private:
    using Attributes = std::vector<std::pair<std::string, std::string>>;

    std::string white() { return spelling.pick({"", "", "\n", "  ", "\r\n\t", "<!-- <vertex x='1'/> -->", "<?a b?>"}); }

    /// Returns the start of an element, in any order of its attributes.
    std::string tag(const std::string& name, Attributes attributes, bool empty) {
        spelling.shuffle(attributes);
        std::string text = white() + "<" + core_ + name;
        for (const auto& [key, value] : attributes) {
            const std::string quote = spelling.pick({"'", "\""});
            text += spelling.pick({" ", "\n", "\t "}) + key + spelling.pick({"=", " = "}) + quote + value + quote;
        }
        text += spelling.pick({"", " "});
        return text + (empty ? spelling.one_in(2) ? "/>" : "></" + core_ + name + ">" : ">");
    }
    std::string begin(const std::string& name, const Attributes& attributes = {}) {
        return tag(name, attributes, false);
    }
    std::string end(const std::string& name) { return white() + "</" + core_ + name + spelling.pick({">", " >"}); }

    /// Returns a value with white space around it, as attributes of numbers may have.
    std::string padded(const std::string& value) {
        return spelling.one_in(4) ? spelling.pick({" ", "&#10;", "\t"}) + value + spelling.pick({" ", "", "\n"})
                                  : value;
    }

    SpelledNumber small_number() {
        const auto whole = double(std::int64_t(spelling.below(2001)) - 1000);
        return spelling.spelled(spelling.one_in(2) ? whole : whole / double(1 + spelling.below(1000)));
    }

    std::string some_name() {
        if (spelling.one_in(3)) return "";
        return spelling.pick({"bolt", "plate", "a/b",
                              "Gr\xc3\xb6\xc3\x9f"
                              "e",
                              "x y", "1"});
    }

    Pose write_transform(Attributes& attributes) {
        Pose pose;
        if (spelling.one_in(3)) return pose;
        std::string text;
        for (std::size_t i = 0; i < 12; ++i) {
            const SpelledNumber number = small_number();
            pose.rows[i % 3][i / 3] = number.value;
            text += (i == 0 ? "" : spelling.pick({" ", "  ", "\n"})) + number.text;
        }
        attributes.emplace_back("transform", padded(text));
        return pose;
    }

    void write_part(std::size_t index) {
        WrittenPart& part = parts_[index];
        part.path = index == 0 ? spelling.pick({"3D/3dmodel.model", "a.model", "3D/My Model.model"})
                               : fmt::format("3D/Objects/{}.model", index);
        std::string body = begin("resources");
        const bool has_materials = spelling.one_in(2);
        if (has_materials) body += write_materials();
        const std::size_t count = 1 + spelling.below(4);
        for (std::size_t i = 0; i < count; ++i) body += write_object(index, has_materials);
        body += end("resources") + begin("build");
        const std::size_t items = index == 0 ? spelling.below(4) : spelling.below(2);
        for (std::size_t i = 0; i < items; ++i) {
            const bool is_start = index == 0;
            WrittenReference item;
            body += write_reference("item", index, part.objects.size(), item);
            if (is_start) items_.push_back(item);
        }
        part.text = declaration() + begin("model", model_attributes()) + body + end("build") + end("model") + white();
    }

    std::string declaration() {
        return spelling.pick({"", "<?xml version=\"1.0\"?>", "<?xml version='1.0' encoding='UTF-8'?>", "\xef\xbb\xbf"});
    }

    Attributes model_attributes() {
        Attributes attributes = {
            {core_.empty() ? "xmlns" : "xmlns:" + core_.substr(0, core_.size() - 1), core_space},
            {"xmlns:" + production_, "http://schemas.microsoft.com/3dmanufacturing/production/2015/06"}};
        if (!unit.empty()) attributes.emplace_back("unit", unit);
        if (spelling.one_in(2)) attributes.emplace_back("requiredextensions", padded(production_));
        if (spelling.one_in(2)) attributes.emplace_back("xml:lang", "en-US");
        return attributes;
    }

    std::string write_materials() {
        std::string text = begin("basematerials", {{"id", "1000"}});
        for (const char* const name : {"steel", "wood", "PLA"})
            text += tag("base", {{"name", name}, {"displaycolor", "#FFFFFF"}}, true);
        return text + end("basematerials");
    }

    std::string write_object(std::size_t index, bool has_materials) {
        WrittenPart& part = parts_[index];
        Written3mfObject object;
        object.id = int(1 + part.objects.size() * 7);
        object.name = some_name();
        object.part_number = spelling.one_in(4) ? "no. 5" : "";
        Attributes attributes = {{"id", padded(std::to_string(object.id))}};
        if (!object.name.empty()) attributes.emplace_back("name", object.name);
        if (!object.part_number.empty()) attributes.emplace_back("partnumber", object.part_number);
        if (spelling.one_in(4)) attributes.emplace_back("type", spelling.pick({"model", "surface"}));
        if (spelling.one_in(4)) attributes.emplace_back(production_ + ":UUID", "0");
        const bool is_mesh = part.objects.empty() || spelling.one_in(2);
        std::string text;
        if (is_mesh) {
            const bool own = has_materials && spelling.one_in(2);
            if (own) {
                attributes.emplace_back("pid", "1000");
                attributes.emplace_back("pindex", "0");
            }
            text = write_mesh(object, has_materials, own);
        } else {
            text = begin("components");
            const std::size_t count = 1 + spelling.below(3);
            for (std::size_t i = 0; i < count; ++i)
                text += write_reference("component", index, part.objects.size(), object.components.emplace_back());
            text += end("components");
        }
        part.objects.push_back(std::move(object));
        return begin("object", attributes) + text + end("object");
    }

    /// Writes a reference to one of the first `before` objects of a part, or from the start part to another one.
    std::string write_reference(const std::string& name, std::size_t index, std::size_t before, WrittenReference& to) {
        to.part = index == 0 && spelling.one_in(2) ? spelling.below(parts_.size()) : index;
        const auto& targets = parts_[to.part].objects;
        to.number = spelling.below(to.part == index ? before : targets.size());
        Attributes attributes = {{"objectid", padded(std::to_string(targets[to.number].id))}};
        if (to.part != index || (index == 0 && spelling.one_in(4))) {
            std::string path = "/" + parts_[to.part].path;
            if (spelling.one_in(4)) path = spelling.in_case(path, true);
            attributes.emplace_back(production_ + ":path", path);
        }
        if (name == "item" && spelling.one_in(3)) {
            to.part_number = "item 9";
            attributes.emplace_back("partnumber", to.part_number);
        }
        to.pose = write_transform(attributes);
        return tag(name, attributes, true);
    }

    std::string write_mesh(Written3mfObject& object, bool has_materials, bool own_material) {
        const std::size_t vertices = 3 + spelling.below(6), triangles = 1 + spelling.below(6);
        std::string text = begin("mesh") + begin("vertices");
        std::vector<Point3d> places(vertices);
        for (Point3d& place : places) {
            Attributes attributes;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const SpelledNumber number = small_number();
                place[axis] = number.value;
                attributes.emplace_back(std::string(1, "xyz"[axis]), padded(number.text));
            }
            text += tag("vertex", attributes, true);
        }
        text += end("vertices") + begin("triangles");
        std::map<std::uint32_t, std::uint32_t> used;
        std::set<std::string> materials;
        for (std::size_t i = 0; i < triangles; ++i) {
            std::vector<std::uint32_t> all(vertices);
            for (std::size_t k = 0; k < vertices; ++k) all[k] = std::uint32_t(k);
            spelling.shuffle(all);
            object.mesh.triangles.push_back({all[0], all[1], all[2]});
            Attributes attributes;
            for (std::size_t k = 0; k < 3; ++k) {
                used[all[k]] = 0;
                attributes.emplace_back(fmt::format("v{}", k + 1), padded(std::to_string(all[k])));
            }
            write_property(has_materials, own_material, attributes, materials);
            text += tag("triangle", attributes, true);
        }
        keep_used(object.mesh, places, used);
        object.material = fmt::format("{}", fmt::join(materials, ", "));
        return text + end("triangles") + end("mesh");
    }

    void write_property(bool has_materials, bool own, Attributes& attributes, std::set<std::string>& materials) {
        if (has_materials && spelling.one_in(3)) {
            const bool is_wood = spelling.one_in(2);
            materials.insert(is_wood ? "wood" : "PLA");
            attributes.emplace_back("p1", is_wood ? "1" : "2");
            if (!own || spelling.one_in(2)) attributes.emplace_back("pid", "1000");
        } else if (own) {
            materials.insert("steel");
        }
    }

    static void keep_used(shape::Mesh& mesh, const std::vector<Point3d>& places,
                          std::map<std::uint32_t, std::uint32_t>& used) {
        for (auto& [vertex, number] : used) {
            number = std::uint32_t(mesh.vertices.size());
            mesh.vertices.push_back(places[vertex]);
        }
        for (auto& corners : mesh.triangles) {
            for (std::uint32_t& corner : corners) corner = used[corner];
        }
    }

    void pack() {
        ZipWriter zip;
        const bool zip64 = spelling.one_in(4);
        const auto form = [&] {
            return ZipForm{spelling.one_in(2), spelling.one_in(3), zip64 && spelling.one_in(2), {}};
        };
        std::vector<std::pair<std::string, std::string>> entries = {
            {spelling.pick({"_rels/.rels", "_RELS/.rels"}),
             relationships_to(spelling.pick({"/", ""}) + parts_[0].path)},
            {"[Content_Types].xml", "<Types/>"}};
        for (const WrittenPart& part : parts_) entries.emplace_back(part.path, part.text);
        spelling.shuffle(entries);
        for (const auto& [name, text] : entries) zip.add(name, text, form());
        bytes = zip.bytes(zip64, spelling.pick({"", "a comment"}));
    }

    /// Lists the objects below references, as a reader must find them.
    void list(const std::vector<WrittenReference>& references, const std::string& above, const Pose& pose) {
        std::map<std::string, std::size_t> counts;
        const auto object_of = [&](const WrittenReference& reference) -> const Written3mfObject& {
            return parts_[reference.part].objects[reference.number];
        };
        for (const WrittenReference& reference : references) ++counts[object_of(reference).label(reference)];
        for (std::size_t i = 0; i < references.size(); ++i) {
            const Written3mfObject& object = object_of(references[i]);
            const std::string& label = object.label(references[i]);
            const std::string own = label.empty() || counts[label] > 1 ? fmt::format("{}#{}", label, i) : label;
            const std::string name = above.empty() ? own : above + "/" + own;
            const Pose posed = product(pose, references[i].pose);
            if (object.components.empty()) {
                objects.push_back({name, label, object.material, posed, &object.mesh});
            } else {
                list(object.components, name, posed);
            }
        }
    }

    std::string core_, production_;  // prefixes; that of the core with its colon
    std::vector<WrittenPart> parts_;
    std::vector<WrittenReference> items_;
};

bool same_mesh(const shape::Mesh& a, const shape::Mesh& b) {
    return a.vertices == b.vertices && a.triangles == b.triangles;
}

/// Returns what distinguishes a scene from what was written; empty if nothing does.
std::string three_mf_difference(const LoadedScene& scene, const ThreeMfFile& file) {
    static const std::map<std::string, std::string> units = {
        {"", "mm"},     {"micron", "µm"}, {"millimeter", "mm"}, {"centimeter", "cm"},
        {"inch", "in"}, {"foot", "ft"},   {"meter", "m"}};
    if (scene.space.unit != units.at(file.unit)) return "unit " + scene.space.unit;
    if (!scene.warnings.empty()) return scene.warnings[0];
    if (scene.objects != file.objects.size())
        return fmt::format("{} objects, not {}", scene.objects, file.objects.size());
    for (std::size_t i = 0; i < file.objects.size(); ++i) {
        const WrittenObject& written = file.objects[i];
        if (scene.names[i] != written.name) return fmt::format("name {}, not {}", scene.names[i], written.name);
        if (scene.details.of(i, io::Detail::label) != written.label) return written.name + ": label";
        if (scene.details.of(i, io::Detail::material) != written.material) return written.name + ": material";
        if (scene.shapes->poses[i].rows != written.pose.rows) return written.name + ": pose";
        if (!same_mesh(three_mf_mesh(scene, i), *written.mesh)) return written.name + ": mesh";
    }
    return "";
}

TEST(GeneratedFiles, Of3mfAreReadAsTheyAreWritten) {
    std::size_t objects = 0;
    for (std::uint64_t i = 0; i < generated_files() / 10; ++i) {
        const std::uint64_t seed = case_seed("3mf", i);
        ThreeMfFile file(seed);
        objects += file.objects.size();
        ASSERT_EQ(three_mf_difference(three_mf_scene(file.bytes), file), "") << "OCTOPAIR_TEST_SEED=" << seed;

        const std::string mutated = file.spelling.mutated(file.bytes);
        const std::string fault = fault_of_reading("f.3mf: ", [&] {
            (void)three_mf_scene(mutated);
            return "";
        });
        ASSERT_EQ(fault, "") << "OCTOPAIR_TEST_SEED=" << seed;
    }
    EXPECT_GT(objects, 0u);
}

/// Mutates the XML, not the archive around it, whose checksums would show each change.
TEST(GeneratedFiles, Of3mfWithDamagedXmlAreReadOrRefused) {
    for (std::uint64_t i = 0; i < generated_files() / 10; ++i) {
        const std::uint64_t seed = case_seed("3mf xml", i);
        Spelling spelling(seed);
        const std::string bases = "<basematerials id='5'><base name='steel' displaycolor='#FF0000'/></basematerials>";
        const std::string text = spelling.mutated(model_text(
            bases + "<object id='1' name='a' pid='5' pindex='0'>" + tetrahedron("p1='0'") +
                "</object><object id='2'><components><component objectid='1' transform='1 0 0 0 1 0 0 0 1 0 0 "
                "0'/></components></object>",
            "<item objectid='2' partnumber='4'/><item objectid='1'/>", production_xmlns));
        const std::string fault = fault_of_reading("f.3mf: ", [&] {
            const LoadedScene scene = three_mf_scene(package_of(text));
            for (std::size_t object = 0; object < scene.objects; ++object) {
                const shape::Mesh& mesh = three_mf_mesh(scene, object);
                for (const auto& corners : mesh.triangles) {
                    for (const std::uint32_t corner : corners) {
                        if (corner >= mesh.vertices.size()) return "a corner is no vertex";
                    }
                }
            }
            return "";
        });
        ASSERT_EQ(fault, "") << "OCTOPAIR_TEST_SEED=" << seed << "\n" << text;
    }
}

}  // namespace
}  // namespace octopair::test
