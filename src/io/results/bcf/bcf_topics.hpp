// BcfTopics: turns the rows of a result into topics of BCF.
//
// - An element with at least `rows_of_group` collisions gets one topic for all of them. The element with most collisions comes first, by the
//   lesser key if several have as many. Its collisions count for no other element. Then the next element follows, and so on.
// - Each other collision gets a topic of its own.
// - The GUID of a topic is a hash of the key of its element or of its collision (collision_key.hpp).
// - The status of a group is the least decided one of its collisions: new, active, reviewed, approved.
// - The camera looks at the deepest contact, the nearest points, or the middle of the common part of the boxes. Lengths are in metres.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "io/formats/format_choice.hpp"
#include "io/results/collision_row.hpp"
#include "octopair/objects.hpp"

namespace octopair::io {

/// The scene that the rows refer to. Boxes and names are borrowed.
struct BcfScene {
    CollisionForm form;
    Boxes a, b;  ///< boxes of the first set; in a join, b has those of the second set
    bool join = false;
    SceneSpace space =
        {};  ///< axes and unit of the coordinates; if the axis is unknown, z is up; without a unit, metres
};

/// An element in a viewpoint.
struct BcfComponent {
    std::string ifc_id;        ///< GlobalId of IFC; or empty
    std::string authoring_id;  ///< key of the object, without an IFC id
};

struct BcfComment {
    std::string guid, text;
};

struct BcfFile {
    std::string name, project;  ///< name without folders; id of the IfcProject, or empty
};

struct BcfCamera {
    Point3d place = {}, direction = {}, up = {};
};

struct BcfTopic {
    std::string guid, viewpoint_guid;
    std::string title, description, label;  ///< label: word of the class; of a group, empty if the classes differ
    Status status = Status::begun;
    std::vector<BcfComment> comments;
    std::vector<BcfFile> files;
    std::vector<BcfComponent> components;  ///< at least 2
    BcfCamera camera;
};

class BcfTopics {
public:
    static constexpr std::size_t rows_of_group = 10, max_components = 1000;
    static constexpr double field_of_view = 60;  ///< degrees

    explicit BcfTopics(const BcfScene& scene) : scene_(scene) {}

    void add(const CollisionRows& rows);
    /// Returns the topics of all rows: groups first, then collisions in the order of the result.
    std::vector<BcfTopic> topics() const;

private:
    /// An object: number and set. In a result of one set, all objects are of set 0.
    struct Object {
        std::uint32_t number, set;
        auto operator<=>(const Object&) const = default;
    };
    struct Row {
        Object a, b;
        CollisionClass collision_class;
        DepthKind depth_kind;
        double depth, distance;
        Point3d place;
        Status status;
        std::string comment;
    };
    struct Group {
        Object element;
        std::vector<std::size_t> rows;
    };

    const ObjectNames& names_of(const Object& object) const;
    Box3d box_of(const Object& object) const;
    std::string key_of(const Row& row) const;
    std::string title_of(const Object& object) const;
    std::string text_of(const Row& row) const;
    Point3d middle_of(const Object& a, const Object& b) const;
    BcfComponent component_of(const Object& object) const;
    BcfCamera camera_of(const Row& row) const;
    void add_file(const Object& object, BcfTopic& topic) const;
    void add_comment(const Row& row, BcfTopic& topic) const;
    std::vector<Group> groups(std::vector<bool>& grouped) const;
    BcfTopic topic_of(const Row& row) const;
    BcfTopic topic_of(const Group& group) const;

    const BcfScene& scene_;
    std::vector<Row> rows_;
};

/// Returns a GUID that depends only on the text: its hash, in the form of UUIDs of version 8 (RFC 9562).
std::string guid_of(std::string_view text);

}  // namespace octopair::io
