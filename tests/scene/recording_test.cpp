// Tests recordings. A replay finds the recorded results on any number of threads. Data that is not a recording is
// refused.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <cstring>
#include <random>

#include "io/temporary.hpp"
#include "octopair/octopair.hpp"
#include "scene/recording/recorder.hpp"
#include "scene/recording/replay.hpp"
#include "scene/recording_source.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

ReplayReport replay_bytes(const std::string& bytes, const ReplayOptions& options = {1, true}) {
    RecordingReader reader(source_of(bytes));
    return replay(reader, options);
}

/// Makes calls of all kinds to a recorded scene.
class RandomCalls {
public:
    RandomCalls(const SceneOptions& options, std::uint64_t seed)
        : random_(seed), float64_(options.precision == Precision::float64), scene_(options) {}

    void run(int steps, std::uint64_t objects) {
        add(objects);
        for (int i = 0; i < steps; ++i) {
            add(random_() % 4);
            move(random_() % 8, false);
            move(random_() % 4, true);
            remove(random_() % 4);
            set_traits(random_() % 4);
            const StepResult& result = scene_.step();
            results.push_back(recorded_result(result));
        }
    }

    std::vector<RecordedResult> results;

private:
    Boxes boxes(std::uint64_t count) {
        std::uniform_real_distribution<float> place(0, 8);
        boxes32_.clear();
        boxes64_.clear();
        for (std::uint64_t i = 0; i < count; ++i) {
            const float x = place(random_), y = place(random_), z = place(random_);
            boxes32_.push_back({{x, y, z}, {x + 1, y + 1, z + 1}});
            boxes64_.push_back({{x / 3.0, y / 3.0, z / 3.0}, {x / 3.0 + 0.3, y / 3.0 + 0.3, z / 3.0 + 0.3}});
        }
        if (float64_) return std::span<const Box3d>(boxes64_);
        return std::span<const Box3f>(boxes32_);
    }

    std::span<const Traits> traits(std::uint64_t count) {
        traits_.clear();
        for (std::uint64_t i = 0; i < count; ++i) traits_.push_back({1u << random_() % 2, 3, random_() % 4 == 0});
        return traits_;
    }

    std::span<const ObjectId> some(std::uint64_t count) {
        named_.clear();
        for (std::uint64_t i = 0; i < count && !ids_.empty(); ++i) named_.push_back(ids_[random_() % ids_.size()]);
        return named_;
    }

    void add(std::uint64_t count) {
        std::vector<double> paddings;
        if (random_() % 3 == 0) paddings.assign(count, 0.125);
        std::vector<ObjectId> fresh(count);
        const std::uint64_t how = random_() % 3;
        scene_.add(Objects{boxes(count), paddings}, fresh, traits(how == 2 ? count : how));
        ids_.insert(ids_.end(), fresh.begin(), fresh.end());
    }

    void move(std::uint64_t count, bool swept) {
        const auto ids = some(count);
        swept ? scene_.sweep(ids, boxes(ids.size())) : scene_.move(ids, boxes(ids.size()));
    }

    void remove(std::uint64_t count) {
        std::vector<ObjectId> gone;
        for (std::uint64_t i = 0; i < count && !ids_.empty(); ++i) {
            std::swap(ids_[random_() % ids_.size()], ids_.back());
            gone.push_back(ids_.back());
            ids_.pop_back();
        }
        scene_.remove(gone);
    }

    void set_traits(std::uint64_t count) {
        const auto ids = some(count);
        scene_.set_traits(ids, traits(random_() % 2 == 0 ? 1 : ids.size()));
    }

    std::mt19937_64 random_;
    bool float64_;
    Scene scene_;
    std::vector<ObjectId> ids_, named_;
    std::vector<Box3f> boxes32_;
    std::vector<Box3d> boxes64_;
    std::vector<Traits> traits_;
};

class Recording : public ::testing::Test {
protected:
    std::string path() const { return directory_.file("r.rec"); }
    std::string content() const { return read_file(path()); }
    SceneOptions options(Precision precision = Precision::float32, double margin = 0) const {
        return {1, precision, margin, path()};
    }
    /// Returns a recording of a few hundred bytes with every kind of record.
    std::string small() const {
        RandomCalls(options(), 3).run(3, 6);
        return content();
    }

    TemporaryDirectory directory_;
};

/// Returns the offsets of the records of a recording, and its size.
std::vector<std::size_t> borders(const std::string& bytes) {
    std::vector<std::size_t> found = {sizeof(RecordingHead)};
    while (found.back() < bytes.size()) {
        std::uint64_t length = 0;
        std::memcpy(&length, bytes.data() + found.back() + offsetof(RecordHead, length), sizeof length);
        found.push_back(found.back() + record_overhead + length);
    }
    return found;
}

/// Returns a record with a valid check and checksum, in the format of a recording.
std::string record(std::uint32_t kind, const std::string& payload) {
    RecordHead head = {RecordKind(kind), 0, payload.size()};
    head.check = head.right_check();
    std::string bytes(sizeof head, '\0');
    std::memcpy(bytes.data(), &head, sizeof head);
    bytes += payload;
    Checksum sum;
    sum.add(std::as_bytes(std::span(bytes)));
    const std::uint64_t checksum = sum.value();
    bytes.append(sizeof checksum, '\0');
    std::memcpy(bytes.data() + bytes.size() - sizeof checksum, &checksum, sizeof checksum);
    return bytes;
}

std::string head_of(RecordingHead head) {
    head.checksum = head.right_checksum();
    std::string bytes(sizeof head, '\0');
    std::memcpy(bytes.data(), &head, sizeof head);
    return bytes;
}

std::string numbers(std::initializer_list<std::uint32_t> values) { return bytes_of(std::vector(values)); }

TEST_F(Recording, FindsTheSameAgainOnAnyNumberOfThreads) {
    for (std::uint64_t seed = 0; seed < scaled(12, 3); ++seed) {
        const Precision precision = seed % 2 == 0 ? Precision::float32 : Precision::float64;
        const double margin = seed % 3 == 0 ? 0.25 : 0;
        std::vector<RecordedResult> then;
        {
            RandomCalls calls(options(precision, margin), seed);
            calls.run(20, 200);
            then = calls.results;
        }
        const std::string bytes = content();
        for (const unsigned threads : {1u, 2u, 3u}) {
            std::vector<RecordedResult> now;
            const ReplayReport report = replay_bytes(
                bytes, {threads, true, [&](const StepResult& result) { now.push_back(recorded_result(result)); }});
            EXPECT_EQ(now, then);
            EXPECT_EQ(report.steps, 20u);
            EXPECT_EQ(report.calls, 101u);
            EXPECT_FALSE(report.cut);
            EXPECT_FALSE(report.unfinished);
            EXPECT_EQ(report.pairs, then.back().began + then.back().persisting);
            EXPECT_GT(report.ended, 0u);
        }
    }
}

TEST_F(Recording, LargeCallsGoPastTheBuffer) {
    std::uint64_t bytes_at_least = 0;
    {
        RandomCalls calls(options(), 5);
        calls.run(2, 12'000);
        bytes_at_least = 12'000 * sizeof(Box3f);
    }
    EXPECT_GT(content().size(), bytes_at_least);
    EXPECT_EQ(replay_bytes(content()).steps, 2u);
}

TEST_F(Recording, ADifferenceIsFound) {
    const std::string bytes = small();
    const std::size_t last = borders(bytes).end()[-2];
    RecordedResult result;
    std::memcpy(&result, bytes.data() + last + sizeof(RecordHead), sizeof result);
    const auto with = [&](const RecordedResult& other) {
        std::string payload(sizeof other, '\0');
        std::memcpy(payload.data(), &other, sizeof other);
        return bytes.substr(0, last) + record(std::uint32_t(RecordKind::result), payload);
    };
    EXPECT_EQ(replay_bytes(with(result)).steps, 3u);
    RecordedResult hashed = result;
    ++hashed.hash;
    const std::string message = error_of(ErrorCode::engine_failed, [&] { (void)replay_bytes(with(hashed)); });
    EXPECT_TRUE(message.starts_with("r.rec: step 3: the pairs differ from the recorded ones, their numbers do not: "))
        << message;
    RecordedResult counted = result;
    counted.began += 5;
    expect_error(ErrorCode::engine_failed, "; recorded: " + std::to_string(counted.began) + " began",
                 [&] { (void)replay_bytes(with(counted)); });
    EXPECT_EQ(replay_bytes(with(counted), {1, false}).steps, 3u);  // results are not checked
}

TEST_F(Recording, WhereverItIsCutTheCallsBeforeAreMade) {
    const std::string bytes = small();
    const std::vector<std::size_t> ends = borders(bytes);
    const ReplayReport whole = replay_bytes(bytes);
    for (std::size_t size = 0; size < bytes.size(); ++size) {
        SCOPED_TRACE(size);
        const std::string cut = bytes.substr(0, size);
        if (size < sizeof(RecordingHead)) {
            expect_error(ErrorCode::bad_input, "r.rec: byte ", [&] { (void)replay_bytes(cut); });
            continue;
        }
        const ReplayReport report = replay_bytes(cut);
        EXPECT_EQ(report.cut, std::find(ends.begin(), ends.end(), size) == ends.end());
        EXPECT_LE(report.steps, whole.steps);
        const auto records = std::uint64_t(std::upper_bound(ends.begin(), ends.end(), size) - ends.begin()) - 1;
        // A step that ended has two records, an unfinished step has only the first.
        EXPECT_EQ(report.calls + 2 * report.steps - (report.unfinished ? 1 : 0), records);
    }
}

TEST_F(Recording, NoDamageGoesUnnoticed) {
    std::string bytes = small();
    for (std::size_t at = 0; at < bytes.size(); ++at) {
        for (const int bit : {0, 3, 7}) {
            SCOPED_TRACE(std::to_string(at) + ", bit " + std::to_string(bit));
            bytes[at] = char(bytes[at] ^ 1 << bit);
            const std::string message = error_of(ErrorCode::bad_input, [&] { (void)replay_bytes(bytes); });
            EXPECT_TRUE(message.starts_with("r.rec: byte ")) << message;
            bytes[at] = char(bytes[at] ^ 1 << bit);
        }
    }
    EXPECT_EQ(replay_bytes(bytes).steps, 3u);
}

TEST_F(Recording, WhatIsNoRecordingIsRefused) {
    const auto refused = [](const std::string& bytes, const std::string& words) {
        expect_error(ErrorCode::bad_input, words, [&] { (void)replay_bytes(bytes); });
    };
    RecordingHead head;
    refused("", "byte 0: the file ends before the recording begins");
    refused(std::string(100, ' '), "byte 0: not a recording of a scene");
    head.version = 2;
    refused(head_of(head), "byte 8: version 2 is newer than this program, which reads versions up to 1");
    head.version = 0;
    refused(head_of(head), "version is 0, but versions start at 1");
    head = {};
    head.precision = 16;
    refused(head_of(head), "byte 12: precision is 16, not 32 or 64");
    head = {};
    head.margin = -1;
    refused(head_of(head), "byte 16: margin is -1");
}

TEST_F(Recording, RecordsThatNobodyWroteAreRefused) {
    const std::string head = head_of({});
    const auto refused = [&](std::uint32_t kind, const std::string& payload, const std::string& words) {
        const std::string add = record(1, numbers({0, 0, 0}));
        const std::string message =
            error_of(ErrorCode::bad_input, [&] { (void)replay_bytes(head + add + record(kind, payload)); });
        EXPECT_TRUE(message.starts_with("r.rec: byte " + std::to_string(head.size() + add.size()) + ": ")) << message;
        EXPECT_TRUE(has_text(message, words));
    };
    const auto add = std::uint32_t(RecordKind::add), move = std::uint32_t(RecordKind::move);
    const std::string unit_bytes = bytes_of(std::vector<float>{0, 0, 0, 1, 1, 1});
    refused(0, "", "unknown kind of record: 0");
    refused(8, "", "unknown kind of record: 8");
    refused(move, "", "the record is too short");
    refused(add, numbers({1, 0, 0}), "the length of the record does not match its counts: 0 bytes instead of 24");
    refused(add, numbers({0xffffffff, 0xffffffff, 0xffffffff}), "the length of the record does not match its counts");
    refused(add, numbers({1, 0, 0}) + bytes_of(std::vector<float>{0, 0, 0, -1, 1, 1}), "object 0 of the call");
    refused(add, numbers({1, 2, 0}) + unit_bytes + std::string(16, '\0'), "2 paddings for 1 objects");
    refused(add, numbers({1, 0, 1}) + unit_bytes + numbers({1, 1, 2}), "the trait `fixed` is 2, not 0 or 1");
    refused(move, numbers({1, 5, 1}) + unit_bytes, "id 5.1 names no object");
    refused(std::uint32_t(RecordKind::set_traits), numbers({0, 0, 0}),
            "the length of the record does not match its counts");
    refused(std::uint32_t(RecordKind::step), numbers({0}), "the length of the record does not match its counts");
    refused(std::uint32_t(RecordKind::result), std::string(32, '\0'), "a result without a step before it");
}

constexpr Box3f unit_box = {{0, 0, 0}, {1, 1, 1}};

TEST_F(Recording, ACallThatFailsIsNotInIt) {
    const std::vector<Box3f> boxes = {unit_box, unit_box}, wrong = {{{0, 0, 0}, {-1, 1, 1}}, unit_box};
    Scene scene(options());
    std::vector<ObjectId> ids(2);
    scene.add(Objects{boxes}, ids);
    (void)scene.step();
    const std::size_t before = content().size();
    EXPECT_THROW(scene.add(Objects{wrong}, ids), Error);
    EXPECT_THROW(scene.move(ids, std::span(wrong)), Error);
    EXPECT_THROW(scene.sweep(ids, std::span(wrong)), Error);
    EXPECT_THROW(scene.remove(std::vector{ids[0], ids[0]}), Error);
    EXPECT_THROW(scene.set_traits(ids, {}), Error);
    std::stop_source stopped;
    stopped.request_stop();
    scene.move(ids, std::span(boxes));
    EXPECT_THROW((void)scene.step(stopped.get_token()), Error);
    (void)scene.step();
    // The records of the move, of the stopped step (its beginning), and of the next step (its beginning and result).
    EXPECT_EQ(content().size(), before + (record_overhead + 4 + 2 * 32) + 3 * record_overhead + sizeof(RecordedResult));
    const ReplayReport report = replay_bytes(content());
    EXPECT_EQ(report.calls, 2u);
    EXPECT_EQ(report.steps, 2u);
}

TEST_F(Recording, IsThereBeforeAndAfterEachStep) {
    const std::vector<Box3f> boxes = {unit_box, unit_box};
    Scene scene(options());
    EXPECT_EQ(content().size(), sizeof(RecordingHead));
    std::vector<ObjectId> ids(2);
    scene.add(Objects{boxes}, ids);
    (void)scene.step();
    EXPECT_EQ(replay_bytes(content()).steps, 1u);
    // The file after a crash in the step: the result is missing, and the replay repeats the step.
    const std::string died = content().substr(0, content().size() - record_overhead - sizeof(RecordedResult));
    const ReplayReport report = replay_bytes(died);
    EXPECT_TRUE(report.unfinished);
    EXPECT_EQ(report.steps, 1u);
    EXPECT_EQ(report.pairs, 1u);
}

TEST_F(Recording, AScenesLastCallsAreInIt) {
    {
        Scene scene(options());
        std::vector<ObjectId> ids(1);
        const std::vector<Box3f> boxes = {unit_box};
        scene.add(Objects{boxes}, ids);
        Scene other = std::move(scene);
        other.remove(ids);
    }
    EXPECT_EQ(replay_bytes(content()).calls, 2u);
}

TEST_F(Recording, ReplacesWhatWasThere) {
    write_file(path(), std::string(10'000, 'x'));
    EXPECT_THROW(Scene({1, Precision::float32, -1, path()}), Error);
    EXPECT_EQ(content().size(), 10'000u);  // a refused scene does not replace the file
    { Scene scene(options()); }
    EXPECT_EQ(content().size(), sizeof(RecordingHead));
}

TEST_F(Recording, PlacesThatCannotBeWritten) {
    const auto message = [](const std::string& path) {
        return error_of(ErrorCode::io_failed, [&] { Scene({1, Precision::float32, 0, path}); });
    };
    EXPECT_EQ(message("/dev/full"), "/dev/full: cannot write: No space left on device");
    EXPECT_EQ(message(directory_.file("none/r.rec")),
              directory_.file("none/r.rec") + ": cannot create: No such file or directory");
    EXPECT_EQ(message(directory_.path()), directory_.path() + ": cannot create: Is a directory");
}

/// Limits the size of files to `bytes` until destruction, to simulate a full disk.
class FullDisk {
public:
    explicit FullDisk(std::size_t bytes) {
        ::getrlimit(RLIMIT_FSIZE, &before_);
        rlimit limit = before_;
        limit.rlim_cur = bytes;
        ::setrlimit(RLIMIT_FSIZE, &limit);
    }
    FullDisk(const FullDisk&) = delete;
    FullDisk& operator=(const FullDisk&) = delete;
    ~FullDisk() {
        ::setrlimit(RLIMIT_FSIZE, &before_);
        std::signal(SIGXFSZ, handler_);
    }

private:
    rlimit before_{};
    void (*handler_)(int) = std::signal(SIGXFSZ, SIG_IGN);
};

TEST_F(Recording, AFullDiskChangesNothing) {
    const std::vector<Box3f> boxes = {unit_box, unit_box}, many(20'000, unit_box);
    const std::string full = path() + ": cannot write: File too large";
    Scene scene(options());
    std::vector<ObjectId> ids(2);
    scene.add(Objects{boxes}, ids);
    (void)scene.step();
    const std::vector<Box3f> apart = {unit_box, {{5, 5, 5}, {6, 6, 6}}};
    {
        const FullDisk disk(content().size() + 10);
        std::vector<ObjectId> more(many.size(), ids[0]);
        EXPECT_EQ(error_of(ErrorCode::io_failed, [&] { scene.add(Objects{many}, more); }), full);
        EXPECT_EQ(more.back(), ids[0]);
        EXPECT_EQ(scene.size(), 2u);
        scene.move(ids, std::span(apart));  // still fits into the recorder's buffer
        EXPECT_EQ(error_of(ErrorCode::io_failed, [&] { (void)scene.step(); }), full);
        EXPECT_EQ(scene.pairs().size(), 1u);
        EXPECT_EQ(replay_bytes(content()).steps, 1u);
        EXPECT_EQ(error_of(ErrorCode::io_failed, [&] { (void)scene.step(); }), full);
    }
    const StepResult& result = scene.step();
    EXPECT_EQ(result.ended.size(), 1u);
    const ReplayReport report = replay_bytes(content());
    EXPECT_EQ(report.calls, 2u);
    EXPECT_EQ(report.steps, 2u);
    EXPECT_FALSE(report.cut);
}

TEST_F(Recording, AStepThatWasMadeStandsThoughItsResultIsWrittenLater) {
    const std::vector<Box3f> boxes = {unit_box, unit_box};
    Scene scene(options());
    std::vector<ObjectId> ids(2);
    scene.add(Objects{boxes}, ids);
    {
        // Room for the addition and the beginning of the step, but not for its result.
        const FullDisk disk(sizeof(RecordingHead) + (record_overhead + 12 + 48) + record_overhead + 10);
        EXPECT_EQ(scene.step().began.size(), 1u);
        EXPECT_TRUE(replay_bytes(content()).unfinished);
    }
    EXPECT_EQ(scene.step().persisting, 1u);
    EXPECT_EQ(replay_bytes(content()).steps, 2u);
}

TEST_F(Recording, IsByteForByteWhatTheDocumentationShows) {
    // A change of the format needs a new version (docs/formats.md), and this version must stay readable.
    const std::string example =
        "934f43544f5245430100000020000000000000000000000074368087592c9a7f010000008c3882db3c00000000000000"
        "0200000000000000000000000000000000000000000000000000803f0000803f0000803f0000803f0000000000000000"
        "000000400000803f0000803f1ba70a0e22d91e59060000005c2b9eeb000000000000000019e0a379fb7353a707000000"
        "2c227abf2000000000000000aab43a30290e6372010000000000000000000000000000000000000000000000369f338b"
        "4b56c780";
    {
        Scene scene(options());
        std::vector<ObjectId> ids(2);
        const std::vector<Box3f> boxes = {unit_box, {{1, 0, 0}, {2, 1, 1}}};
        scene.add(Objects{boxes}, ids);
        (void)scene.step();
    }
    std::string hexadecimal;
    for (const char byte : content()) {
        for (const int shift : {4, 0}) hexadecimal += "0123456789abcdef"[byte >> shift & 15];
    }
    EXPECT_EQ(hexadecimal, example);
}

TEST_F(Recording, TheChecksumIsThatOfTheDocumentation) {
    Checksum sum;
    EXPECT_EQ(sum.value(), 0xdf442d22110c749bu);
    // The checksum does not depend on how the bytes are divided into pieces.
    const std::string text = "all of these bytes";
    sum.add(std::as_bytes(std::span(text)));
    EXPECT_EQ(sum.value(), 0x2689464b817b8a92u);
    for (std::size_t cut = 0; cut <= text.size(); ++cut) {
        Checksum pieces;
        pieces.add(std::as_bytes(std::span(text).first(cut)));
        pieces.add(std::as_bytes(std::span(text).subspan(cut)));
        EXPECT_EQ(pieces.value(), sum.value());
    }
}

}  // namespace
}  // namespace octopair::test
