#include "planner/core/information/cell_information.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "tests/unit/planner/information/paper_model.hpp"
#include "tests/unit/planner/information/random_map.hpp"

namespace lapis::planner {
namespace {

using mapping::BeliefReader;
using mapping::kOneVote;
using mapping::SensorModel;
using mapping::VoxelCounts;

/// Of a cell with class log-odds chi, put together from the paper's f of a miss and of hits.
double expected_gain(const std::vector<double>& chi, double miss, const std::vector<double>& hits) {
  double sum = 1.0, gain = miss;
  for (std::size_t c = 0; c < chi.size(); ++c) {
    sum += std::exp(chi[c]);
    gain += std::exp(chi[c]) * hits[c];
  }
  return gain / sum;
}

TEST(CellMeasure, GivesThePapersInformation) {
  // Values of h, eq. 14 as corrected: a miss, and a hit of each class.
  const std::vector<double> unknown(4, -0.1), object{2.0, -1.0, -3.0, -2.0};
  const auto gain = [](const std::vector<double>& chi) {
    return CellMeasure(test::paper_model_with_prior(chi), {Measure::kSemantic}).of({}).gain;
  };
  EXPECT_NEAR(gain(unknown), expected_gain(unknown, 0.000880072, std::vector<double>(4, 0.126877548)), 1e-9);
  EXPECT_NEAR(gain(object), expected_gain(object, 0.000522824, {0.046899512, 0.045505325, 0.007407785, 0.018621647}),
              1e-9);
  EXPECT_NEAR(CellMeasure(test::paper_model_with_prior(unknown), {Measure::kSemantic}).of({}).free, 1.0 - 0.7835, 1e-4);
}

double divergence(const std::vector<double>& after, const std::vector<double>& before) {
  double sum = 0.0;
  for (std::size_t i = 0; i < after.size(); ++i) sum += after[i] * std::log(after[i] / before[i]);
  return sum;
}

/// The definition: expected divergence of what the reader says after so many more votes from what it says.
double plain_gain(const BeliefReader& reader, const VoxelCounts& counts, std::uint32_t votes = 1) {
  const std::vector<double> before = reader.class_probabilities(counts);
  VoxelCounts missed = counts;
  missed.misses += votes * kOneVote;
  double gain = before[0] * divergence(reader.class_probabilities(missed), before);
  for (int c = 1; c <= reader.model().class_count; ++c) {
    const auto label = static_cast<std::uint16_t>(c);
    VoxelCounts hit = counts;
    const auto same = std::find_if(hit.hits.begin(), hit.hits.end(), [&](auto& h) { return h.label == label; });
    if (same != hit.hits.end()) {
      same->count += votes * kOneVote;
    } else {
      hit.hits.push_back({label, votes * kOneVote});
    }
    gain += before[label] * divergence(reader.class_probabilities(hit), before);
  }
  return gain;
}

SensorModel model_of(const std::string& fusion, std::vector<double> priors, int classes = 0) {
  SensorModel model;
  model.fusion = fusion;
  model.class_count = priors.empty() ? classes : static_cast<int>(priors.size());
  model.class_priors = std::move(priors);
  return model;
}

TEST(CellMeasure, IsTheExpectedChangeOfWhatTheReaderSays) {
  std::vector<SensorModel> models;
  for (const char* fusion : {"log_odds", "dirichlet", "bki"}) {
    for (const int classes : {1, 2, 40}) models.push_back(model_of(fusion, {}, classes));
    models.push_back(model_of(fusion, {0.4, 0.25, 0.25, 0.05, 0.05}));
  }
  models.push_back(mapping::paper_sensor_model());
  std::mt19937 random(3);
  for (SensorModel model : models) {
    for (const double limit : {9.21034, 2.0, 0.5}) {
      model.occupancy_limit = model.share_limit = limit;
      const CellMeasure measure(model, {Measure::kSemantic});
      const BeliefReader reader(model);
      for (int trial = 0; trial < 200; ++trial) {
        const VoxelCounts counts = test::random_counts(random, model.class_count, trial % 2 == 0 ? 4 : 40);
        const CellInformation cell = measure.of(counts);
        EXPECT_NEAR(cell.gain, plain_gain(reader, counts), 1e-9) << model.fusion << ' ' << model.class_count;
        EXPECT_NEAR(cell.free, 1.0 - reader.occupied_probability(counts), 1e-12);
        EXPECT_GE(cell.gain, 0.0);
      }
    }
  }
}

TEST(CellMeasure, OfManyVotesIsTheExpectedChangeByThem) {
  std::mt19937 random(4);
  for (const char* fusion : {"log_odds", "dirichlet"}) {
    const SensorModel model = model_of(fusion, {}, 12);
    const BeliefReader reader(model);
    for (const int votes : {2, 15}) {
      const CellMeasure measure(model, {.votes = votes});
      for (int trial = 0; trial < 100; ++trial) {
        const VoxelCounts counts = test::random_counts(random, model.class_count, trial % 2 == 0 ? 4 : 40);
        EXPECT_NEAR(measure.of(counts).gain, plain_gain(reader, counts, static_cast<std::uint32_t>(votes)), 1e-9)
            << fusion << ' ' << votes;
      }
    }
  }
}

// A robot that passes learns all that there is to know of a voxel, and nothing where it has been.
TEST(CellMeasure, OfManyVotesPromisesTheEntropyThatIsLeft) {
  const BeliefReader reader(SensorModel{});
  const CellMeasure measure(SensorModel{}, {.votes = 15});
  for (std::uint32_t misses = 0; misses < 40; ++misses) {
    const VoxelCounts seen{misses * kOneVote, {}};
    EXPECT_NEAR(measure.of(seen).gain, reader.entropy(seen), 0.02 * reader.entropy({})) << misses;
  }
}

TEST(CellMeasure, RaysAreStoppedByUnknownVoxelsAsOftenAsIsSaid) {
  const CellMeasure measure(SensorModel{}, {.unknown_occupied = 0.07});
  EXPECT_NEAR(measure.of({}).free, 0.93, 1e-12);
  EXPECT_EQ(measure.of({}).gain, CellMeasure(SensorModel{}, {}).of({}).gain);
  EXPECT_EQ(measure.of({kOneVote, {}}).free, CellMeasure(SensorModel{}, {}).of({kOneVote, {}}).free);
}

TEST(CellMeasure, AClampedVoxelGainsNothing) {
  for (const Measure measure_kind : {Measure::kSemantic, Measure::kShannon, Measure::kCsqmi}) {
    const CellMeasure measure(SensorModel{}, {measure_kind});
    EXPECT_LT(measure.of({1000 * kOneVote, {}}).gain, 1e-7) << "free";
    EXPECT_LT(measure.of({0, {{7, 1000 * kOneVote}}}).gain, 1e-7) << "occupied";
    EXPECT_GT(measure.of({}).gain, 0.01);
  }
}

TEST(CellMeasure, ShannonIsThatOfFsmi) {
  SensorModel model;
  model.occupancy_limit = 1e3;
  const CellMeasure measure(model, {Measure::kShannon});
  const auto f = [](double d, double r) { return std::log((r + 1.0) / (r + 1.0 / d)) - std::log(d) / (r * d + 1.0); };
  for (std::uint32_t misses = 0; misses < 20; ++misses) {
    const VoxelCounts counts{misses * kOneVote, {{3, kOneVote}, {9, 2 * kOneVote}}};
    const double o = BeliefReader(model).occupied_probability(counts), r = o / (1.0 - o);
    const double expected = o * f(std::exp(model.hit_gain), r) + (1.0 - o) * f(std::exp(-model.miss_gain), r);
    EXPECT_NEAR(measure.of(counts).gain, expected, 1e-12);
  }
}

TEST(CellMeasure, CsqmiIsTheCauchySchwarzDivergenceOfOneCell) {
  const CellMeasure measure(SensorModel{}, {Measure::kCsqmi});
  for (std::uint32_t misses = 0; misses < 20; ++misses) {
    const VoxelCounts counts{misses * kOneVote, {{3, kOneVote}, {9, 2 * kOneVote}}};
    const double o = BeliefReader(SensorModel{}).occupied_probability(counts);
    // Cell and outcome agree always; the sums are over the four pairs of them.
    const double joint[] = {o, 0.0, 0.0, 1.0 - o};
    const double product[] = {o * o, o * (1.0 - o), (1.0 - o) * o, (1.0 - o) * (1.0 - o)};
    double jj = 0.0, pp = 0.0, jp = 0.0;
    for (int i = 0; i < 4; ++i) {
      jj += joint[i] * joint[i];
      pp += product[i] * product[i];
      jp += joint[i] * product[i];
    }
    EXPECT_NEAR(measure.of(counts).gain, std::log(jj) + std::log(pp) - 2.0 * std::log(jp), 1e-12);
  }
}

}  // namespace
}  // namespace lapis::planner
