// Started programs: their output, their end, and what they do not inherit.
#include "supervisor/child.hpp"

#include <gtest/gtest.h>

#include <csignal>
#include <fstream>
#include <sstream>
#include <thread>

#include "tests/support/temporary_folder.hpp"

namespace lapis::supervisor {
namespace {

class ChildTest : public ::testing::Test {
 protected:
  int status_of(Child& child) {
    while (!child.status()) std::this_thread::yield();
    return *child.status();
  }
  int run(const std::string& script) {
    Child child("/bin/sh", {"-c", script}, log_);
    return status_of(child);
  }
  std::string log() const {
    std::ostringstream text;
    text << std::ifstream(log_).rdbuf();
    return text.str();
  }

  test::TemporaryFolder folder_;
  std::filesystem::path log_ = folder_.path() / "log";
};

TEST_F(ChildTest, StatusIsThatOfAShell) {
  EXPECT_EQ(run("exit 0"), 0);
  EXPECT_EQ(run("exit 7"), 7);
  EXPECT_EQ(run("kill -KILL $$"), 137);
  Child none(folder_.path() / "none", {}, log_);
  EXPECT_EQ(status_of(none), 127);
}

TEST_F(ChildTest, WhatItPrintsGoesToTheEndOfTheLog) {
  run("echo one");
  run("echo two >&2");
  EXPECT_EQ(log(), "one\ntwo\n");
}

TEST_F(ChildTest, LogThatCannotBeWrittenIsNamed) {
  EXPECT_THROW(Child("/bin/sh", {}, folder_.path() / "no/log"), std::runtime_error);
}

TEST_F(ChildTest, SigintEndsItAlthoughTheParentIgnoresAndBlocksIt) {
  sigset_t blocked, before;
  sigemptyset(&blocked);
  sigaddset(&blocked, SIGINT);
  const auto handler = std::signal(SIGINT, SIG_IGN);  // as a shell does for what it starts in the background
  pthread_sigmask(SIG_BLOCK, &blocked, &before);
  EXPECT_EQ(run("kill -INT $$; exit 7"), 130);
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  std::signal(SIGINT, handler);
}

TEST_F(ChildTest, KillEndsItsOwnChildrenToo) {
  Child child("/bin/sh", {"-c", "sleep infinity & echo $!; wait"}, log_);
  while (log().empty()) std::this_thread::yield();
  const pid_t grandchild = std::stoi(log());
  child.kill();
  EXPECT_EQ(child.status(), 137);
  const auto state = [grandchild] {  // gone, or a zombie until somebody collects it
    std::ifstream in("/proc/" + std::to_string(grandchild) + "/stat");
    std::string pid, name, letter;
    in >> pid >> name >> letter;
    return letter;
  };
  while (!state().empty() && state() != "Z") std::this_thread::yield();
}

}  // namespace
}  // namespace lapis::supervisor
