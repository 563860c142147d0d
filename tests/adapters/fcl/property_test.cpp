// Random sequences of calls, compared with FCL's naive manager. Some calls fail, and are made again.
#include "support/at_allocation.hpp"
#include "world.hpp"

namespace octopair::test {
namespace {

using octopair::fcl::BoundingBoxes;
using octopair::fcl::BroadPhaseManager;

template <typename S>
class Sequence {
public:
    explicit Sequence(std::uint64_t seed)
        : world_(seed, 5), size_(world_.number(0.1, 2)), manager_({.boxes = BoundingBoxes::fcl}) {}

    void run(int calls) {
        for (int i = 0; i < calls; ++i) {
            switch (world_.random() % 9) {
                case 0:
                case 1:
                    add(1);
                    break;
                case 2:
                    add(world_.random() % 12);
                    break;
                case 3:
                    remove();
                    break;
                case 4:
                    move(1 + world_.random() % 4);
                    break;
                case 5:
                    move_all();
                    break;
                case 6:
                    check_pairs();
                    break;
                case 7:
                    check_queries();
                    break;
                default:
                    if (world_.random() % 20 == 0) clear();
            }
            ASSERT_EQ(manager_.size(), objects_.size());
            ASSERT_EQ(manager_.empty(), objects_.empty());
            if (::testing::Test::HasFatalFailure()) return;
        }
    }

    int failures() const { return failures_; }

private:
    /// Makes a call of the manager. Before it succeeds, it may fail in allocations.
    template <typename Call>
    void call(Call&& make) {
        const std::size_t size = manager_.size();
        while (world_.random() % 4 == 0) {
            const AtAllocation failure(world_.random() % (1u << world_.random() % 7), fail_allocation);
            try {
                return make();
            } catch (const std::bad_alloc&) {
                ++failures_;
            } catch (const Error& error) {
                EXPECT_EQ(error.code(), ErrorCode::resource_limit) << error.what();
                ++failures_;
            }
            EXPECT_EQ(manager_.size(), size);
        }
        make();
    }

    void add(std::size_t count) {
        std::vector<FclObject<S>*> fresh = world_.add_random(count, size_);
        if (!former_.empty() && world_.random() % 2 == 0) {
            fresh.push_back(former_.back());
            former_.pop_back();
        }
        objects_.insert(objects_.end(), fresh.begin(), fresh.end());
        naive_.registerObjects(fresh);
        call([&] { fresh.size() == 1 ? manager_.registerObject(fresh[0]) : manager_.registerObjects(fresh); });
    }
    void remove() {
        if (objects_.empty()) return;
        const auto at = objects_.begin() + std::ptrdiff_t(world_.random() % objects_.size());
        naive_.unregisterObject(*at);
        call([&] { manager_.unregisterObject(*at); });
        former_.push_back(*at);
        objects_.erase(at);
    }
    void move(std::size_t count) {
        if (objects_.empty()) return;
        std::vector<FclObject<S>*> moved;
        for (std::size_t i = 0; i < count; ++i) {
            moved.push_back(objects_[world_.random() % objects_.size()]);
            world_.move(*moved.back());
        }
        call([&] { count == 1 ? manager_.update(moved[0]) : manager_.update(moved); });
    }
    void move_all() {
        for (FclObject<S>* const object : objects_) world_.move(*object);
        call([&] { manager_.update(); });
    }
    void clear() {
        naive_.clear();
        call([&] { manager_.clear(); });
        former_ = std::exchange(objects_, {});
    }
    void check_pairs() {
        call([&] { (void)collide<S>(manager_); });
        ASSERT_EQ(collide<S>(manager_), collide<S>(naive_));
        ASSERT_EQ(smallest_distance<S>(manager_), smallest_distance<S>(naive_));
        std::vector<FclObject<S>*> objects;
        manager_.getObjects(objects);
        ASSERT_EQ(objects, objects_);
    }
    void check_queries() {
        FclObject<S>* const query = world_.add_random(size_);
        FclPairs<S> expected;
        for (FclObject<S>* const object : objects_) {
            if (object->getAABB().overlap(query->getAABB())) expected.emplace_back(object, query);
        }
        call([&] { (void)collide<S>(manager_, query); });
        call([&] { (void)smallest_distance<S>(manager_, query); });
        ASSERT_EQ(collide<S>(manager_, query), expected);
        ASSERT_EQ(smallest_distance<S>(manager_, query), smallest_distance<S>(naive_, query));
        ::fcl::NaiveCollisionManager<S> others;
        others.registerObjects(world_.add_random(1 + world_.random() % 40, size_));
        using Manager = ::fcl::BroadPhaseCollisionManager<S>;
        ASSERT_EQ(collide<S>(manager_, static_cast<Manager*>(&others)),
                  collide<S>(naive_, static_cast<Manager*>(&others)));
        ASSERT_EQ(smallest_distance<S>(manager_, static_cast<Manager*>(&others)),
                  smallest_distance<S>(naive_, static_cast<Manager*>(&others)));
    }

    FclWorld<S> world_;
    int failures_ = 0;
    double size_;
    BroadPhaseManager<S> manager_;
    ::fcl::NaiveCollisionManager<S> naive_;
    std::vector<FclObject<S>*> objects_, former_;
};

TEST(FclProperty, SequencesOfCallsInDouble) {
    int failures = 0;
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
        SCOPED_TRACE(seed);
        Sequence<double> sequence(seed);
        sequence.run(150);
        failures += sequence.failures();
        if (HasFatalFailure()) return;
    }
    EXPECT_GT(failures, 0);
}

TEST(FclProperty, SequencesOfCallsInFloat) {
    int failures = 0;
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
        SCOPED_TRACE(seed);
        Sequence<float> sequence(seed);
        sequence.run(150);
        failures += sequence.failures();
        if (HasFatalFailure()) return;
    }
    EXPECT_GT(failures, 0);
}

}  // namespace
}  // namespace octopair::test
