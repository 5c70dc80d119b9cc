#include "common/trajectory/trajectory.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <random>
#include <stdexcept>

namespace lapis::trajectory {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

std::string error_of(const std::string& text) {
  try {
    parse_trajectory(text, "walk.txt");
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "no error";
}

Trajectory random_trajectory(std::size_t count, unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Trajectory trajectory;
  for (std::size_t i = 0; i < count; ++i) {
    const geometry::Pose T = geometry::make_pose(
        {10 * uniform(engine), 10 * uniform(engine), uniform(engine)},
        Eigen::Quaterniond(uniform(engine), uniform(engine), uniform(engine), uniform(engine) + 1.5));
    trajectory.push_back({time::Time{1305031102160407000 + static_cast<std::int64_t>(i) * 33333333}, T});
  }
  return trajectory;
}

TEST(Trajectory, ReadsCommentsBlanksCommasAndWindowsLineEnds) {
  const auto t =
      parse_trajectory("# head\n\n0.5 1 2 3 0 0 0 1 # tail\r\n 1,4,5,6,0,0,0,-1\r\n\t2 +7 8e0 9 0 0 1 0", "x");
  ASSERT_EQ(t.size(), 3u);
  EXPECT_EQ(t[0].stamp.nanoseconds, 500000000);
  EXPECT_EQ(t[2].T_world_body.translation(), Eigen::Vector3d(7, 8, 9));
}

TEST(Trajectory, StampsKeepEveryNanosecond) {
  const auto t = parse_trajectory(
      "-1.25 0 0 0 0 0 0 1\n-0.000000001 0 0 0 0 0 0 1\n1305031102.160407123999 0 0 0 0 0 0 1\n"
      "1305031102.160407124 0 0 0 0 0 0 1\n1305031103 0 0 0 0 0 0 1\n",
      "x");
  ASSERT_EQ(t.size(), 5u);
  EXPECT_EQ(t[0].stamp.nanoseconds, -1250000000);
  EXPECT_EQ(t[1].stamp.nanoseconds, -1);
  EXPECT_EQ(t[2].stamp.nanoseconds, 1305031102160407123);
  EXPECT_EQ(t[3].stamp.nanoseconds, 1305031102160407124);
  EXPECT_EQ(t[4].stamp.nanoseconds, 1305031103000000000);
}

TEST(Trajectory, ReadsExponentStamps) {
  const auto t = parse_trajectory("1.5e0 0 0 0 0 0 0 1\n1.305031102160407e+09 0 0 0 0 0 0 1\n", "x");
  EXPECT_EQ(t[0].stamp.nanoseconds, 1500000000);
  EXPECT_NEAR(t[1].stamp.seconds(), 1305031102.160407, 1e-6);
}

TEST(Trajectory, RefusesWithFileAndLine) {
  const std::string good = "1.0 0 0 0 0 0 0 1\n";
  EXPECT_THAT(error_of(good + "2.0 0 0 0 0 0 0\n"),
              AllOf(StartsWith("walk.txt:2: "), HasSubstr("8 columns"), HasSubstr("found 7")));
  EXPECT_THAT(error_of(good + "2.0 0 0 0 0 0 0 1 9\n"), HasSubstr("found 9"));
  EXPECT_THAT(error_of(good + "2.0 nan 0 0 0 0 0 1\n"), AllOf(StartsWith("walk.txt:2: "), HasSubstr("'nan'")));
  EXPECT_THAT(error_of(good + "2.0 inf 0 0 0 0 0 1\n"), HasSubstr("'inf'"));
  EXPECT_THAT(error_of(good + "2.0 1e999 0 0 0 0 0 1\n"), HasSubstr("1e999"));
  EXPECT_THAT(error_of(good + "2.0 1.0x 0 0 0 0 0 1\n"), HasSubstr("1.0x"));
  EXPECT_THAT(error_of("# c\n\nnow 0 0 0 0 0 0 1\n"), AllOf(StartsWith("walk.txt:3: "), HasSubstr("'now'")));
  EXPECT_THAT(error_of("1e300 0 0 0 0 0 0 1\n"), HasSubstr("not a time"));
  EXPECT_THAT(error_of(good + "2.0 0 0 0 0 0 0 1.01\n"), AllOf(StartsWith("walk.txt:2: "), HasSubstr("norm 1.01")));
  EXPECT_THAT(error_of(good + "2.0 0 0 0 0 0 0 0\n"), HasSubstr("norm 0"));
  EXPECT_THAT(error_of(good + good), AllOf(StartsWith("walk.txt:2: "), HasSubstr("twice")));
  EXPECT_THAT(error_of(good + "0.5 0 0 0 0 0 0 1\n"), AllOf(StartsWith("walk.txt:2: "), HasSubstr("earlier")));
}

TEST(Trajectory, NormalisesRoundedQuaternions) {
  const auto t = parse_trajectory("0 0 0 0 0 0 0 1.0009\n", "x");
  EXPECT_TRUE(geometry::is_valid(t[0].T_world_body));
}

TEST(Trajectory, FormatAndParseAreInverse) {
  const Trajectory original = random_trajectory(50, 3);
  const std::string text = format_trajectory(original, "T_map_base_link");
  EXPECT_THAT(text, StartsWith("# T_map_base_link\n"));
  const Trajectory again = parse_trajectory(text, "text");
  ASSERT_EQ(again.size(), original.size());
  for (std::size_t i = 0; i < original.size(); ++i) {
    EXPECT_EQ(again[i].stamp, original[i].stamp);
    EXPECT_LT((again[i].T_world_body.matrix() - original[i].T_world_body.matrix()).cwiseAbs().maxCoeff(), 5e-9);
  }
  EXPECT_EQ(format_trajectory(original, "T_map_base_link"), text);
}

TEST(Trajectory, FormatShowsNoNegativeZeroAndPositiveW) {
  const Trajectory t = {{time::Time{0}, geometry::make_pose({-1e-12, 0, -0.0}, {-1, 0, 0, 0})}};
  EXPECT_EQ(format_trajectory(t, "c"),
            "# c\n# timestamp tx ty tz qx qy qz qw\n"
            "0.000000000 0.000000000 0.000000000 0.000000000 0.000000000 0.000000000 0.000000000 1.000000000\n");
}

TEST(Trajectory, DamagedTextNeverCrashes) {
  const std::string text = format_trajectory(random_trajectory(5, 7), "fuzz");
  for (std::size_t end = 0; end < text.size(); ++end) error_of(text.substr(0, end));
  std::mt19937 engine(11);
  int refused = 0;
  for (int i = 0; i < 20000; ++i) {
    std::string damaged = text;
    for (int k = 0; k < 3; ++k) {
      damaged[engine() % damaged.size()] ^= static_cast<char>(1u << (engine() % 8));
    }
    refused += error_of(damaged) == "no error" ? 0 : 1;
  }
  EXPECT_GT(refused, 1000);
}

TEST(Trajectory, FilesAreReplacedWholeAndErrorsNameThem) {
  const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / "lapis_trajectory_test";
  std::filesystem::create_directories(folder);
  const auto file = folder / "t.txt";
  const Trajectory t = random_trajectory(3, 1);
  write_trajectory(file, t, "c");
  EXPECT_EQ(read_trajectory(file).size(), 3u);
  EXPECT_FALSE(std::filesystem::exists(file.string() + ".part"));
  EXPECT_THROW(write_trajectory(folder / "absent" / "t.txt", t, "c"), std::runtime_error);
  EXPECT_THROW(read_trajectory(folder / "absent.txt"), std::runtime_error);
  EXPECT_THROW(read_trajectory(folder), std::runtime_error);
  std::ofstream(file) << "# nothing\n";
  EXPECT_THROW(read_trajectory(file), std::runtime_error);
  std::filesystem::remove_all(folder);
}

TEST(Trajectory, PathLengthIsIndependentOfTheFrame) {
  const Trajectory t = random_trajectory(20, 5);
  const geometry::Pose T = geometry::make_pose({3, -1, 2}, {0.3, 0.5, -0.2, 0.7});
  EXPECT_NEAR(path_length_m(express_in(T, t)), path_length_m(t), 1e-9);
  EXPECT_EQ(path_length_m({}), 0.0);
}

constexpr time::Duration kLimit{20'000'000};

TEST(PoseAt, AgreesWithTheConstantTwistBetweenTwoPoses) {
  // A turn about a fixed axis with proportional translation is what linear and slerp interpolation must reproduce.
  const Eigen::Vector3d axis = Eigen::Vector3d(0.2, -0.7, 0.4).normalized();
  const auto expected = [&](double share) {
    return geometry::make_pose(share * Eigen::Vector3d(1.0, 2.0, -3.0),
                               Eigen::Quaterniond(Eigen::AngleAxisd(0.9 * share, axis)));
  };
  const Trajectory ends{{time::Time{0}, expected(0.0)}, {time::Time{30'000'000}, expected(1.0)}};
  for (const double share : {0.0, 0.1, 0.5, 0.75, 1.0}) {
    const auto T = pose_at(ends, time::Time{static_cast<std::int64_t>(share * 30e6)}, kLimit);
    ASSERT_TRUE(T) << share;
    EXPECT_TRUE(T->isApprox(expected(share), 1e-9)) << share;
  }
}

TEST(PoseAt, MakesNothingUp) {
  const geometry::Pose I = geometry::Pose::Identity();
  const Trajectory poses{{time::Time{1'000'000'000}, I}, {time::Time{2'000'000'000}, I}};
  EXPECT_FALSE(pose_at({}, time::Time{0}, kLimit));
  EXPECT_FALSE(pose_at(poses, time::Time{999'999'999}, kLimit)) << "before the first pose";
  EXPECT_FALSE(pose_at(poses, time::Time{2'000'000'001}, kLimit)) << "after the last pose";
  EXPECT_FALSE(pose_at(poses, time::Time{1'500'000'000}, kLimit)) << "in a gap";
  EXPECT_FALSE(pose_at(poses, time::Time{1'020'000'000}, kLimit)) << "at the limit";
  EXPECT_TRUE(pose_at(poses, time::Time{1'019'999'999}, kLimit)) << "below the limit";
  EXPECT_TRUE(pose_at(poses, time::Time{2'000'000'000}, time::Duration{0})) << "at the last pose";
}

}  // namespace
}  // namespace lapis::trajectory
