#include "planner/core/methods/method.hpp"

namespace lapis::planner {

std::vector<Candidate> Method::propose(const ProposalInput& in) const { return propose_paths(in, asks().spectrum); }

}  // namespace lapis::planner
