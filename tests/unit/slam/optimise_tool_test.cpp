#include "slam/optimise_tool.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/support/temporary_folder.hpp"

namespace lapis::slam {
namespace {

using ::testing::HasSubstr;

// A square of 1 m whose last side is too long by 0.4 m; no vertices.
const char* const kSquare =
    "EDGE_SE2 0 1 1 0 1.5707963267948966 1 0 0 1 0 1\nEDGE_SE2 1 2 1 0 1.5707963267948966 1 0 0 1 0 1\n"
    "EDGE_SE2 2 3 1 0 1.5707963267948966 1 0 0 1 0 1\nEDGE_SE2 3 0 1.4 0 1.5707963267948966 1 0 0 1 0 1\n";

class OptimiseTool : public ::testing::Test {
 protected:
  std::string file(const std::string& name, const std::string& text) {
    const auto path = folder.path() / name;
    std::ofstream(path) << text;
    return path.string();
  }
  int run(std::vector<const char*> arguments) {
    arguments.insert(arguments.begin(), {"lapis_slam", "optimise"});
    out.str("");
    err.str("");
    return runtime::run_file_tool(kFileTools, static_cast<int>(arguments.size()), arguments.data(), out, err);
  }
  double final_chi2() const {
    const std::string label = "final chi2 ";
    return std::stod(out.str().substr(out.str().find(label) + label.size()));
  }
  test::TemporaryFolder folder;
  std::ostringstream out, err;
};

TEST_F(OptimiseTool, PrintsAndWritesTheOptimum) {
  const std::string in = file("square.g2o", kSquare), result = (folder.path() / "out.g2o").string();
  ASSERT_EQ(run({in.c_str(), "--out", result.c_str()}), 0) << err.str();
  for (const char* part : {"initial chi2", "final chi2", "iterations", "CPU time"}) {
    EXPECT_THAT(out.str(), HasSubstr(part));
  }
  std::ifstream stream(result);
  std::stringstream text;
  text << stream.rdbuf();
  EXPECT_THAT(text.str(), HasSubstr("VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 "));
  EXPECT_FALSE(std::filesystem::exists(result + ".part"));
  const double first = final_chi2();
  ASSERT_EQ(run({result.c_str()}), 0);
  EXPECT_THAT(out.str(), HasSubstr("chi2 of file"));
  EXPECT_NEAR(final_chi2(), first, 1e-6 * first);
}

TEST_F(OptimiseTool, RobustSaysHowManyEdgesLostTheirWeight) {
  const std::string in = file("square.g2o", kSquare);
  ASSERT_EQ(run({in.c_str(), "--robust"}), 0) << err.str();
  EXPECT_THAT(out.str(), HasSubstr("edges without weight: 0 of 4"));
}

TEST_F(OptimiseTool, RefusesBadInput) {
  EXPECT_EQ(run({}), 2);
  EXPECT_EQ(run({"--help"}), 0);
  EXPECT_THAT(out.str(), HasSubstr("--robust"));
  EXPECT_EQ(run({"/nowhere/a.g2o"}), 2);
  EXPECT_THAT(err.str(), HasSubstr("/nowhere/a.g2o: cannot be read"));
  const std::string broken = file("broken.g2o", "\nEDGE_SE2 0 1 x\n"), empty = file("empty.g2o", "# nothing\n");
  EXPECT_EQ(run({broken.c_str()}), 2);
  EXPECT_THAT(err.str(), HasSubstr("broken.g2o: line 2: EDGE_SE2 needs 11 numbers, has 3"));
  EXPECT_EQ(run({empty.c_str()}), 2);
  EXPECT_THAT(err.str(), HasSubstr("has no edges"));
  const std::string in = file("square.g2o", kSquare);
  EXPECT_EQ(run({in.c_str(), "--out", "/nowhere/b.g2o"}), 2);
  EXPECT_THAT(err.str(), HasSubstr("/nowhere/b.g2o"));
}

TEST(FileTools, AreKnownByTheirName) {
  EXPECT_TRUE(runtime::is_file_tool(kFileTools, "optimise"));
  EXPECT_FALSE(runtime::is_file_tool(kFileTools, "--config"));
}

}  // namespace
}  // namespace lapis::slam
