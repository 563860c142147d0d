// Tests that result files appear complete or not at all, and that no other files stay in their directory.
#include "io/files/atomic_file.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <filesystem>

#include "io/temporary.hpp"
#include "support/compare.hpp"

namespace octopair::test {
namespace {

using io::AtomicFile;
using Names = std::vector<std::string>;

class AtomicFileTest : public ::testing::Test {
protected:
    TemporaryDirectory directory_;
    std::string path_ = directory_.file("result.csv");
};

/// Limits the size of files of this process to `bytes` until destruction. Larger writes get an error.
class FileSizeLimit {
public:
    explicit FileSizeLimit(rlim_t bytes) {
        std::signal(SIGXFSZ, SIG_IGN);
        ::getrlimit(RLIMIT_FSIZE, &before_);
        const rlimit now{bytes, before_.rlim_max};
        ::setrlimit(RLIMIT_FSIZE, &now);
    }
    ~FileSizeLimit() {
        ::setrlimit(RLIMIT_FSIZE, &before_);
        std::signal(SIGXFSZ, SIG_DFL);
    }

private:
    rlimit before_{};
};

TEST_F(AtomicFileTest, HasRoomOnItsFileSystem) {
    struct statvfs status {};
    ASSERT_EQ(::statvfs(directory_.path().c_str(), &status), 0);
    const double free = double(status.f_bavail) * double(status.f_frsize);
    const auto room = io::room_for_file(path_);
    if (room) {
        EXPECT_NEAR(double(room->bytes), free, 0.1 * free + 1e8);
        EXPECT_STREQ(room->what, "are free on its file system");
    }
    const FileSizeLimit limit(5000);
    EXPECT_EQ(io::room_for_file(path_)->bytes, 5000u);
    EXPECT_STREQ(io::room_for_file(path_)->what, "are allowed for a file (ulimit -f)");
    EXPECT_EQ(io::room_for_file(directory_.file("none/result.csv"))->bytes, 5000u);
}

/// The copy for a stream is in memory.
TEST_F(AtomicFileTest, HasRoomInMemoryForAStream) {
    const auto room = io::room_for_file("/dev/null");
    ASSERT_TRUE(room);
    EXPECT_GT(room->bytes, 1'000'000u);
    EXPECT_STREQ(room->what, "of memory are free");
    EXPECT_FALSE(io::room_for_file(directory_.file("none/result.csv")));
}

TEST_F(AtomicFileTest, AppearsOnCommit) {
    AtomicFile file(path_);
    file.write("hello ");
    file.write("world");
    file.write_at(0, "J");
    EXPECT_FALSE(std::filesystem::exists(path_));
    file.commit();
    EXPECT_EQ(read_file(path_), "Jello world");
    EXPECT_EQ(directory_.names(), Names{"result.csv"});
}

TEST_F(AtomicFileTest, ReplacesOnCommitAlone) {
    write_file(path_, "old");
    {
        AtomicFile file(path_);
        file.write(std::string(1 << 20, 'x'));
        file.flush();
        EXPECT_EQ(read_file(path_), "old");
    }
    EXPECT_EQ(read_file(path_), "old");
    EXPECT_EQ(directory_.names(), Names{"result.csv"});
    AtomicFile file(path_);
    file.write("new");
    file.commit();
    EXPECT_EQ(read_file(path_), "new");
}

TEST_F(AtomicFileTest, KeepsTheOrderOfSmallAndLargeWrites) {
    std::string expected;
    AtomicFile file(path_);
    for (int i = 0; i < 200; ++i) {
        const std::string text(std::size_t(i * i * 17 % 300000), char('a' + i % 26));
        expected += text;
        file.write(text);
        char* const room = file.room(3);
        std::memcpy(room, "+-*", 3);
        file.advance(3);
        expected += "+-*";
    }
    file.commit();
    EXPECT_TRUE(same_sequence(read_file(path_), expected));
}

TEST_F(AtomicFileTest, AFullDiskLeavesTheOldFile) {
    write_file(path_, "old");
    const std::string words = error_of(ErrorCode::io_failed, [&] {
        AtomicFile file(path_);
        const FileSizeLimit limit(100'000);
        for (int i = 0; i < 100; ++i) file.write(std::string(10'000, 'x'));
        file.commit();
    });
    EXPECT_EQ(words, path_ + ": cannot write: File too large");
    EXPECT_EQ(read_file(path_), "old");
    EXPECT_EQ(directory_.names(), Names{"result.csv"});
}

TEST_F(AtomicFileTest, RefusesPlacesThatCannotBe) {
    EXPECT_EQ(error_of(ErrorCode::io_failed, [&] { AtomicFile(directory_.file("none/a.csv")); }),
              directory_.file("none/a.csv") + ": cannot create: No such file or directory");
    expect_error(ErrorCode::io_failed, "directory", [&] { AtomicFile(directory_.path()); });
    EXPECT_EQ(directory_.names(), Names{});
}

TEST_F(AtomicFileTest, WritesToAPipeAtTheEnd) {
    const std::string pipe = directory_.file("pipe.csv");
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    const Descriptor reader(::open(pipe.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC));
    std::array<char, 16> got{};
    AtomicFile file(pipe);
    file.write("later");
    file.flush();
    EXPECT_EQ(::read(reader.number(), got.data(), got.size()), -1) << "nothing has come yet";
    file.commit();
    EXPECT_EQ(::read(reader.number(), got.data(), got.size()), 5);
    EXPECT_EQ(std::string(got.data(), 5), "later");
    EXPECT_EQ(directory_.names(), Names{"pipe.csv"});
}

TEST_F(AtomicFileTest, FollowsLinks) {
    std::filesystem::create_directory(directory_.file("sub"));
    std::filesystem::create_symlink("sub/target.csv", path_);
    AtomicFile file(path_);
    file.write("x");
    file.commit();
    EXPECT_TRUE(std::filesystem::is_symlink(path_));
    EXPECT_EQ(read_file(directory_.file("sub/target.csv")), "x");
}

TEST_F(AtomicFileTest, HasThePermissionsOfAnyNewFile) {
    const mode_t mask = ::umask(027);
    AtomicFile file(path_);
    file.commit();
    ::umask(mask);
    struct stat status {};
    ASSERT_EQ(::stat(path_.c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777, 0640u);
}

}  // namespace
}  // namespace octopair::test
