// Tests the class of closed meshes that meet against sets of cells, whose interiors meet exactly if they share a cell.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <set>
#include <stop_token>

#include "narrow_phase/mesh/mesh_contacts.hpp"
#include "narrow_phase/mesh/mesh_pair.hpp"
#include "samples/random.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

using samples::RandomStream;
using Cell = std::array<int, 3>;
using Cells = std::set<Cell>;

int below(RandomStream& random, int end) { return int(random.next() % unsigned(end)); }

/// A map with integer coefficients: a shear, a mirror image or a rotation, with a factor that makes it an integer map.
struct IntegerMap {
    std::array<Cell, 3> rows = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

    Point3d operator()(const Cell& place) const {
        Point3d out;
        for (std::size_t i = 0; i < 3; ++i) {
            out[i] = rows[i][0] * place[0] + rows[i][1] * place[1] + rows[i][2] * place[2];
        }
        return out;
    }
    IntegerMap then(const IntegerMap& next) const {
        IntegerMap both;
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t k = 0; k < 3; ++k) {
                both.rows[i][k] = 0;
                for (std::size_t j = 0; j < 3; ++j) both.rows[i][k] += next.rows[i][j] * rows[j][k];
            }
        }
        return both;
    }
};

/// Returns the rotation of the quaternion (w, x, y, z), times the square of its length: of integers, an integer map.
IntegerMap rotation(int w, int x, int y, int z) {
    return {{{{w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)},
              {2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)},
              {2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z}}}};
}

IntegerMap random_map(RandomStream& random) {
    IntegerMap shear;
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t k = i + 1; k < 3; ++k) shear.rows[i][k] = below(random, 5) - 2;
    }
    if (below(random, 2) == 0) return shear;
    const auto digit = [&] { return below(random, 5) - 2; };
    return shear.then(rotation(1 + below(random, 3), digit(), digit(), digit()));
}

/// Makes meshes of the surfaces of sets of cells. Each square of the surface is two triangles, of either diagonal.
class CellMesh {
public:
    CellMesh(const Cells& cells, const IntegerMap& map, RandomStream& random) : map_(map), random_(random) {
        for (const Cell& cell : cells) {
            for (unsigned axis = 0; axis < 3; ++axis) {
                for (const int step : {-1, 1}) {
                    Cell next = cell;
                    next[axis] += step;
                    if (!cells.contains(next)) add_square(cell, axis, step);
                }
            }
        }
    }
    /// A box of 12 triangles from `low` to `high`.
    CellMesh(const Cell& low, const Cell& high, const IntegerMap& map, RandomStream& random)
        : map_(map), random_(random) {
        size_ = {high[0] - low[0], high[1] - low[1], high[2] - low[2]};
        for (unsigned axis = 0; axis < 3; ++axis) {
            for (const int step : {-1, 1}) add_square(low, axis, step);
        }
    }

    const shape::Mesh& mesh() const { return mesh_; }

private:
    void add_square(const Cell& cell, unsigned axis, int step) {
        const unsigned u = (axis + 1) % 3, v = (axis + 2) % 3;
        std::array<std::uint32_t, 4> corners;
        for (unsigned i = 0; i < 4; ++i) {
            Cell at = cell;
            if (step > 0) at[axis] += size_[axis];
            if (i == 1 || i == 2) at[u] += size_[u];
            if (i >= 2) at[v] += size_[v];
            corners[step > 0 ? i : 3 - i] = vertex(at);
        }
        const unsigned first = unsigned(below(random_, 2));
        const auto corner = [&](unsigned i) { return corners[(first + i) % 4]; };
        mesh_.triangles.push_back({corner(0), corner(1), corner(2)});
        mesh_.triangles.push_back({corner(0), corner(2), corner(3)});
    }
    std::uint32_t vertex(const Cell& at) {
        const auto [found, fresh] = numbers_.try_emplace(at, std::uint32_t(mesh_.vertices.size()));
        if (fresh) mesh_.vertices.push_back(map_(at));
        return found->second;
    }

    const IntegerMap& map_;
    RandomStream& random_;
    Cell size_ = {1, 1, 1};
    std::map<Cell, std::uint32_t> numbers_;
    shape::Mesh mesh_;
};

Cells random_cells(RandomStream& random, int extent, int count) {
    Cells cells;
    Cell at = {below(random, extent), below(random, extent), below(random, extent)};
    for (int i = 0; i < count; ++i) {
        cells.insert(at);
        // Mostly a neighbour of the last cell, so that sets are connected, meet themselves at edges, and have holes.
        if (below(random, 6) == 0) at = {below(random, extent), below(random, extent), below(random, extent)};
        at[unsigned(below(random, 3))] += below(random, 2) * 2 - 1;
    }
    return cells;
}

bool share_a_cell(const Cells& a, const Cells& b) {
    return std::any_of(a.begin(), a.end(), [&](const Cell& cell) { return b.contains(cell); });
}

/// Returns the length of a translation along an axis of the cells after which the sets share no cell.
double separating_translation(const Cells& a, const Cells& b, const IntegerMap& map) {
    double least = std::numeric_limits<double>::infinity();
    for (unsigned axis = 0; axis < 3; ++axis) {
        for (const int sense : {-1, 1}) {
            Cell way = {};
            for (Cells moved = b; share_a_cell(a, moved); ++way[axis]) {
                Cells next;
                for (Cell cell : moved) {
                    cell[axis] += sense;
                    next.insert(cell);
                }
                moved = next;
            }
            least = std::min(least, vector::length(map(way)));
        }
    }
    return least;
}

/// Class of two meshes that are given by exact places in the world. `separation`: length of a translation that separates them.
CollisionClass class_of(const shape::Mesh& a, const shape::Mesh& b, double separation) {
    const auto tree_a = make_mesh_tree(a), tree_b = make_mesh_tree(b);
    const Pose here;
    const PosedMesh posed_a{*tree_a, here}, posed_b{*tree_b, here};
    if (!surfaces_meet(posed_a, posed_b)) {
        const bool inside = encloses_part(posed_a, posed_b) || encloses_part(posed_b, posed_a);
        return inside ? CollisionClass::contained : CollisionClass::unknown;
    }
    Finding finding;
    const std::stop_token never;
    find_mesh_contacts(posed_a, posed_b, {4, never}, finding);
    EXPECT_TRUE(finding.collision_class != CollisionClass::touching || finding.depth == 0);
    EXPECT_LE(finding.depth, separation * (1 + 1e-12));
    return finding.collision_class;
}

struct Counts {
    int touching = 0, penetrating = 0;
};

struct Expected {
    bool share;
    double separation = std::numeric_limits<double>::infinity();
};

void expect_class(const shape::Mesh& a, const shape::Mesh& b, const Expected& expected, Counts& counts) {
    const bool share = expected.share;
    for (const CollisionClass found : {class_of(a, b, expected.separation), class_of(b, a, expected.separation)}) {
        if (found == CollisionClass::unknown) {
            EXPECT_FALSE(share);
        } else if (found == CollisionClass::contained) {
            EXPECT_TRUE(share);
        } else {
            EXPECT_EQ(found == CollisionClass::penetrating, share);
            ++(share ? counts.penetrating : counts.touching);
        }
    }
}

/// Turns some meshes inside out, and takes away the common orientation of others.
void turn_some(shape::Mesh& mesh, RandomStream& random) {
    const int how = below(random, 4);
    if (how < 2) return;
    for (auto& triangle : mesh.triangles) {
        if (how == 2 || below(random, 2) == 0) std::swap(triangle[0], triangle[1]);
    }
}

TEST(MeshClass, SetsOfCellsPenetrateIfTheyShareOne) {
    const std::uint64_t scenes = scaled(3000, 20);
    Counts counts;
    for (std::uint64_t scene = 0; scene < scenes && !::testing::Test::HasFailure(); ++scene) {
        SCOPED_TRACE("scene " + std::to_string(scene));
        RandomStream random(11, scene);
        const IntegerMap map = random_map(random);
        const Cells a = random_cells(random, 3, 1 + below(random, 8));
        // Sometimes two surfaces that coincide, divided into other triangles.
        const Cells b = below(random, 8) == 0 ? a : random_cells(random, 3, 1 + below(random, 8));
        shape::Mesh mesh_a = CellMesh(a, map, random).mesh(), mesh_b = CellMesh(b, map, random).mesh();
        turn_some(mesh_a, random);
        turn_some(mesh_b, random);
        expect_class(mesh_a, mesh_b, {share_a_cell(a, b), separating_translation(a, b, map)}, counts);
    }
    EXPECT_GT(counts.touching, int(scenes / 5));
    EXPECT_GT(counts.penetrating, int(scenes / 5));
}

TEST(MeshClass, CellsAndLargeBoxesPenetrateIfTheyShareACell) {
    const std::uint64_t scenes = scaled(3000, 20);
    Counts counts;
    for (std::uint64_t scene = 0; scene < scenes && !::testing::Test::HasFailure(); ++scene) {
        SCOPED_TRACE("scene " + std::to_string(scene));
        RandomStream random(12, scene);
        const IntegerMap map = random_map(random);
        const Cells cells = random_cells(random, 4, 1 + below(random, 6));
        Cell low, high;
        for (std::size_t k = 0; k < 3; ++k) {
            low[k] = below(random, 5) - 1;
            high[k] = low[k] + 1 + below(random, 4);
        }
        const bool share = std::any_of(cells.begin(), cells.end(), [&](const Cell& cell) {
            bool inside = true;
            for (std::size_t k = 0; k < 3; ++k) inside &= low[k] <= cell[k] && cell[k] < high[k];
            return inside;
        });
        shape::Mesh mesh = CellMesh(cells, map, random).mesh();
        turn_some(mesh, random);
        expect_class(mesh, CellMesh(low, high, map, random).mesh(), {share}, counts);
    }
    EXPECT_GT(counts.touching, int(scenes / 5));
    EXPECT_GT(counts.penetrating, int(scenes / 5));
}

/// Returns true if some plane separates the interiors of two tetrahedra: one along a face, or along an edge of each.
bool tetrahedra_are_separated(const std::array<Cell, 4>& a, const std::array<Cell, 4>& b) {
    const auto minus = [](const Cell& x, const Cell& y) { return Cell{x[0] - y[0], x[1] - y[1], x[2] - y[2]}; };
    const auto cross = [](const Cell& x, const Cell& y) {
        return Cell{x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]};
    };
    const auto separates = [&](const Cell& normal) {
        if (normal == Cell{0, 0, 0}) return false;
        const auto along = [&](const Cell& x) { return normal[0] * x[0] + normal[1] * x[1] + normal[2] * x[2]; };
        const auto [low_a, high_a] = std::minmax({along(a[0]), along(a[1]), along(a[2]), along(a[3])});
        const auto [low_b, high_b] = std::minmax({along(b[0]), along(b[1]), along(b[2]), along(b[3])});
        return high_a <= low_b || high_b <= low_a;
    };
    std::vector<Cell> edges_a, edges_b;
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t k = 0; k < i; ++k) {
            edges_a.push_back(minus(a[i], a[k]));
            edges_b.push_back(minus(b[i], b[k]));
        }
    }
    for (const Cell& x : edges_a) {
        for (const Cell& y : edges_a) {
            if (separates(cross(x, y))) return true;
        }
        for (const Cell& y : edges_b) {
            if (separates(cross(x, y))) return true;
        }
    }
    for (const Cell& x : edges_b) {
        for (const Cell& y : edges_b) {
            if (separates(cross(x, y))) return true;
        }
    }
    return false;
}

std::int64_t volume(const std::array<Cell, 4>& corners) {
    std::array<Cell, 3> way;
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t k = 0; k < 3; ++k) way[i][k] = corners[i + 1][k] - corners[0][k];
    }
    return std::int64_t(way[0][0]) * (way[1][1] * way[2][2] - way[1][2] * way[2][1]) -
           std::int64_t(way[0][1]) * (way[1][0] * way[2][2] - way[1][2] * way[2][0]) +
           std::int64_t(way[0][2]) * (way[1][0] * way[2][1] - way[1][1] * way[2][0]);
}

TEST(MeshClass, TetrahedraTouchIfAPlaneSeparatesThem) {
    const std::uint64_t scenes = scaled(20'000, 20);
    Counts counts;
    for (std::uint64_t scene = 0; scene < scenes && !::testing::Test::HasFailure(); ++scene) {
        SCOPED_TRACE("scene " + std::to_string(scene));
        RandomStream random(13, scene);
        std::array<Cell, 4> a, b;
        for (auto* corners : {&a, &b}) {
            for (Cell& corner : *corners) corner = {below(random, 5), below(random, 5), below(random, 5)};
        }
        // Often a common face or edge.
        for (int i = 0, common = below(random, 4); i < common; ++i) b[unsigned(i)] = a[unsigned(i)];
        if (volume(a) == 0 || volume(b) == 0) continue;
        const auto mesh_of = [](const std::array<Cell, 4>& corners) {
            shape::Mesh mesh;
            for (const Cell& corner : corners) {
                mesh.vertices.push_back({double(corner[0]), double(corner[1]), double(corner[2])});
            }
            mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
            return mesh;
        };
        expect_class(mesh_of(a), mesh_of(b), {!tetrahedra_are_separated(a, b)}, counts);
    }
    EXPECT_GT(counts.touching, int(scenes / 5));
    EXPECT_GT(counts.penetrating, int(scenes / 5));
}

}  // namespace
}  // namespace octopair::test
