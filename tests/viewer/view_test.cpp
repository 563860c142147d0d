// View: pages of a running scene, over real connections.
#include <arpa/inet.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/socket.h>

#include <cmath>
#include <ctime>
#include <filesystem>
#include <future>
#include <memory>
#include <set>
#include <thread>

#include "octopair/error.hpp"
#include "octopair/scene.hpp"
#include "octopair/view.hpp"
#include "support/errors.hpp"
#include "viewer/live_page.hpp"
#include "viewer/page_client.hpp"
#include "viewer/shown_frames.hpp"

namespace octopair::test {

namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

/// A scene that moves some of its objects in each step.
class MovingScene {
public:
    explicit MovingScene(std::size_t count, std::uint64_t seed = 1)
        : random_(seed),
          scene_({.threads = 1, .precision = Precision::float64}),
          boxes_(random_boxes(random_, count)),
          ids_(count) {
        scene_.add({boxes_}, ids_);
    }

    const StepResult& step() {
        std::vector<ObjectId> moved;
        std::vector<Box3d> to;
        for (std::size_t i = random_() % 5; i < ids_.size(); i += 1 + random_() % 10) {
            Box3d& box = boxes_[i];
            const double way = random_number(random_, -1, 1);
            box.min[0] += way;
            box.max[0] += way;
            moved.push_back(ids_[i]);
            to.push_back(box);
        }
        scene_.move(moved, std::span<const Box3d>(to));
        return scene_.step();
    }
    const StepResult& still_step() { return scene_.step(); }
    const StepResult& remove_last() {
        scene_.remove(std::span(ids_).last(1));
        ids_.pop_back();
        boxes_.pop_back();
        return scene_.step();
    }

    Scene& scene() { return scene_; }
    const std::vector<Box3d>& boxes() const { return boxes_; }
    std::set<Pair> pairs() {
        const auto list = scene_.pairs().to_vector();
        return {list.begin(), list.end()};
    }

private:
    Random random_;
    Scene scene_;
    std::vector<Box3d> boxes_;
    std::vector<ObjectId> ids_;
};

/// Waits until a condition holds, at most for 20 s. Returns whether it does.
template <typename Condition>
bool wait_until(const Condition& holds) {
    for (const auto end = Clock::now() + 20s; Clock::now() < end; std::this_thread::sleep_for(2ms)) {
        if (holds()) return true;
    }
    return false;
}

/// Reads messages until a frame comes.
bool read_frame(PageClient& client, LivePage& page) {
    client.want(page.frame);
    while (const auto message = client.read()) {
        if (message->text) continue;
        page.apply(message->body);
        return true;
    }
    return false;
}

bool shows(const LivePage& page, MovingScene& scene, const Point3d& origin) {
    const auto& boxes = scene.boxes();
    if (page.rows.size() < boxes.size() || page.pairs != scene.pairs()) return false;
    for (std::size_t row = 0; row < page.rows.size(); ++row) {
        if (row >= boxes.size()) {
            if (!page.rows[row].is_absent()) return false;
            continue;
        }
        for (std::size_t i = 0; i < 3; ++i) {
            if (page.rows[row].ends[i] != float(boxes[row].min[i] - origin[i])) return false;
            if (page.rows[row].ends[i + 3] != float(boxes[row].max[i] - origin[i])) return false;
        }
    }
    return true;
}

/// Returns the origin of the coordinates in frames. The view chooses it when it passes on its first step.
Point3d origin_of(const View& view) {
    const Json origin = Json::parse(get_page(view.address(), "/view.json").body)["origin"];
    return {origin[0], origin[1], origin[2]};
}

/// Shows a resting scene until the page has its last state.
bool catches_up(MovingScene& scene, View& view, PageClient& client, LivePage& page) {
    for (const auto end = Clock::now() + 20s; Clock::now() < end;) {
        auto reading = std::async(std::launch::async, [&] { return read_frame(client, page); });
        // Not all calls copy the scene, so that the page may wait for a later one.
        while (reading.wait_for(1ms) != std::future_status::ready) view.show(scene.still_step());
        if (!reading.get()) return false;
        if (shows(page, scene, origin_of(view))) return true;
    }
    return false;
}

TEST(View, FramesEqualTheScene) {
    MovingScene scene(300);
    View view(scene.scene(), {.frames_per_second = 1000});
    EXPECT_EQ(view.address().find("http://127.0.0.1:"), 0u);
    view.show(scene.step());
    PageClient client(view.address());
    ASSERT_TRUE(wait_until([&] { return view.pages() == 1; }));
    LivePage page;
    int differences = 0;
    for (int round = 0; round < 15; ++round) {
        for (int i = 0; i < 5; ++i) view.show(scene.step());
        ASSERT_TRUE(catches_up(scene, view, client, page)) << round;
        differences += page.is_whole ? 0 : 1;
    }
    EXPECT_GT(differences, 10);
    view.show(scene.remove_last());
    ASSERT_TRUE(catches_up(scene, view, client, page));
}

TEST(View, APageThatComesLate) {
    MovingScene scene(100);
    View view(scene.scene(), {.frames_per_second = 1000});
    for (int i = 0; i < 50; ++i) view.show(scene.step());
    PageClient first(view.address());
    LivePage page, late_page;
    ASSERT_TRUE(catches_up(scene, view, first, page));
    for (int i = 0; i < 50; ++i) view.show(scene.step());
    PageClient late(view.address());
    ASSERT_TRUE(catches_up(scene, view, late, late_page));
    ASSERT_TRUE(catches_up(scene, view, first, page));
    EXPECT_EQ(page.pairs, late_page.pairs);
}

TEST(View, AnswersAboutTheLatestFrame) {
    MovingScene scene(50);
    View view(scene.scene(), {.title = "running", .names = {"first", "second"}, .frames_per_second = 1000});
    EXPECT_EQ(Json::parse(get_page(view.address(), "/view.json").body)["objects"], 0);  // before the first step
    EXPECT_EQ(get_page(view.address(), "/octants/0.json").status, 200u);
    view.show(scene.step());
    ASSERT_TRUE(wait_until([&] { return Json::parse(get_page(view.address(), "/view.json").body)["objects"] == 50; }));
    const Json json = Json::parse(get_page(view.address(), "/view.json").body);
    EXPECT_EQ(json["kind"], "live");
    EXPECT_EQ(json["title"], "running");
    EXPECT_EQ(json["summary"]["pairs"], scene.pairs().size());
    EXPECT_EQ(Json::parse(get_page(view.address(), "/names.json").body)[1], "second");
    EXPECT_EQ(Json::parse(get_page(view.address(), "/search.json?q=seco").body)["total"], 1);
    EXPECT_EQ(Json::parse(get_page(view.address(), "/collisions/0.json?count=1000").body)["total"],
              scene.pairs().size());
    const Json object = Json::parse(get_page(view.address(), "/object/5/7.json").body);
    EXPECT_EQ(object["index"], 7);
    EXPECT_EQ(object["box"]["min"][0], scene.boxes()[7].min[0]);
    EXPECT_EQ(get_page(view.address(), "/octants/9/0.bin").body.size() % 44, 0u);
    for (const char* address : {"/frame/0.json", "/frame/0.f32", "/pairs/0.u32", "/partners/0.u32", "/timeline.json",
                                "/object/0/50.json", "/octants/0/22.bin", "/object/0/x.json"}) {
        EXPECT_EQ(get_page(view.address(), address).status, 404u) << address;
    }
}

TEST(View, ShowsAStepAtOnce) {
    MovingScene scene(50);
    View view(scene.scene(), {.frames_per_second = 0.001});  // all other steps are left out
    view.show(scene.step());
    for (int i = 0; i < 20; ++i) {
        view.show(scene.step());
        view.show(scene.remove_last(), true);
    }
    const auto latest = [&] { return Json::parse(get_page(view.address(), "/collisions/0.json?count=1000").body); };
    ASSERT_TRUE(wait_until([&] { return latest()["total"] == scene.pairs().size(); }));
    PageClient client(view.address());
    LivePage page;
    client.want(-1);
    std::optional<PageClient::Message> message = client.read();
    while (message && message->text) message = client.read();
    ASSERT_TRUE(message.has_value());
    page.apply(message->body);
    EXPECT_EQ(page.existing, 30u);
    EXPECT_EQ(page.objects, 50u);
    EXPECT_EQ(page.pairs, scene.pairs());
}

TEST(View, TheTableBeginsWithPairsThatBegan) {
    MovingScene scene(100);
    View view(scene.scene());
    PageClient client(view.address());
    ASSERT_TRUE(wait_until([&] { return view.pages() == 1; }));
    view.show(scene.step(), true);
    const std::set<Pair> before = scene.pairs();
    view.show(scene.step(), true);
    std::set<Pair> began;
    std::ranges::set_difference(scene.pairs(), before, std::inserter(began, began.end()));
    ASSERT_FALSE(began.empty());
    const auto first = [&] {
        std::set<Pair> marked;
        const Json rows =
            Json::parse(get_page(view.address(), "/collisions/0.json?sort=began&count=1000").body)["rows"];
        for (std::size_t i = 0; i < rows.size() && rows[i].contains("change"); ++i)
            marked.insert({rows[i]["a"], rows[i]["b"]});
        return marked;
    };
    EXPECT_TRUE(wait_until([&] { return first() == began; }));
}

TEST(View, WithoutPagesNothingIsCounted) {
    MovingScene scene(1000);
    View view(scene.scene());
    const StepResult& step = scene.step();
    for (int i = 0; i < 100'000; ++i) view.show(step);
    EXPECT_EQ(view.pages(), 0u);
}

TEST(View, CountsItsPages) {
    MovingScene scene(10);
    View view(scene.scene());
    {
        PageClient first(view.address()), second(view.address());
        EXPECT_TRUE(wait_until([&] { return view.pages() == 2; }));
    }
    EXPECT_TRUE(wait_until([&] { return view.pages() == 0; }));
}

/// Otherwise a program that the user's program starts would keep the port and the connections open.
TEST(View, NoSocketIsInherited) {
    MovingScene scene(10);
    View view(scene.scene());
    const PageClient page(view.address());
    ASSERT_TRUE(wait_until([&] { return view.pages() == 1; }));
    int sockets = 0;
    for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
        const int number = std::stoi(entry.path().filename());
        sockaddr_in address{};
        socklen_t size = sizeof address;
        const bool is_socket = ::getsockname(number, reinterpret_cast<sockaddr*>(&address), &size) == 0;
        const std::string port = ":" + std::to_string(ntohs(address.sin_port)) + "/";
        if (!is_socket || address.sin_family != AF_INET || view.address().find(port) == std::string::npos) continue;
        ++sockets;
        EXPECT_NE(::fcntl(number, F_GETFD) & FD_CLOEXEC, 0);
    }
    EXPECT_EQ(sockets, 2);  // one listens, the other one is the page's connection
}

TEST(View, EndsWhilePagesWait) {
    MovingScene scene(50);
    auto view = std::make_unique<View>(scene.scene(), ViewOptions{.frames_per_second = 1000});
    view->show(scene.step());
    PageClient waiting(view->address()), idle(view->address());
    LivePage page;
    ASSERT_TRUE(read_frame(waiting, page));
    view.reset();
    bool told = false;
    while (const auto message = waiting.read()) {
        if (message->text) told |= Json::parse(message->body)["event"] == "closed";
    }
    EXPECT_TRUE(told);
}

TEST(View, EndsWhileAPageDoesNotRead) {
    MovingScene scene(20'000);
    auto view = std::make_unique<View>(scene.scene(), ViewOptions{.frames_per_second = 1000});
    view->show(scene.step());
    std::vector<std::unique_ptr<PageClient>> clients;
    for (int i = 0; i < 5; ++i) clients.push_back(std::make_unique<PageClient>(view->address()));
    // Whole frames of 480 kB fill the buffers of the connection.
    for (int i = 0; i < 40; ++i) {
        for (const auto& client : clients) client->want(-1);
        view->show(scene.step());
    }
    // Processor time, because the connections' thread has low priority: it runs seldom while other programs are busy.
    const std::clock_t begin = std::clock();
    view.reset();
    EXPECT_LT(double(std::clock() - begin) / CLOCKS_PER_SEC, 10);
}

TEST(View, FiftyPages) {
    MovingScene scene(200);
    View view(scene.scene(), {.frames_per_second = 1000});
    view.show(scene.step());
    std::vector<std::unique_ptr<PageClient>> clients;
    for (int i = 0; i < 50; ++i) clients.push_back(std::make_unique<PageClient>(view.address()));
    ASSERT_TRUE(wait_until([&] { return view.pages() == 50; }));
    std::vector<LivePage> pages(50);
    for (int round = 0; round < 2; ++round) {
        view.show(scene.step());
        for (std::size_t i = 0; i < 50; ++i) ASSERT_TRUE(catches_up(scene, view, *clients[i], pages[i])) << i;
    }
    for (std::size_t i = 0; i < 25; ++i) clients[i].reset();
    EXPECT_TRUE(wait_until([&] { return view.pages() == 25; }));
}

TEST(View, BeginsAndEndsOften) {
    MovingScene scene(20);
    for (int i = 0; i < 20; ++i) {
        View view(scene.scene());
        view.show(scene.step());
        if (i % 2 == 0) PageClient(view.address()).want(-1);
        if (i % 3 == 0) (void)get_page(view.address(), "/octants/0.json");
    }
}

TEST(View, StepsOfAnotherThread) {
    MovingScene scene(100);
    View view(scene.scene(), {.frames_per_second = 1000});
    std::jthread steps([&](const std::stop_token& stop) {
        while (!stop.stop_requested()) {
            view.show(scene.step());
            std::this_thread::sleep_for(1ms);  // the threads of the server have the lowest priority
        }
    });
    std::vector<std::jthread> readers;
    for (int i = 0; i < 3; ++i) {
        readers.emplace_back([&] {
            PageClient client(view.address());
            LivePage page;
            for (int k = 0; k < 5; ++k) {
                ASSERT_TRUE(read_frame(client, page));
                (void)get_page(view.address(), "/collisions/0.json");
                (void)get_page(view.address(), "/octants/0.json");
            }
        });
    }
}

TEST(View, RefusesInvalidOptions) {
    MovingScene scene(1);
    const auto refused = [&](const ViewOptions& options) {
        return code_of([&] { const View view(scene.scene(), options); });
    };
    EXPECT_EQ(refused({.up = "x"}), ErrorCode::usage);
    EXPECT_EQ(refused({.up = ""}), ErrorCode::usage);
    EXPECT_EQ(refused({.margin = -1}), ErrorCode::usage);
    EXPECT_EQ(refused({.margin = std::nan("")}), ErrorCode::usage);
    EXPECT_EQ(refused({.margin = INFINITY}), ErrorCode::usage);
    EXPECT_EQ(refused({.frames_per_second = 0}), ErrorCode::usage);
    EXPECT_EQ(refused({.frames_per_second = std::nan("")}), ErrorCode::usage);
    EXPECT_EQ(refused({.frames_per_second = 1e-300}), ErrorCode::usage);
    EXPECT_EQ(refused({.host = "0.0.0.0"}), ErrorCode::usage);
    EXPECT_EQ(refused({.host = "localhost"}), ErrorCode::usage);
    EXPECT_EQ(refused({.host = "example.org", .token = "abcdefgh01234567"}), ErrorCode::usage);
    EXPECT_EQ(refused({.token = "short"}), ErrorCode::usage);
    EXPECT_EQ(refused({.token = "abcdefgh0123456;"}), ErrorCode::usage);
    EXPECT_EQ(refused({.host = "192.0.2.1", .token = "abcdefgh01234567"}), ErrorCode::io_failed);
}

TEST(View, APortThatIsTaken) {
    MovingScene scene(1);
    const View view(scene.scene());
    const std::string endpoint = endpoint_of(view.address());
    (void)error_of(ErrorCode::io_failed, [&] {
        const View other(scene.scene(), {.port = std::uint16_t(std::stoul(endpoint.substr(endpoint.rfind(':') + 1)))});
    });
}

TEST(View, MessagesThatAreNotRequestsEndTheConnection) {
    MovingScene scene(10);
    View view(scene.scene());
    view.show(scene.step());
    for (const std::string text : {"", "x", "{}", "[]", "{\"want\": \"1\"}", "{\"want\": 1.5}", "{\"want\": null}",
                                   "null", "{\"want\": [1]}", "{\"want\"", "{\"other\": 1}"}) {
        PageClient client(view.address());
        client.send(text);
        while (const auto message = client.read()) EXPECT_TRUE(message->text);
    }
    for (const std::string text : {"{\"want\": 18446744073709551615}", "{\"want\": -9223372036854775808}",
                                   "{\"want\": 1e3000}", "{\"want\": 99999999999999999999999}"}) {
        PageClient client(view.address());
        client.send(text);
        (void)client.read();
    }
    PageClient good(view.address());
    LivePage page;
    EXPECT_TRUE(read_frame(good, page));
}

}  // namespace

}  // namespace octopair::test
