#include "planner/decision_worker.hpp"

#include <chrono>
#include <utility>

namespace lapis::planner {
namespace {

/// The knowledge for the decision and an empty string, or null and the reason.
std::pair<std::shared_ptr<const GraphKnowledge>, std::string> renew(DecisionInput& input) {
  if (!input.graph) return {input.knowledge, ""};
  auto graph =
      analyse_graph(input.graph->keyframes, input.graph->edges, input.config.graph, input.position_variance_m2);
  if (auto* error = std::get_if<GraphError>(&graph)) return {nullptr, error->message};
  const double resolution_m = input.surroundings->grid().resolution_m();
  LandmarkIndex landmarks(input.landmarks, std::get<AnalysedGraph>(graph), resolution_m);
  return {std::make_shared<const GraphKnowledge>(
              GraphKnowledge{std::get<AnalysedGraph>(std::move(graph)), std::move(landmarks)}),
          ""};
}

}  // namespace

DecisionOutput make_decision(DecisionInput input) {
  const auto begin = std::chrono::steady_clock::now();
  DecisionOutput output;
  std::string problem;
  std::tie(output.knowledge, problem) = renew(input);
  Situation situation{input.surroundings->grid(),
                      input.surroundings->frontiers(),
                      input.surroundings->field(),
                      *input.view,
                      input.T_base_camera,
                      nullptr,
                      nullptr,
                      input.robot,
                      input.surroundings->compared_fields()};
  if (output.knowledge) {
    situation.graph = &output.knowledge->graph;
    situation.landmarks = &output.knowledge->landmarks;
  }
  output.decision = decide(situation, input.memory, input.config);
  if (!problem.empty()) output.decision.problem = problem;
  output.time_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return output;
}

void DecisionWorker::start(DecisionInput input, std::uint64_t due) {
  due_ = due;
  result_ = std::async(std::launch::async, make_decision, std::move(input));
}

std::optional<DecisionOutput> DecisionWorker::take(std::uint64_t frame, bool waits) {
  if (!is_busy() || frame < due_) return std::nullopt;
  const bool is_late = result_.wait_for(std::chrono::seconds(0)) != std::future_status::ready;
  if (is_late && !waits) return std::nullopt;
  return result_.get();
}

void DecisionWorker::discard() {
  if (is_busy()) result_.get();
}

}  // namespace lapis::planner
