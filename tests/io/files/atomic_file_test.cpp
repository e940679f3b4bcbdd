#include "io/files/atomic_file.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <stdexcept>

#include "io/exr_fixture.h"
#include "polyrecon/write_result.h"

namespace polyrecon {
namespace {

namespace fs = std::filesystem;

using testing::contents;
using testing::error_of;
using ::testing::HasSubstr;
using testing::put_contents;
using testing::TemporaryFolder;

void nothing(const std::string&) {}

TEST(AtomicFile, TheTargetAppearsOnlyAfterItWasVerified) {
  const TemporaryFolder folder;
  const std::string target = folder / "a.txt";
  std::string seen;
  write_atomically(
      target, [](const std::string& path) { put_contents(path, "new"); },
      [&](const std::string& path) {
        seen = contents(path);
        EXPECT_FALSE(fs::exists(target));
      });
  EXPECT_EQ(seen, "new");
  EXPECT_EQ(contents(target), "new");
  EXPECT_EQ(folder.entries(), 1u);
}

TEST(AtomicFile, AFailureLeavesTheOldFileAndNothingElse) {
  const TemporaryFolder folder;
  const std::string target = folder / "a.txt";
  put_contents(target, "old");
  const auto write = [](const std::string& path) { put_contents(path, "new"); };
  const auto fail = [](const std::string&) { throw std::runtime_error("it differs\nmore"); };
  const Error error = error_of([&] { write_atomically(target, write, fail); });
  EXPECT_EQ(error.code(), ExitCode::CannotWrite);
  EXPECT_THAT(error.what(), HasSubstr("it differs"));
  EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
  error_of([&] {
    write_atomically(
        target, [](const std::string&) { throw Error(ExitCode::Interrupted, "stop"); }, nothing);
  });
  EXPECT_EQ(contents(target), "old");
  EXPECT_EQ(folder.entries(), 1u);
}

TEST(AtomicFile, KeepsThePermissionsOfTheFileItReplaces) {
  const TemporaryFolder folder;
  const std::string target = folder / "a.txt";
  put_contents(target, "old");
  fs::permissions(target, fs::perms(0640));
  write_atomically(
      target, [](const std::string& path) { put_contents(path, "new"); }, nothing);
  EXPECT_EQ(fs::status(target).permissions(), fs::perms(0640));
}

TEST(AtomicFile, VeryLongNames) {
  const TemporaryFolder folder;
  const std::string target = folder / std::string(255, 'x');
  write_atomically(
      target, [](const std::string& path) { put_contents(path, "new"); }, nothing);
  EXPECT_EQ(contents(target), "new");
}

TEST(Case12, WhatAKilledRunLeftIsRemovedButNotWhatIsInUse) {
  const TemporaryFolder folder;
  const std::string target = folder / "a.txt", dead = folder / ".a.txt.polyrecon-00000001",
                    used = folder / ".a.txt.polyrecon-00000002", young = folder / ".a.txt.polyrecon-00000003",
                    other = folder / ".b.txt.polyrecon-00000001";
  for (const std::string& path : {dead, used, young, other}) put_contents(path, "half");
  for (const std::string& path : {dead, used, other})
    fs::last_write_time(path, fs::file_time_type::clock::now() - std::chrono::hours(1));
  const int descriptor = ::open(used.c_str(), O_RDONLY | O_CLOEXEC);
  ASSERT_EQ(::flock(descriptor, LOCK_EX), 0);
  write_atomically(
      target, [](const std::string& path) { put_contents(path, "new"); }, nothing);
  EXPECT_FALSE(fs::exists(dead));
  EXPECT_TRUE(fs::exists(used));
  EXPECT_TRUE(fs::exists(young));
  EXPECT_TRUE(fs::exists(other));
  ::close(descriptor);
}

TEST(CheckWritable, TriesTheFolderAndLeavesNothing) {
  const TemporaryFolder folder;
  check_writable(folder / "a.exr");
  EXPECT_EQ(folder.entries(), 0u);
  put_contents(folder / "file", "");
  for (const std::string& target :
       {folder / "file/a.exr", folder / "file/none/a.exr", folder / "", std::string(), std::string("/dev/full")})
    EXPECT_EQ(error_of([&] { check_writable(target); }).code(), ExitCode::CannotWrite) << target;
}

TEST(AtomicFile, MakesFoldersThatAreMissing) {
  const TemporaryFolder folder;
  check_writable(folder / "some/more/a.txt");
  EXPECT_EQ(folder.entries(), 0u) << "a check makes none";
  write_bytes(folder / "some/more/a.txt", "text");
  EXPECT_EQ(contents(folder / "some/more/a.txt"), "text");
}

TEST(Case11, AReadOnlyFolder) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
  const TemporaryFolder folder;
  fs::create_directory(folder / "locked");
  fs::permissions(folder / "locked", fs::perms::owner_read | fs::perms::owner_exec);
  EXPECT_EQ(error_of([&] { check_writable(folder / "locked/a.exr"); }).code(), ExitCode::CannotWrite);
}

/// A limit on the size of files stands for a full disk: the write fails in the middle, with the signal ignored.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &old_);
    const rlimit small{bytes, old_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &small);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;
  ~FullDisk() {
    ::setrlimit(RLIMIT_FSIZE, &old_);
    std::signal(SIGXFSZ, handler_);
  }

 private:
  rlimit old_{};
  void (*handler_)(int);
};

TEST(Case11, AFullDiskAtAnyByteLeavesTheOldFile) {
  const TemporaryFolder folder;
  const std::string target = folder / "map.exr";
  const Rect window{0, 0, 40, 40};
  Image noise(40, 40, 1);
  for (std::size_t i = 0; i < noise.pixels(); ++i) noise.plane(0)[i] = static_cast<Real>((i * 2654435761u) % 9973);
  write_maps(target, {{"samples.Y", noise}}, window, window);
  const std::string old = contents(target);
  for (std::size_t bytes = 0; bytes<old.size(); bytes += bytes + 64> old.size() ? 1 : 61) {
    const FullDisk full(bytes);
    const Error error = error_of([&] { write_maps(target, {{"samples.Y", noise}}, window, window); });
    ASSERT_EQ(error.code(), ExitCode::CannotWrite) << bytes;
  }
  EXPECT_EQ(contents(target), old);
  EXPECT_EQ(folder.entries(), 1u);
}

}  // namespace
}  // namespace polyrecon
