// Answers about one frame against brute force on the frame.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "octopair/error.hpp"
#include "support/errors.hpp"
#include "viewer/scene/frame_answers.hpp"
#include "viewer/shown_frames.hpp"

namespace octopair::test {

namespace {

using viewer::Address;
using viewer::RowRequest;
using viewer::SceneContents;
using viewer::ShownFrame;
using viewer::ShownObjects;

/// A random frame, with all that ShownFrame borrows.
struct Shown {
    std::vector<Box3d> boxes;
    std::vector<std::uint8_t> exists;
    SceneContents contents;
    viewer::FrameData data;
    ShownObjects shown;
    Point3d origin;
    std::vector<Pair> began;

    Shown(Random& random, std::size_t count, std::size_t most, bool absent = false)
        : boxes(random_boxes(random, count)) {
        if (absent) {
            for (std::size_t i = 0; i < count; ++i) exists.push_back(random() % 4 == 0 ? 0 : 1);
        }
        data = frame_of(boxes, exists);
        contents.objects = count;
        shown = ShownObjects(data, count, most);
        origin = {random_number(random, -5, 5), random_number(random, -5, 5), random_number(random, -5, 5)};
        for (const Pair pair : data.pairs) {
            if (random() % 3 == 0) began.push_back(pair);
        }
    }
    ShownFrame frame() const { return {contents, contents.objects, shown, origin, data, began, {}}; }
    bool has(std::size_t object) const { return exists.empty() || exists[object] != 0; }
};

void expect_box(const float* found, const Box3d& box, const Point3d& origin) {
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(found[i], float(box.min[i] - origin[i]));
        EXPECT_EQ(found[i + 3], float(box.max[i] - origin[i]));
    }
}

Json json_in(const viewer::Answer& answer) {
    EXPECT_EQ(answer.kind, viewer::AnswerKind::json);
    return Json::parse(answer.body);
}

TEST(FrameAnswers, BoxesRelativeToTheOrigin) {
    Random random(1);
    for (int i = 0; i < 20; ++i) {
        const Shown scene(random, random() % 200, 100, i % 2 == 1);
        const auto rows = array_of<float>(box_rows(scene.frame()).body);
        ASSERT_EQ(rows.size(), 6 * scene.shown.size());
        for (std::size_t row = 0; row < scene.shown.size(); ++row) {
            const std::uint32_t object = scene.shown.objects()[row];
            if (scene.has(object)) {
                expect_box(&rows[6 * row], scene.boxes[object], scene.origin);
            } else {
                for (std::size_t k = 0; k < 6; ++k) EXPECT_TRUE(std::isnan(rows[6 * row + k]));
            }
        }
    }
}

TEST(FrameAnswers, NumbersOfPartners) {
    Random random(2);
    for (int i = 0; i < 20; ++i) {
        const Shown scene(random, random() % 200, 100, i % 2 == 1);
        const auto rows = array_of<std::uint32_t>(partner_counts(scene.frame()).body);
        ASSERT_EQ(rows.size(), scene.shown.size());
        for (std::size_t row = 0; row < rows.size(); ++row) {
            const std::uint32_t object = scene.shown.objects()[row];
            const auto count = std::count_if(scene.data.pairs.begin(), scene.data.pairs.end(),
                                             [&](Pair pair) { return pair.a == object || pair.b == object; });
            EXPECT_EQ(rows[row], count);
        }
    }
}

TEST(FrameAnswers, PairsAreCapped) {
    const std::vector<Pair> pairs = {{0, 1}, {0, 2}, {1, 2}};
    EXPECT_EQ(viewer::pair_rows(pairs).body.size(), 24u);
    EXPECT_EQ(array_of<std::uint32_t>(viewer::pair_rows(pairs, 2).body), (std::vector<std::uint32_t>{0, 1, 0, 2}));
    EXPECT_EQ(viewer::pair_rows(pairs, 0).body, "");
    const std::vector<Pair> many(viewer::max_listed_pairs + 5, Pair{1, 2});
    EXPECT_EQ(viewer::pair_rows(many).body.size(), 8 * viewer::max_listed_pairs);
}

Address address_of(const std::string& query) { return *Address::parse("/collisions/0.json" + query); }

/// Adds names and findings to a frame.
void describe(Shown& scene, Random& random) {
    for (std::size_t i = 0; i < scene.boxes.size(); ++i) {
        scene.contents.names.push_back((i % 3 == 0 ? "Hull/Plate " : "deck/beam ") + std::to_string(i));
    }
    for (std::size_t i = 0; i < scene.data.pairs.size(); ++i) {
        Finding finding;
        finding.collision_class = CollisionClass(random() % collision_classes);
        finding.depth = double(random() % 10) / 8;
        finding.depth_kind = DepthKind(random() % 3);
        finding.depth_at_most = finding.depth + double(random() % 3);
        finding.more_contacts = random() % 2 == 0;
        finding.distance = double(random() % 10) / 8;
        finding.contacts.resize(random() % 20);
        for (Contact& contact : finding.contacts) contact.point = {random_number(random, 0, 1), 2, 3};
        scene.data.findings.push_back(finding);
    }
}

/// The shortest translation along an axis that separates the boxes of a pair.
double true_overlap(const Shown& scene, Pair pair) {
    const Box3d &a = scene.boxes[pair.a], &b = scene.boxes[pair.b];
    double overlap = std::numeric_limits<double>::max();
    for (std::size_t k = 0; k < 3; ++k) overlap = std::min({overlap, a.max[k] - b.min[k], b.max[k] - a.min[k]});
    return overlap;
}

bool is_known(const Finding& finding) { return finding.depth_kind != DepthKind::unknown || finding.depth > 0; }

/// Whether a row must tell how far the boxes of its pair overlap.
bool has_overlap(const Shown& scene, std::size_t i) {
    if (scene.data.findings.empty()) return true;
    const Finding& finding = scene.data.findings[i];
    const bool untested =
        finding.collision_class == CollisionClass::unknown || finding.collision_class == CollisionClass::collision;
    return untested && !is_known(finding);
}

/// The key of a pair in the order "worst": lower is worse.
std::pair<std::size_t, double> worst_key(const Shown& scene, std::size_t i) {
    using enum CollisionClass;
    constexpr std::array order = {penetrating, contained, duplicate, collision,
                                  unknown,     touching,  clearance, undecided};
    const Finding none, &finding = scene.data.findings.empty() ? none : scene.data.findings[i];
    const auto place = std::find(order.begin(), order.end(), finding.collision_class) - order.begin();
    if (finding.collision_class == clearance) return {place, finding.distance};
    return {place, has_overlap(scene, i) ? -true_overlap(scene, scene.data.pairs[i]) : -finding.depth};
}

/// Returns the positions of the pairs that a table must have, in order.
std::vector<std::size_t> true_rows(const Shown& scene, const RowRequest& request) {
    const auto lower = [](std::string text) {
        std::transform(text.begin(), text.end(), text.begin(), [](char c) { return char(std::tolower(c)); });
        return text;
    };
    const auto matches = [&](std::uint32_t object) {
        return std::to_string(object) == request.text ||
               lower(scene.contents.names[object]).find(lower(request.text)) != std::string::npos;
    };
    std::vector<std::size_t> rows;
    for (std::size_t i = 0; i < scene.data.pairs.size(); ++i) {
        const auto [a, b] = scene.data.pairs[i];
        if (request.object && *request.object != a && *request.object != b) continue;
        if (request.with && *request.with != a && *request.with != b) continue;
        if (request.text.empty() || matches(a) || matches(b)) rows.push_back(i);
    }
    if (request.sort == RowRequest::Sort::worst) {
        std::stable_sort(rows.begin(), rows.end(),
                         [&](std::size_t x, std::size_t y) { return worst_key(scene, x) < worst_key(scene, y); });
        return rows;
    }
    const auto key = [&](std::size_t i) {
        const bool began = std::count(scene.began.begin(), scene.began.end(), scene.data.pairs[i]) > 0;
        return request.sort == RowRequest::Sort::began && !began ? 1.0 : 0.0;
    };
    std::stable_sort(rows.begin(), rows.end(), [&](std::size_t x, std::size_t y) { return key(x) < key(y); });
    return rows;
}

/// The depth of a pair must not look exact if it is a bound.
void expect_depth(const Json& row, const Finding& finding) {
    const bool meets =
        finding.collision_class > CollisionClass::clearance && finding.collision_class != CollisionClass::undecided;
    ASSERT_EQ(row.contains("depth"), meets && is_known(finding));
    if (row.contains("depth")) {
        EXPECT_EQ(row["depth"], finding.depth);
    }
    const std::string kinds[] = {"", "least", "at_least"};
    EXPECT_EQ(row.value("depth_kind", ""), meets ? kinds[std::size_t(finding.depth_kind)] : "");
    const bool bounded = meets && finding.depth_kind == DepthKind::at_least && finding.depth_at_most > finding.depth;
    ASSERT_EQ(row.contains("depth_at_most"), bounded);
    if (bounded) {
        EXPECT_EQ(row["depth_at_most"], finding.depth_at_most);
    }
    EXPECT_EQ(row.value("more_contacts", false), !finding.contacts.empty() && finding.more_contacts);
    EXPECT_EQ(row.value("contact_count", std::size_t(0)), finding.contacts.size() > 16 ? finding.contacts.size() : 0);
}

void expect_rows(const Shown& scene, const std::string& query) {
    const RowRequest request = viewer::row_request(address_of(query));
    const Json found = json_in(collision_rows(scene.frame(), request));
    const auto expected = true_rows(scene, request);
    EXPECT_EQ(found["total"], expected.size()) << query;
    const std::size_t from = std::min<std::size_t>(request.from, expected.size());
    const std::size_t count = std::min<std::size_t>(request.count, expected.size() - from);
    ASSERT_EQ(found["rows"].size(), count) << query;
    for (std::size_t i = 0; i < count; ++i) {
        const Json& row = found["rows"][i];
        const Pair pair = scene.data.pairs[expected[from + i]];
        const Finding& finding = scene.data.findings[expected[from + i]];
        EXPECT_EQ(row["a"], pair.a) << query << " row " << i;
        EXPECT_EQ(row["b"], pair.b) << query << " row " << i;
        EXPECT_EQ(row["name_a"], scene.contents.names[pair.a]);
        expect_depth(row, finding);
        ASSERT_EQ(row.contains("overlap"), has_overlap(scene, expected[from + i]));
        if (row.contains("overlap")) {
            EXPECT_EQ(row["overlap"], true_overlap(scene, pair));
        }
        EXPECT_EQ(row.contains("contacts") ? row["contacts"].size() : 0,
                  std::min<std::size_t>(16, finding.contacts.size()));
        EXPECT_EQ(row.contains("change"), std::count(scene.began.begin(), scene.began.end(), pair) > 0);
    }
}

TEST(CollisionTable, SelectsAndSorts) {
    Random random(4);
    for (int round = 0; round < 5; ++round) {
        Shown scene(random, 150, 100);
        describe(scene, random);
        for (const std::string sort : {"", "&sort=pair", "&sort=worst", "&sort=began"}) {
            for (const std::string filter :
                 {"", "&q=hull", "&q=PLATE+1", "&q=7", "&q=nothing", "&object=7", "&object=149", "&object=150",
                  "&object=99999999999", "&object=3&q=beam", "&object=3&with=7", "&with=7", "&object=7&with=3"}) {
                expect_rows(scene, "?count=1000" + sort + filter);
                expect_rows(scene, "?from=3&count=5" + sort + filter);
            }
        }
        expect_rows(scene, "");
        expect_rows(scene, "?from=18446744073709551615&count=18446744073709551615");
        expect_rows(scene, "?count=0");
    }
}

TEST(CollisionTable, BoxesWithoutExactTests) {
    Random random(9);
    Shown scene(random, 150, 100);
    const Json rows =
        json_in(collision_rows(scene.frame(), viewer::row_request(address_of("?count=1000&sort=worst"))))["rows"];
    const auto expected = true_rows(scene, viewer::row_request(address_of("?sort=worst")));
    ASSERT_EQ(rows.size(), expected.size());
    ASSERT_GT(rows.size(), 10u);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const Pair pair = scene.data.pairs[expected[i]];
        EXPECT_EQ(rows[i]["a"], pair.a) << i;
        EXPECT_EQ(rows[i]["b"], pair.b) << i;
        EXPECT_EQ(rows[i]["overlap"], true_overlap(scene, pair));
        // The page needs the boxes of objects that it does not show.
        const bool hidden =
            scene.shown.row_of(pair.a) == ShownObjects::none || scene.shown.row_of(pair.b) == ShownObjects::none;
        ASSERT_EQ(rows[i].contains("boxes"), hidden);
        if (hidden) {
            EXPECT_EQ(rows[i]["boxes"][1]["max"][2], scene.boxes[pair.b].max[2]);
        }
    }
    scene.contents.has_boxes = false;  // the boxes only surround contacts
    EXPECT_FALSE(json_in(collision_rows(scene.frame(), {}))["rows"][0].contains("overlap"));
}

TEST(CollisionTable, NearestPointsOfObjectsThatAreApart) {
    Random random(10);
    Shown scene(random, 40, 40);
    describe(scene, random);
    Finding& finding = scene.data.findings.front();
    finding.collision_class = CollisionClass::clearance;
    finding.nearest = {Point3d{1, 2, 3}, Point3d{1, 2, 4}};
    const Json row = json_in(collision_rows(scene.frame(), {}))["rows"][0];
    EXPECT_EQ(row["nearest"], Json({{1.0, 2.0, 3.0}, {1.0, 2.0, 4.0}}));
}

TEST(CollisionTable, WorstClassOfEachObject) {
    Random random(11);
    Shown scene(random, 150, 100);
    describe(scene, random);
    EXPECT_EQ(viewer::class_word(CollisionClass::undecided), "undecided");
    using enum CollisionClass;
    constexpr std::array order = {penetrating, contained, duplicate, collision,
                                  unknown,     touching,  clearance, undecided};
    const auto rows = array_of<std::uint8_t>(class_rows(scene.frame()).body);
    ASSERT_EQ(rows.size(), scene.shown.size());
    for (std::size_t row = 0; row < rows.size(); ++row) {
        const std::uint32_t object = scene.shown.objects()[row];
        std::uint8_t expected = 255;
        for (auto found = order.rbegin(); found != order.rend(); ++found) {
            for (std::size_t i = 0; i < scene.data.pairs.size(); ++i) {
                const auto [a, b] = scene.data.pairs[i];
                const bool fits = (a == object || b == object) && scene.data.findings[i].collision_class == *found;
                if (fits) expected = std::uint8_t(*found);
            }
        }
        EXPECT_EQ(rows[row], expected) << object;
    }
}

/// An answer with many rows has the names of objects that are not shown, and all contacts of its first rows alone.
TEST(CollisionTable, ManyRowsAreBrief) {
    Random random(12);
    Shown scene(random, 2000, 1000);
    describe(scene, random);
    const auto table = [&](const std::string& query) {
        return json_in(collision_rows(scene.frame(), viewer::row_request(address_of(query))))["rows"];
    };
    const Json full = table("?sort=worst&count=1000"), brief = table("?sort=worst&count=1000000");
    ASSERT_EQ(brief.size(), scene.data.pairs.size());
    ASSERT_GT(brief.size(), 1500u);
    for (std::size_t i = 0; i < brief.size(); ++i) {
        Json row = brief[i];
        const auto is_hidden = [&](const char* key) { return scene.shown.row_of(row[key]) == ShownObjects::none; };
        EXPECT_EQ(row.contains("name_a"), is_hidden("a"));
        EXPECT_EQ(row.contains("name_b"), is_hidden("b"));
        if (i < 1000) {
            row["name_a"] = full[i]["name_a"];
            row["name_b"] = full[i]["name_b"];
            EXPECT_EQ(row, full[i]);
            continue;
        }
        const auto& pairs = scene.data.pairs;
        const auto place = std::find(pairs.begin(), pairs.end(), Pair{row["a"], row["b"]}) - pairs.begin();
        const std::size_t contacts = scene.data.findings[std::size_t(place)].contacts.size();
        EXPECT_EQ(row.contains("contacts") ? row["contacts"].size() : 0, std::min<std::size_t>(1, contacts));
        EXPECT_EQ(row.value("contact_count", std::size_t(1)), std::max<std::size_t>(1, contacts));
    }
}

TEST(CollisionTable, GivesAtMost200000Rows) {
    EXPECT_EQ(viewer::row_request(address_of("?count=1000000")).count, viewer::max_rows);
    EXPECT_EQ(viewer::row_request(address_of("")).count, 100u);
}

TEST(CollisionTable, RefusesInvalidParameters) {
    for (const std::string query : {"?from=-1", "?from=a", "?count=1.5", "?count=%20", "?object=x", "?object=-1",
                                    "?sort=size", "?sort=depth", "?with=x", "?from=99999999999999999999"}) {
        (void)error_of(ErrorCode::bad_input, [&] { viewer::row_request(address_of(query)); });
    }
}

TEST(CollisionTable, NamesThatAreNotUtf8) {
    Random random(5);
    Shown scene(random, 40, 40);
    describe(scene, random);
    for (std::string& name : scene.contents.names) name = "\xff\xfe</script>\0\"" + name;
    const Json found = json_in(collision_rows(scene.frame(), {}));
    EXPECT_GT(found["rows"].size(), 0u);
}

TEST(ObjectAnswer, HasBoxCodeAndPartners) {
    Random random(6);
    for (const bool absent : {false, true}) {
        Shown scene(random, 120, 60, absent);
        describe(scene, random);
        const Octants octants = octants_of(scene.frame());
        for (std::uint32_t object = 0; object < 120; ++object) {
            const auto answer = object_answer(scene.frame(), object, &octants);
            ASSERT_TRUE(answer);
            const Json found = json_in(*answer);
            EXPECT_EQ(found["index"], object);
            EXPECT_EQ(found["name"], scene.contents.names[object]);
            const std::uint32_t row = scene.shown.row_of(object);
            EXPECT_EQ(found["row"], row == ShownObjects::none ? -1 : std::int64_t(row));
            EXPECT_EQ(found.contains("box"), scene.has(object));
            std::vector<std::uint32_t> partners;
            for (const auto [a, b] : scene.data.pairs) {
                if (a == object || b == object) partners.push_back(a == object ? b : a);
            }
            std::sort(partners.begin(), partners.end());
            EXPECT_EQ(found["partners"], Json(partners));
            EXPECT_EQ(found["partner_count"], partners.size());
            if (!scene.has(object)) continue;
            EXPECT_EQ(found["box"]["max"][2], scene.boxes[object].max[2]);
            const OctalCode code = OctalCode::from_text(found["code"].get<std::string>());
            EXPECT_EQ(code.level(), found["level"]);
        }
        EXPECT_FALSE(object_answer(scene.frame(), 120, &octants));
        EXPECT_FALSE(object_answer(scene.frame(), 0xFFFFFFFF, &octants));
    }
}

TEST(SearchAnswer, ByPartOfTheNameOrByIndex) {
    Random random(7);
    Shown scene(random, 150, 60);
    describe(scene, random);
    const auto found = [&](const std::string& text) { return json_in(search_answer(scene.frame(), text)); };
    EXPECT_EQ(found("hull/plate 3")["total"], 5);  // 3, 30, 33, 36, 39
    EXPECT_EQ(found("HULL")["total"], 50);
    EXPECT_EQ(found("")["total"], 0);
    EXPECT_EQ(found("nothing")["total"], 0);
    EXPECT_EQ(found("beam")["found"].size(), viewer::max_found);
    EXPECT_EQ(found("beam")["total"], 100);
    EXPECT_EQ(found("7")["found"][0]["index"], 7);
    EXPECT_EQ(found("7777777777")["total"], 0);
    scene.contents.names.clear();
    EXPECT_EQ(found("149")["total"], 1);
    EXPECT_EQ(found("150")["total"], 0);
}

TEST(NearAnswer, EqualsBruteForce) {
    Random random(8);
    for (int i = 0; i < 40; ++i) {
        const Shown scene(random, 200, random() % 250, i % 2 == 1);
        Box3d region;
        for (int k = 0; k < 3; ++k) {
            region.min[k] = random_number(random, -1, 8);
            region.max[k] = region.min[k] + random_number(random, -0.5, 5);
        }
        const std::string body = near_answer(scene.frame(), region).body;
        const auto words = array_of<std::uint32_t>(body);
        ASSERT_GE(words.size(), 2u);
        const std::uint32_t count = words[1];
        ASSERT_EQ(words.size(), 2 + 8 * std::size_t(count));
        std::set<std::uint32_t> expected;
        for (std::uint32_t object = 0; object < 200; ++object) {
            if (scene.shown.row_of(object) != ShownObjects::none || !scene.has(object)) continue;
            bool meets = true;
            for (int k = 0; k < 3; ++k) {
                meets &= scene.boxes[object].min[k] <= region.max[k] && scene.boxes[object].max[k] >= region.min[k];
            }
            if (meets) expected.insert(object);
        }
        EXPECT_EQ(words[0], expected.size());
        EXPECT_EQ(std::set<std::uint32_t>(words.begin() + 2, words.begin() + 2 + count), expected);
        const auto counts = viewer::pair_counts(scene.data, 200);
        double last = 1e9;
        for (std::size_t k = 0; k < count; ++k) {
            const Box3d& box = scene.boxes[words[2 + k]];
            std::array<float, 6> found;
            std::memcpy(found.data(), body.data() + 8 + 4 * count + 24 * k, 24);
            expect_box(found.data(), box, scene.origin);
            EXPECT_EQ(words[2 + 7 * std::size_t(count) + k], counts[words[2 + k]]);
            const double size = std::max({box.max[0] - box.min[0], box.max[1] - box.min[1], box.max[2] - box.min[2]});
            EXPECT_LE(size, last);
            last = size;
        }
    }
}

TEST(NearAnswer, ReadsTheRegion) {
    const Box3d region = viewer::region_of(*Address::parse("/near/0.bin?min=1,-2.5,3e2&max=4,5,6"));
    EXPECT_EQ(region.min[1], -2.5);
    EXPECT_EQ(region.min[2], 300);
    EXPECT_EQ(region.max[0], 4);
    for (const std::string text : {"", "1,2", "1,2,3,4", "1,2,3,", ",1,2", "1,,2", "a,b,c", "1,2,nan", "inf,0,0",
                                   "1,2,3 ", "1;2;3", "1,2,1e999", " 1,2,3", "0x1,2,3"}) {
        for (const bool in_min : {true, false}) {
            const std::string good = "0,0,0";
            const auto address =
                Address::parse("/near/0.bin?min=" + (in_min ? text : good) + "&max=" + (in_min ? good : text));
            ASSERT_TRUE(address);
            EXPECT_THROW(viewer::region_of(*address), Error) << text;
        }
    }
}

struct OctantRow {
    float bounds[6];
    std::uint32_t entries, homes, flags, key_high, key_low;
};

TEST(OctantAnswers, ListEveryObjectsHomeOnce) {
    Random random(9);
    for (const bool absent : {false, true}) {
        const Shown scene(random, 2000, 500, absent);
        const Octants octants = octants_of(scene.frame());
        const auto levels = levels_of(scene.data, octants);
        ASSERT_EQ(levels.size(), 2000u);
        const Json summary = json_in(viewer::octant_summary(octants));
        std::uint64_t homes = 0, entries = 0;
        std::map<std::pair<unsigned, std::uint64_t>, std::uint32_t> homes_of;
        for (unsigned level = 0; level < summary["levels"].size(); ++level) {
            const auto rows = array_of<OctantRow>(viewer::octant_level(octants, level, scene.origin).body);
            EXPECT_EQ(rows.size(), summary["levels"][level]["listed"]);
            EXPECT_EQ(rows.size(), summary["levels"][level]["octants"]);
            std::uint64_t leaves = 0, last = 0;
            for (const OctantRow& row : rows) {
                const std::uint64_t key = std::uint64_t(row.key_high) << 32 | row.key_low;
                EXPECT_TRUE(&row == rows.data() || key > last);
                last = key;
                EXPECT_EQ(key >> 63, 0u);
                EXPECT_EQ(key & ((std::uint64_t(1) << 3 * (21 - level)) - 1), 0u);  // no digits below the level
                homes += row.homes;
                entries += row.entries;
                leaves += row.flags & 1u;
                homes_of[{level, key}] = row.homes;
                EXPECT_LE(row.bounds[0], row.bounds[3]);
            }
            EXPECT_EQ(leaves, summary["levels"][level]["leaves"]);
        }
        EXPECT_TRUE(viewer::octant_level(octants, unsigned(summary["levels"].size()), scene.origin).body.empty());
        EXPECT_EQ(entries, summary["entries"]);
        EXPECT_EQ(homes, std::uint64_t(std::count_if(levels.begin(), levels.end(), [](auto) { return true; }) -
                                       std::count(scene.exists.begin(), scene.exists.end(), 0)));
        // The code of each object names an octant that is listed, and the objects add up to its number of homes.
        for (std::uint32_t object = 0; object < 2000; ++object) {
            if (!scene.has(object)) continue;
            const Json found = json_in(*object_answer(scene.frame(), object, &octants));
            const OctalCode code = OctalCode::from_text(found["code"].get<std::string>());
            EXPECT_EQ(code.level(), levels[object]);
            const auto home = homes_of.find({code.level(), code.key()});
            ASSERT_NE(home, homes_of.end());
            ASSERT_GT(home->second, 0u) << object;
            --home->second;
        }
        for (const auto& [octant, rest] : homes_of) EXPECT_EQ(rest, 0u);
    }
}

TEST(OctantAnswers, OfNoObjects) {
    Random random(10);
    const Shown scene(random, 0, 10);
    const Octants octants = octants_of(scene.frame());
    EXPECT_EQ(json_in(viewer::octant_summary(octants))["entries"], 0);
    EXPECT_LE(viewer::octant_level(octants, 0, scene.origin).body.size(), 44u);
    EXPECT_EQ(viewer::octant_level(octants, 21, scene.origin).body, "");
}

TEST(Numbers, AreGrouped) {
    EXPECT_EQ(viewer::grouped_number(0), "0");
    EXPECT_EQ(viewer::grouped_number(999), "999");
    EXPECT_EQ(viewer::grouped_number(1000), "1,000");
    EXPECT_EQ(viewer::grouped_number(1234567), "1,234,567");
}

}  // namespace

}  // namespace octopair::test
