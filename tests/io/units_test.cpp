// Tests units of length: changes between them, the units that files state, and scenes that are converted.
#include <gtest/gtest.h>

#include <cmath>

#include "io/formats/unit_change.hpp"
#include "io/ifc_model.hpp"
#include "io/meshes/bounded_pose.hpp"
#include "io/scene_reader.hpp"
#include "io/three_mf_reading.hpp"

namespace octopair::test {
namespace {

using io::UnitChange;

TEST(Units, MoveTheDecimalPoint) {
    const UnitChange to_metres("mm", "m"), to_millimetres("m", "mm");
    for (int length = -3000; length <= 3000; ++length) {
        const double text = std::stod(std::to_string(length) + "e-3");  // the nearest float64
        EXPECT_EQ(to_metres(length), text) << length;
        EXPECT_EQ(to_millimetres(text), length);
    }
    EXPECT_EQ(to_metres(1e-320), 0x1p-1074 * 2);
    EXPECT_EQ(to_millimetres(-1e308), -HUGE_VAL);
    EXPECT_EQ(to_millimetres(HUGE_VAL), HUGE_VAL);
    EXPECT_EQ(UnitChange("m", "cm")(1.1), 110);
    EXPECT_EQ(UnitChange("in", "mm")(10), 254);
    EXPECT_EQ(UnitChange("mm", "in")(254), 10);
    EXPECT_EQ(UnitChange("ft", "in")(3), 36);
    EXPECT_EQ(UnitChange("µm", "km")(1e9), 1);
    EXPECT_EQ(UnitChange("mm", "m").factor(), 0.001);
    for (const auto& [from, to] : {std::pair("m", "m"), {"", "m"}, {"m", ""}, {"m", "cubit"}}) {
        EXPECT_TRUE(UnitChange(from, to).is_none());
        EXPECT_EQ(UnitChange(from, to)(0.7), 0.7);
    }
    EXPECT_FALSE(to_metres.is_none());
}

TEST(Units, AreFoundByTheirLength) {
    EXPECT_EQ(io::unit_of_metres(0.001), "mm");
    EXPECT_EQ(io::unit_of_metres(0.3048), "ft");
    EXPECT_EQ(io::unit_of_metres(1), "m");
    EXPECT_EQ(io::unit_of_metres(2), "");
    EXPECT_EQ(io::metres_of("ft"), 0.3048);
    EXPECT_EQ(io::metres_of("µm"), 1e-6);
    EXPECT_FALSE(io::metres_of("yard"));
}

class UnitOfFile : public ::testing::Test {
protected:
    io::LoadedScene read(const std::string& name, const std::string& content, const std::string& unit = {},
                         MeshObjects objects = MeshObjects::node) const {
        write_file(directory_.file(name), content);
        return io::read_scene(directory_.file(name), {objects, true, {}, unit});
    }
    static Box3d first_box(const io::LoadedScene& scene) { return std::get<Buffer<Box3d>>(scene.boxes)[0]; }

    TemporaryDirectory directory_;
};

std::string amf_of(const std::string& attributes) {
    return "<?xml version=\"1.0\"?><amf " + attributes +
           "><object id=\"0\"><mesh><vertices><vertex><coordinates><x>1500</x><y>0</y><z>0</z></coordinates></vertex>"
           "<vertex><coordinates><x>2500</x><y>0</y><z>0</z></coordinates></vertex><vertex><coordinates><x>0</x>"
           "<y>250</y><z>0</z></coordinates></vertex></vertices><volume><triangle><v1>0</v1><v2>1</v2><v3>2</v3>"
           "</triangle></volume></mesh></object></amf>";
}

TEST_F(UnitOfFile, AmfStatesIt) {
    EXPECT_EQ(read("a.amf", amf_of("")).space.unit, "mm");
    EXPECT_EQ(read("a.amf", amf_of("unit=\"inch\"")).space.unit, "in");
    EXPECT_EQ(read("a.amf", amf_of("unit=\"parsec\"")).space.unit, "");
    const io::LoadedScene scene = read("a.amf", amf_of(""), "m");
    EXPECT_EQ(scene.space.unit, "m");
    EXPECT_EQ(scene.converted_from, "mm");
    EXPECT_NEAR(first_box(scene).max[0], 2.5, 1e-15);
    EXPECT_NEAR(scene.largest_rounded, 2.5, 1e-15);
    EXPECT_NEAR(scene.shapes->poses[0].rows[0][0], 0.001, 1e-18);
}

TEST_F(UnitOfFile, X3dMayStateIt) {
    const auto x3d = [](const std::string& head) {
        return "<X3D><head>" + head + "</head><Scene><Shape><Box size='2 4 6'/></Shape></Scene></X3D>";
    };
    EXPECT_EQ(read("a.x3d", x3d("")).space.unit, "m");
    EXPECT_EQ(read("a.x3d", x3d("<unit category='length' name='a' conversionFactor='0.01'/>")).space.unit, "cm");
    EXPECT_EQ(read("a.x3d", x3d("<unit category='length' name='a' conversionFactor='7'/>")).space.unit, "");
}

TEST_F(UnitOfFile, IfcIsConvertedFromMetres) {
    IfcModel model(".MILLI.");
    model.add_box("IFCWALL", "wall", {1000, 0, 0, 3000, 200, 2500});
    EXPECT_EQ(read("a.ifc", model.text()).space.unit, "m");
    const io::LoadedScene scene = read("a.ifc", model.text(), "mm");
    EXPECT_EQ(scene.space.unit, "mm");
    EXPECT_EQ(scene.converted_from, "m");
    const Box3d box = first_box(scene);
    EXPECT_NEAR(box.min[0], 1000, 1e-9);
    EXPECT_NEAR(box.max[1], 200, 1e-9);
    EXPECT_GE(box.max[2], 2500);
    EXPECT_NEAR(scene.largest_rounded, 3000, 1e-9);
}

/// A file in another unit gives the numbers of the same file in the wanted unit, to the last bit.
TEST_F(UnitOfFile, ThreeMfIsConvertedExactly) {
    const auto model = [](const std::string& unit, const std::string& corner, const std::string& place) {
        return package_of(model_text(
            "<object id=\"1\" name=\"a\" type=\"model\"><mesh><vertices><vertex x=\"0\" y=\"0\" z=\"0\"/><vertex x=\"" +
                corner + "\" y=\"0\" z=\"0\"/><vertex x=\"0\" y=\"" + corner +
                "\" z=\"0\"/><vertex x=\"0\" y=\"0\" z=\"" + corner +
                "\"/></vertices><triangles><triangle v1=\"0\" v2=\"2\" v3=\"1\"/><triangle v1=\"0\" v2=\"1\" "
                "v3=\"3\"/><triangle v1=\"1\" v2=\"2\" v3=\"3\"/><triangle v1=\"0\" v2=\"3\" v3=\"2\"/></triangles>"
                "</mesh></object>",
            "<item objectid=\"1\" transform=\"1 0 0 0 1 0 0 0 1 " + place + " 0 0\"/>", "unit=\"" + unit + "\""));
    };
    const std::string small = model("millimeter", "1009", "2007"), large = model("meter", "1.009", "2.007");
    for (const MeshObjects objects : {MeshObjects::node, MeshObjects::triangle}) {
        const io::LoadedScene converted = read("a.3mf", small, "m", objects), same = read("a.3mf", large, "m", objects);
        EXPECT_EQ(converted.space.unit, "m");
        EXPECT_EQ(converted.converted_from, "mm");
        EXPECT_EQ(same.converted_from, "");
        if (objects == MeshObjects::triangle) {
            EXPECT_EQ(converted.triangles->triangles, same.triangles->triangles);
            continue;
        }
        EXPECT_EQ(three_mf_mesh(converted).vertices, three_mf_mesh(same).vertices);
        EXPECT_EQ(converted.shapes->poses[0].rows, same.shapes->poses[0].rows);
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_EQ(first_box(converted).min[axis], first_box(same).min[axis]);
            EXPECT_EQ(first_box(converted).max[axis], first_box(same).max[axis]);
        }
    }
}

TEST_F(UnitOfFile, FilesWithoutOneStayAsTheyAre) {
    const io::LoadedScene scene = read("a.obj", "v 0 0 0\nv 1 0 0\nv 0 7 0\nf 1 2 3\n", "mm");
    EXPECT_EQ(scene.space.unit, "");
    EXPECT_EQ(scene.converted_from, "");
    EXPECT_EQ(first_box(scene).max[1], 7);
}

/// The bound of a pose is in the new unit, too.
TEST(Units, BoundsOfPosesAreConverted) {
    const BoundedPose turn({{{0.6, -0.8, 0, 0.1}, {0.8, 0.6, 0, 0.1}, {0, 0, 1, 0.1}}});
    const BoundedPoint before = (turn * turn).apply({0, 0, 0});
    const BoundedPoint after = (turn * turn).converted(UnitChange("m", "mm")).apply({0, 0, 0});
    for (std::size_t axis = 0; axis < 2; ++axis) {
        EXPECT_NEAR(after.value[axis], before.value[axis] * 1000, 1e-13);
        const double width = before.high[axis] - before.low[axis];
        EXPECT_LT(after.low[axis], after.value[axis]);
        EXPECT_GT(after.high[axis], after.value[axis]);
        EXPECT_GT(after.high[axis] - after.low[axis], 500 * width);
        EXPECT_LT(after.high[axis] - after.low[axis], 2000 * width);
    }
}

}  // namespace
}  // namespace octopair::test
