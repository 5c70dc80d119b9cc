// The run folder belongs to one run at a time, and keeps what the next run resumes.
#include "supervisor/run_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <optional>

#include "supervisor/program.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lapis::supervisor {
namespace {

using ::testing::HasSubstr;

TEST(RunFolder, SecondRunIsRefusedAndTheFirstIsNamed) {
  const test::TemporaryFolder folder;
  std::optional<RunFolder> first(folder.path() / "run");
  try {
    const RunFolder second(folder.path() / "run");
    FAIL();
  } catch (const BadSetup& error) {
    EXPECT_THAT(error.what(), HasSubstr("is in use by"));
    EXPECT_THAT(error.what(), HasSubstr("(process " + std::to_string(getpid()) + ")"));
    EXPECT_THAT(error.what(), HasSubstr("--out"));
  }
  first.reset();
  EXPECT_NO_THROW(RunFolder(folder.path() / "run"));
}

TEST(RunFolder, ThatCannotBeMadeIsNamedWithTheReason) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path() / "file") << "x";
  try {
    const RunFolder run(folder.path() / "file" / "run");
    FAIL();
  } catch (const BadSetup& error) {
    EXPECT_THAT(error.what(), HasSubstr("file/run cannot be made a run folder"));
  }
}

TEST(RunFolder, OldResultsGoAndWhatIsResumedOrForeignStays) {
  const test::TemporaryFolder folder;
  const RunFolder run(folder.path());
  for (const char* name : {"map.lapis", "map.1.lapis", "metrics.json", "notes.txt", "logs/eye.log", "map.x.lapis"}) {
    std::ofstream(folder.path() / name) << name;
  }
  run.clear({"map.lapis", "map.*[0-9].lapis", "metrics.json", "logs/*.log"},
            {folder.path() / "logs/../map.1.lapis", "7"});
  EXPECT_FALSE(exists(folder.path() / "map.lapis"));
  EXPECT_FALSE(exists(folder.path() / "metrics.json"));
  EXPECT_FALSE(exists(folder.path() / "logs/eye.log"));
  for (const char* name : {"map.1.lapis", "notes.txt", "map.x.lapis"})
    EXPECT_TRUE(exists(folder.path() / name)) << name;
}

TEST(RunFolder, ShowsTheEndOfALog) {
  const test::TemporaryFolder folder;
  const RunFolder run(folder.path());
  std::ofstream(run.log("eye")) << "1\n2\n3\n4\n5\n6\n7\n";
  EXPECT_EQ(run.end_of_log("eye"), "3\n4\n5\n6\n7\n");
  EXPECT_EQ(run.end_of_log("leg"), "");
}

}  // namespace
}  // namespace lapis::supervisor
