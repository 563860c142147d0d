// Tests what 3MF files mean: items, components, transforms, names, materials, units, extensions, and errors.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "io/formats/format_choice.hpp"
#include "io/scene_reader.hpp"
#include "io/three_mf_reading.hpp"
#include "support/calls.hpp"

namespace octopair::test {
namespace {

using io::Detail;
using Names = std::vector<std::string>;

std::string object_text(int id, const std::string& content, const std::string& attributes = {}) {
    return fmt::format("<object id=\"{}\" {}>{}</object>", id, attributes, content);
}

std::string components(const std::string& list) { return "<components>" + list + "</components>"; }

/// Returns a file with one object, which is a tetrahedron, and items.
std::string one_object(const std::string& items, const std::string& attributes = {}) {
    return package_of(model_text(object_text(1, tetrahedron()), items, attributes));
}

void expect_in(const std::string& text, const std::string& part) { EXPECT_TRUE(has_text(text, part)); }

/// Expects that a start part is refused with a message that begins with its line and has a part.
void expect_model_refusal(const std::string& text, const std::string& part) {
    const std::string message = three_mf_refusal(package_of(text));
    EXPECT_EQ(message.find("f.3mf: 3D/3dmodel.model: line "), 0u) << message;
    expect_in(message, part);
}

TEST(ThreeMf, AnItemIsAnObject) {
    const LoadedScene scene = three_mf_scene(one_object("<item objectid=\"1\"/>"));
    EXPECT_EQ(scene.objects, 1u);
    EXPECT_EQ(scene.names, Names{"#0"});
    EXPECT_EQ(three_mf_box(scene).max[2], 1);
    EXPECT_EQ(scene.space, (io::SceneSpace{io::UpAxis::z, "mm"}));
    EXPECT_EQ(scene.largest_rounded, 0);
    const shape::Mesh& mesh = three_mf_mesh(scene);
    EXPECT_EQ(mesh.vertices.size(), 4u);
    EXPECT_EQ(mesh.triangles[1], (std::array<std::uint32_t, 3>{0, 1, 3}));
    EXPECT_TRUE(scene.warnings.empty());
}

TEST(ThreeMf, OnlyItemsOfTheBuildExist) {
    const std::string resources = object_text(1, tetrahedron(), "name='a'") + object_text(2, tetrahedron(), "name='b'");
    EXPECT_EQ(three_mf_scene(package_of(model_text(resources, "<item objectid='2'/>"))).names, Names{"b"});
    EXPECT_EQ(three_mf_scene(package_of(model_text(resources, ""))).objects, 0u);
}

TEST(ThreeMf, ATransformMultipliesARow) {
    const LoadedScene scene =
        three_mf_scene(one_object("<item objectid='1' transform='0 2 0 -3 0 0 0 0 4 10 20 30'/>"));
    // (x, y, z) becomes (-3 y + 10, 2 x + 20, 4 z + 30)
    const Box3d box = three_mf_box(scene);
    EXPECT_EQ(std::vector(box.min, box.min + 3), (std::vector<double>{7, 20, 30}));
    EXPECT_EQ(std::vector(box.max, box.max + 3), (std::vector<double>{10, 22, 34}));
}

TEST(ThreeMf, ComponentsAreObjectsThatShareShapes) {
    const std::string resources =
        object_text(1, tetrahedron(), "name='bolt'") + object_text(2, tetrahedron(), "name='plate'") +
        object_text(3,
                    components("<component objectid='1'/><component objectid='2'/>"
                               "<component objectid='1' transform='1 0 0 0 1 0 0 0 1 5 0 0'/>"),
                    "name='group'") +
        object_text(4, components("<component objectid='3' transform='2 0 0 0 2 0 0 0 2 0 0 0'/>"));
    const LoadedScene scene =
        three_mf_scene(package_of(model_text(resources, "<item objectid='4' transform='1 0 0 0 1 0 0 0 1 100 0 0'/>")));
    EXPECT_EQ(scene.names, (Names{"#0/group/bolt#0", "#0/group/plate", "#0/group/bolt#2"}));
    EXPECT_EQ(scene.details.of(2, Detail::label), "bolt");
    EXPECT_EQ(scene.details.of(2, Detail::parent), "group");
    EXPECT_EQ(scene.shapes->geometry, (std::vector<std::uint32_t>{0, 1, 0}));
    EXPECT_EQ(scene.shapes->parents, (std::vector<std::uint32_t>{0, 0, 0}));
    EXPECT_EQ(three_mf_box(scene, 2).min[0], 100 + 2 * 5);
    EXPECT_EQ(three_mf_box(scene, 2).max[0], 100 + 2 * 6);
}

TEST(ThreeMf, SeveralItemsAreBelowARoot) {
    const std::string resources = object_text(1, tetrahedron(), "name='a' partnumber='7'") +
                                  object_text(2, tetrahedron(), "partnumber='8'") + object_text(3, tetrahedron());
    const LoadedScene scene = three_mf_scene(
        package_of(model_text(resources,
                              "<item objectid='1'/><item objectid='2'/><item objectid='3' partnumber='9'/>"
                              "<item objectid='3'/><item objectid='1'/>")));
    EXPECT_EQ(scene.names, (Names{"ROOT/a#0", "ROOT/8", "ROOT/9", "ROOT/#3", "ROOT/a#4"}));
    EXPECT_EQ(scene.details.of(1, Detail::label), "8");
    EXPECT_EQ(scene.details.of(1, Detail::parent), "ROOT");
    EXPECT_EQ(scene.details.of(3, Detail::label), "");
}

TEST(ThreeMf, MaterialsAreNamedByObjectsAndTriangles) {
    const std::string bases =
        "<basematerials id='5'><base name='steel' displaycolor='#FF0000'/><base name='brass' "
        "displaycolor='#FF0000'/><base name='wood' displaycolor='#FF0000'/></basematerials>";
    const auto materials = [&](const std::string& attributes, const std::string& triangle_attributes) {
        return std::string(
            three_mf_scene(package_of(model_text(bases + object_text(1, tetrahedron(triangle_attributes), attributes),
                                                 "<item objectid='1'/>")))
                .details.of(0, Detail::material));
    };
    EXPECT_EQ(materials("", ""), "");
    EXPECT_EQ(materials("pid='5' pindex='1'", ""), "brass");
    EXPECT_EQ(materials("pid='5' pindex='1'", "p1='2'"), "wood");
    EXPECT_EQ(materials("", "pid='5' p1='0'"), "steel");
    EXPECT_EQ(materials("pid='5' pindex='1'", "pid='5'"), "brass");
    const LoadedScene scene = three_mf_scene(package_of(model_text(
        bases + object_text(1, tetrahedron("pid='6' p1='0'"), "pid='5' pindex='9'"), "<item objectid='1'/>")));
    EXPECT_EQ(scene.details.of(0, Detail::material), "");
    ASSERT_EQ(scene.warnings.size(), 1u);
    expect_in(scene.warnings[0], "f.3mf: 3D/3dmodel.model: 1 references to materials have no material");
}

TEST(ThreeMf, PropertiesOfExtensionsAreNoMaterials) {
    const std::string colors = "<m:colorgroup id='5'><m:color color='#FF0000'/></m:colorgroup>";
    const LoadedScene scene = three_mf_scene(package_of(
        model_text(colors + object_text(1, tetrahedron(), "pid='5' pindex='0'"), "<item objectid='1'/>",
                   "xmlns:m='http://schemas.microsoft.com/3dmanufacturing/material/2015/02' requiredextensions='m'")));
    EXPECT_EQ(scene.details.of(0, Detail::material), "");
    EXPECT_TRUE(scene.warnings.empty());
}

TEST(ThreeMf, UnitsAreThoseOfTheFile) {
    const std::vector<std::pair<std::string, std::string>> units = {
        {"micron", "µm"}, {"millimeter", "mm"}, {"centimeter", "cm"}, {"inch", "in"}, {"foot", "ft"}, {"meter", "m"}};
    for (const auto& [unit, expected] : units) {
        const LoadedScene scene = three_mf_scene(one_object("<item objectid='1'/>", "unit='" + unit + "'"));
        EXPECT_EQ(scene.space.unit, expected);
        EXPECT_EQ(three_mf_box(scene).max[0], 1);
    }
    expect_model_refusal(model_text("", "", "unit='parsec'"), "the unit is 'parsec', not one of micron, millimeter");
}

TEST(ThreeMf, OtherPartsAreFoundByTheirPaths) {
    const std::string other = model_text(object_text(1, tetrahedron(), "name='wheel'"), "<item objectid='1'/>");
    const std::string start = model_text(
        object_text(1, components("<component p:path='/3D/Objects/wheel%20a.model' objectid='1'/>"), "name='car'"),
        "<item objectid='1'/><item objectid='1' p:path='/3d/objects/WHEEL a.model'/>",
        std::string(production_xmlns) + " requiredextensions='p'");
    const LoadedScene scene = three_mf_scene(package_of(start, {{"3D/Objects/wheel%20a.model", other}}));
    EXPECT_EQ(scene.names, (Names{"ROOT/car/wheel", "ROOT/wheel"}));
    EXPECT_EQ(scene.shapes->shapes.size(), 1u);
    expect_in(three_mf_refusal(package_of(start)),
              "has no part 3d/objects/WHEEL a.model, which 3D/3dmodel.model: line 1 needs");
    const std::string inches = model_text(object_text(1, tetrahedron()), "", "unit='inch'");
    expect_in(three_mf_refusal(package_of(start, {{"3D/Objects/wheel a.model", inches}})),
              "the unit is inch, but that of 3D/3dmodel.model is millimeter");
    const std::string nested =
        model_text(object_text(1, tetrahedron()) + object_text(2, components("<component p:path='/x' objectid='1'/>")),
                   "", production_xmlns);
    expect_in(three_mf_refusal(package_of(start, {{"3D/Objects/wheel a.model", nested}})),
              "component: only the start part may refer to other parts");
}

TEST(ThreeMf, AttributesWithoutTheNamespaceAreNoPaths) {
    EXPECT_EQ(three_mf_scene(one_object("<item objectid='1' path='/x.model'/>")).objects, 1u);
    EXPECT_EQ(three_mf_scene(one_object("<item objectid='1' q:path='/x.model' xmlns:q='urn:q'/>")).objects, 1u);
}

TEST(ThreeMf, RequiredExtensionsAreKnown) {
    const std::string beam = "xmlns:b='http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02' ";
    EXPECT_EQ(three_mf_scene(one_object("<item objectid='1'/>", beam)).objects, 1u);
    expect_model_refusal(
        model_text("", "", beam + "requiredextensions=' b '"),
        "needs the extension 'b' (http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02), which "
        "octopair does not read; it may change shapes");
    expect_model_refusal(model_text("", "", "requiredextensions='z'"),
                         "needs the extension 'z', but no namespace has this prefix");
}

TEST(ThreeMf, ExtensionsThatChangeShapesAreCounted) {
    const std::string beam = "xmlns:b='http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02'";
    std::string mesh = tetrahedron();
    mesh.insert(mesh.find("</mesh>"), "<b:beamlattice minlength='1' radius='1'/><b:more/>");
    const LoadedScene scene = three_mf_scene(package_of(model_text(object_text(1, mesh) + object_text(2, "<b:shape/>"),
                                                                   "<item objectid='1'/><item objectid='2'/>", beam)));
    EXPECT_EQ(scene.objects, 1u);
    EXPECT_EQ(scene.warnings,
              Names{"f.3mf: 2 objects with an extension that may change the shape and is not read, such as "
                    "<beamlattice> of http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02"});
}

TEST(ThreeMf, CoarseMeshesAreRefusedOrCounted) {
    const std::string slices = "xmlns:s='http://schemas.microsoft.com/3dmanufacturing/slice/2015/07'";
    const auto model = [&](const std::string& resolution, const std::string& attributes) {
        return package_of(model_text(object_text(1, tetrahedron(), "s:meshresolution='" + resolution + "'"),
                                     "<item objectid='1'/>", slices + attributes));
    };
    EXPECT_TRUE(three_mf_scene(model("fullres", " requiredextensions='s'")).warnings.empty());
    EXPECT_EQ(three_mf_scene(model("lowres", "")).warnings,
              Names{"f.3mf: 1 object with a mesh that stands for a finer shape, which is not read"});
    expect_in(three_mf_refusal(model("lowres", " requiredextensions='s'")), "the mesh of object 1 is coarse");
}

TEST(ThreeMf, TypesOfObjects) {
    const auto model = [](const std::string& type) {
        return package_of(model_text(object_text(1, tetrahedron(), "type='" + type + "'"), "<item objectid='1'/>"));
    };
    EXPECT_TRUE(three_mf_scene(model(" surface ")).warnings.empty());
    for (const std::string type : {"support", "solidsupport"}) {
        EXPECT_EQ(three_mf_scene(model(type)).warnings,
                  Names{"f.3mf: 1 object of the types support or solidsupport: read like the others"});
    }
    expect_in(three_mf_refusal(model("other")), "line 1: the build has object 1 of the type 'other'");
    expect_in(three_mf_refusal(model("odd")), "object 1: the type is 'odd', not one of model, support");
    // Slicers write modifiers and blockers of supports as components of the type other.
    const std::string modified =
        object_text(1, tetrahedron()) + object_text(2, tetrahedron(), "type='other'") +
        "<object id='3'><components><component objectid='1'/><component objectid='2'/></components></object>";
    const auto printed = three_mf_scene(package_of(model_text(modified, "<item objectid='3'/>")));
    EXPECT_EQ(printed.objects, 1u);
    EXPECT_EQ(printed.warnings,
              Names{"f.3mf: 1 object of the type other within other objects: left out, because they are not printed"});
    const std::string hidden = model_text(object_text(1, tetrahedron(), "type='other'"), "");
    EXPECT_EQ(three_mf_scene(package_of(hidden)).objects, 0u);
}

TEST(ThreeMf, NumbersAreTheNearestFloat64) {
    std::string mesh = tetrahedron();
    mesh.replace(mesh.find("x=\"1\""), 5, "x=' 0.1000000000000000055511151231257827 '");
    mesh.replace(mesh.find("y=\"1\""), 5, "y='+1.E2'");
    mesh.replace(mesh.find("z=\"1\""), 5, "z='-.5e-400'");
    const LoadedScene scene = three_mf_scene(package_of(model_text(object_text(1, mesh), "<item objectid='1'/>")));
    const std::vector<Point3d>& vertices = three_mf_mesh(scene).vertices;
    EXPECT_EQ(vertices[1][0], 0.1);
    EXPECT_EQ(vertices[2][1], 100);
    EXPECT_EQ(vertices[3][2], 0);
    for (const std::string wrong : {"inf", "nan", "1e999", "1,5", "", "+-1", "0x1", "1 2"}) {
        std::string changed = tetrahedron();
        changed.replace(changed.find("y=\"1\""), 5, "y='" + wrong + "'");
        expect_model_refusal(model_text(object_text(1, changed), ""), "vertex 2: y is '" + wrong + "', not a number");
    }
}

TEST(ThreeMf, UnusedVerticesAreLeftOut) {
    const std::string mesh =
        "<mesh><vertices><vertex x='9' y='9' z='9'/><vertex x='1' y='0' z='0'/><vertex x='0' y='1' z='0'/>"
        "<vertex x='0' y='0' z='1'/></vertices><triangles>{}</triangles></mesh>";
    const auto with = [&](const std::string& triangles) {
        std::string text = mesh;
        text.replace(text.find("{}"), 2, triangles);
        return three_mf_scene(package_of(model_text(object_text(1, text), "<item objectid='1'/>")));
    };
    const LoadedScene used = with("<triangle v1='3' v2='1' v3='2'/>");
    EXPECT_EQ(three_mf_mesh(used).triangles, (std::vector<std::array<std::uint32_t, 3>>{{2, 0, 1}}));
    EXPECT_EQ(three_mf_box(used).max[0], 1);
    EXPECT_EQ(three_mf_box(with("")).max[0], 9);
    const LoadedScene flat = with("<triangle v1='3' v2='1' v3='1'/>");
    EXPECT_EQ(flat.warnings,
              Names{"f.3mf: 3D/3dmodel.model: 1 triangles have the same vertex twice, which 3MF does not allow; they "
                    "are read as flat triangles; the first is in line 1"});
    EXPECT_EQ(three_mf_mesh(flat).triangles.size(), 1u);
}

TEST(ThreeMf, TrianglesAreObjects) {
    const std::string file = one_object("<item objectid='1'/><item objectid='1' transform='1 0 0 0 1 0 0 0 1 2 0 0'/>");
    const LoadedScene boxes = three_mf_scene(file, {MeshObjects::triangle, false, {}});
    EXPECT_EQ(boxes.objects, 8u);
    EXPECT_EQ(std::get<Buffer<Box3f>>(boxes.boxes)[4].min[0], 2);
    const LoadedScene exact = three_mf_scene(file, {MeshObjects::triangle, true, {}});
    EXPECT_EQ(exact.triangles->owner_names, (Names{"ROOT/#0", "ROOT/#1"}));
    EXPECT_EQ(exact.triangles->triangles[5][1][0], 3);
}

TEST(ThreeMf, WrongReferencesAreRefused) {
    const std::string mesh = object_text(1, tetrahedron());
    expect_model_refusal(model_text(mesh, "\n\n<item objectid='2'/>"),
                         "line 3: refers to object 2, which 3D/3dmodel.model does not have");
    expect_model_refusal(model_text(mesh, "<item objectid='x'/>"), "<item>: objectid is 'x', not a whole number");
    expect_model_refusal(model_text(mesh, "<item/>"), "<item> has no objectid");
    expect_model_refusal(model_text(mesh + "\n" + mesh, ""), "line 2: the id 1 is that of the resource in line 1, too");
    expect_model_refusal(model_text(mesh + "<basematerials id='1'/>", ""),
                         "the id 1 is that of the resource in line 1");
    expect_model_refusal(model_text(object_text(1, components("<component objectid='1'/>")), ""),
                         "object 1 has itself as a component");
    expect_model_refusal(model_text(object_text(2, components("<component objectid='1'/>")) + mesh, ""),
                         "object 2 has object 1 as a component, which is not defined before it");
    expect_model_refusal(model_text(object_text(2, ""), "<item objectid='2'/>"),
                         "object 2, which has neither a mesh nor components");
}

TEST(ThreeMf, WrongMeshesAreRefused) {
    const auto with_triangle = [](const std::string& attributes) {
        std::string mesh = tetrahedron();
        mesh.insert(mesh.find("</triangles>"), "<triangle " + attributes + "/>");
        return model_text(object_text(1, mesh), "");
    };
    expect_model_refusal(with_triangle("v1='0' v2='1' v3='4'"),
                         "triangle 4: v3 is vertex 4, but 4 vertices are before it");
    expect_model_refusal(with_triangle("v1='-1' v2='1' v3='2'"), "triangle 4: v1 is '-1', not the number of a vertex");
    expect_model_refusal(with_triangle("v1='1' v2='1.0' v3='2'"),
                         "triangle 4: v2 is '1.0', not the number of a vertex");
    expect_model_refusal(with_triangle("v1='1' v2='4294967297' v3='2'"), "triangle 4: v2 is '4294967297'");
    expect_model_refusal(with_triangle("v1='1' v3='2'"), "triangle 4 has no v2");
    expect_model_refusal(model_text(object_text(1, "<mesh><vertices><vertex x='1' z='1'/></vertices></mesh>"), ""),
                         "vertex 0 has no y");
    const std::string part = "<component objectid='1'/>";
    expect_model_refusal(
        model_text(object_text(1, tetrahedron()) + object_text(2, tetrahedron() + components(part)), ""),
        "object 2 has components and a mesh");
    expect_model_refusal(
        model_text(object_text(1, tetrahedron()) + object_text(2, components(part) + tetrahedron()), ""),
        "object 2 has components and a mesh");
    expect_model_refusal(model_text(object_text(1, tetrahedron() + tetrahedron()), ""), "has a second <mesh>");
    expect_model_refusal(model_text(object_text(1, "<mesh><vertices/><vertices/></mesh>"), ""),
                         "has a second <vertices>");
}

TEST(ThreeMf, WrongTransformsAreRefused) {
    for (const std::string wrong : {"", "1 2 3", "1 0 0 0 1 0 0 0 1 0 0 0 0", "1 0 0 0 1 0 0 0 1 0 0 x"}) {
        expect_model_refusal(
            model_text(object_text(1, tetrahedron()), "<item objectid='1' transform='" + wrong + "'/>"),
            "item: the transform is '");
    }
    const std::string far = "<item objectid='1' transform='1e308 0 0 0 1 0 0 0 1 1e308 0 0'/>";
    expect_in(three_mf_refusal(one_object(far)),
              "f.3mf: object '#0': its transforms move the vertex 1, 0, 0 to the coordinate inf");
}

TEST(ThreeMf, WrongXmlIsRefusedWithItsLine) {
    expect_model_refusal("<model>\n<resources>\n</model>", "line 3: is not well-formed XML: mismatched tag");
    expect_model_refusal("", "not well-formed XML: no element found");
    expect_model_refusal("<!DOCTYPE model [<!ENTITY a 'b'>]><model/>",
                         "has a DTD (<!DOCTYPE>), which 3MF does not allow");
    expect_model_refusal("<mesh/>", "does not begin with <model>");
    expect_model_refusal("<model xmlns='urn:other'/>",
                         "is of the namespace urn:other; octopair reads 3MF core 2015/02");
    expect_in(three_mf_refusal(package_of("<model/>")), "3D/3dmodel.model: has no <build>");
    expect_model_refusal("<model><build/><build/></model>", "has a second <build>");
    expect_model_refusal("<?xml version='1.0' encoding='x-none'?><model/>", "unknown encoding");
}

TEST(ThreeMf, Utf16IsRead) {
    const std::string text = model_text(object_text(1, tetrahedron(), "name='a'"), "<item objectid='1'/>");
    std::string wide = "\xff\xfe";
    for (const char c : text) wide += std::string{c, '\0'};
    EXPECT_EQ(three_mf_scene(package_of(wide)).names, Names{"a"});
}

TEST(ThreeMf, ElementsThatAreNotOf3mfAreCounted) {
    const std::string text =
        model_text("<settings><setting/></settings>" + object_text(1, tetrahedron() + "<odd/>"),
                   "<item objectid='1'><metadatagroup><metadata name='a'>b</metadata></metadatagroup></item>");
    EXPECT_EQ(three_mf_scene(package_of(text)).warnings,
              Names{"f.3mf: 3D/3dmodel.model: 2 elements are not those of 3MF, and are not read; the first is "
                    "<settings> in line 1"});
}

TEST(ThreeMf, ManyCopiesAreLimited) {
    std::string resources = object_text(1, tetrahedron());
    std::string twenty;
    for (int i = 0; i < 20; ++i) twenty += "<component objectid='{}'/>";
    for (int id = 2; id < 20; ++id) {
        std::string list = twenty;
        for (std::size_t at = list.find("{}"); at != std::string::npos; at = list.find("{}"))
            list.replace(at, 2, std::to_string(id - 1));
        resources += object_text(id, components(list));
    }
    EXPECT_EQ(three_mf_scene(package_of(model_text(resources, "<item objectid='3'/>")), {}).objects, 400u);
    EXPECT_EQ(three_mf_refusal(package_of(model_text(resources, "<item objectid='19'/>")), ErrorCode::resource_limit),
              "f.3mf: its build consists of more than 16777216 components; build fewer items at once");
}

TEST(ThreeMf, DeepComponentsNeedNoStack) {
    std::string resources = object_text(1, tetrahedron());
    constexpr int deepest = 2000;
    for (int id = 2; id <= deepest; ++id)
        resources += object_text(id, components(fmt::format("<component objectid='{}'/>", id - 1)));
    const LoadedScene scene =
        three_mf_scene(package_of(model_text(resources, fmt::format("<item objectid='{}'/>", deepest))));
    EXPECT_EQ(scene.objects, 1u);
    EXPECT_EQ(scene.names[0].size(), 3u * deepest - 1);
}

TEST(ThreeMf, AStopRequestIsHeeded) {
    const std::string file = one_object("<item objectid='1'/>");
    Buffer<std::byte> bytes{file.size()};
    std::memcpy(bytes.data(), file.data(), file.size());
    EXPECT_EQ(error_of(ErrorCode::cancelled,
                       [&] { (void)io::parse_three_mf_scene("f", std::move(bytes), {}, requested_stop()); }),
              "interrupted");
}

TEST(ThreeMf, FilesAreKnownByTheirContent) {
    const TemporaryDirectory directory;
    const std::string path = directory.file("a.obj"),
                      text = model_text(object_text(1, tetrahedron()), "<item objectid='1'/>");
    ZipWriter zip;
    zip.add("Metadata/picture.png", std::string(10'000, 'x'), {.deflate = false});
    zip.add("_rels/.rels", relationships_to("Model/Plate.model"));
    zip.add("Model/Plate.model", text);
    write_file(path, zip.bytes());
    const LoadedScene scene = io::read_scene(path, {});
    EXPECT_EQ(scene.objects, 1u);
    EXPECT_EQ(scene.warnings, Names{path + ": is 3MF, not OBJ as its name says; it is read as 3MF"});
    EXPECT_EQ(io::version_of(path), "core 2015/02");
    EXPECT_FALSE(io::is_imported_file(path));
}

TEST(ThreeMf, ProgressGrowsToTheEnd) {
    std::vector<double> parts;
    (void)three_mf_scene(one_object("<item objectid='1'/>"),
                         {MeshObjects::node, false, [&](double part) { parts.push_back(part); }});
    ASSERT_FALSE(parts.empty());
    EXPECT_TRUE(std::is_sorted(parts.begin(), parts.end()));
    EXPECT_GT(parts.back(), 0);
    EXPECT_LE(parts.back(), 1);
}

}  // namespace
}  // namespace octopair::test
